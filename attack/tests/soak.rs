//! Days in a row: is memory flat, does what dampers took explain where energy went, and does all stand where it stood?
//!
//! `cargo test --workspace --test soak` plays a minute of each scene; `cargo test --release --workspace --test soak --
//! --hours 24` plays a day, `--scene car` one scene alone, and `--pause 60` hits it once a minute. Ticks are timed too, for whoever
//! reads the times.

use attack::endurance::{Endurance, Interval, car, cloth, net};
use lexopt::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::process::ExitCode;
use std::time::Instant;

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Hours of a short run.
const HOURS: f64 = 1.0 / 60.0;

/// So often each scene tells how it is.
const REPORTS: u64 = 12;

/// Bytes by which what is in use may grow after the first report. Queues of Bevy's threads double now and then, when more waits in
/// them than ever before: up to 108 KB came of it in three minutes of the car, other numbers in each run.
const GROWTH: isize = 256 << 10;

fn main() -> ExitCode {
    match soak() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(wrong) => {
            eprintln!("{wrong}\n[--hours N] [--scene NAME] [--pause SECONDS]");
            ExitCode::FAILURE
        }
    }
}

/// Says whether all scenes were sound.
fn soak() -> Result<bool, lexopt::Error> {
    let (mut hours, mut only, mut pause) = (HOURS, None::<String>, None);
    let mut words = lexopt::Parser::from_env();
    while let Some(word) = words.next()? {
        match word {
            Long("hours") => hours = words.value()?.parse()?,
            Long("pause") => pause = Some(words.value()?.parse()?),
            Long("scene") => only = Some(words.value()?.parse()?),
            // What is meant for lists of tests.
            Value(filter) if !"soak".contains(&*filter.to_string_lossy()) => return Ok(true),
            Value(_) | Long("nocapture" | "quiet") | Short('q') => {}
            other => return Err(other.unexpected()),
        }
    }
    let mut sound = true;
    for scene in [car, cloth, net] {
        let mut scene = scene();
        scene.pause = pause.unwrap_or(scene.pause);
        if only.as_ref().is_none_or(|name| name == scene.title) {
            sound &= is_sound(scene, hours);
        }
    }
    Ok(sound)
}

fn in_use(region: &Region<System>) -> isize {
    let change = region.change();
    change.bytes_allocated as isize - change.bytes_deallocated as isize
}

/// Its size; endless for what is no number, which `max` would pass over.
fn size(number: f64) -> f64 {
    if number.is_finite() {
        number.abs()
    } else {
        f64::INFINITY
    }
}

/// Plays it so long, and tells what is wrong.
fn is_sound(mut scene: Endurance, hours: f64) -> bool {
    let intervals = ((3600.0 * hours / f64::from(scene.pause)).round() as u64).max(2);
    let every = (intervals / REPORTS).max(1);
    let region = Region::new(MEMORY);
    // What grows once grows in the first of all.
    scene.interval();
    let (mut first, mut wrong) = (None, Vec::new());
    let (mut worst, mut began) = (Interval::default(), Instant::now());
    for number in 1..=intervals {
        let one = scene.interval();
        worst.turned_over = worst.turned_over.max(one.turned_over);
        worst.unexplained = worst
            .unexplained
            .max(size(one.unexplained / one.turned_over));
        worst.off = (worst.off.0.max(size(one.off.0)), one.off.1);
        worst.speed = worst.speed.max(size(one.speed));
        if number % every == 0 {
            let memory = in_use(&region);
            let grown = memory - *first.get_or_insert(memory);
            let ticks = every as f64 * f64::from(scene.pause) * 60.0;
            println!(
                "{}, {:.2} h: {:.1} us a tick, {grown:+} bytes, unexplained {:.1e} of {:.3} J, off by {:.1e}, {:.1e} m/s left",
                scene.title,
                number as f64 * f64::from(scene.pause) / 3600.0,
                began.elapsed().as_secs_f64() / ticks * 1e6,
                worst.unexplained,
                worst.turned_over,
                worst.off.0,
                worst.speed,
            );
            if grown > GROWTH {
                wrong.push(format!("{grown} bytes more"));
            }
            if scene.explained.is_some_and(|most| worst.unexplained > most) {
                wrong.push(format!(
                    "{:.1e} of its energy unexplained",
                    worst.unexplained
                ));
            }
            if worst.off.0 > worst.off.1 {
                wrong.push(format!("off by {:.1e}", worst.off.0));
            }
            (worst, began) = (Interval::default(), Instant::now());
        }
    }
    for one in &wrong {
        println!("{}: {one}", scene.title);
    }
    wrong.is_empty()
}
