//! Long runs: memory stays flat, dissipation explains the energy loss, and everything rests where it should.
//!
//! `cargo test --workspace --test soak` plays a minute of each scene. `cargo test --release --workspace --test soak --
//! --hours 24` plays a day. `--scene car` plays one scene alone, and `--pause 60` strikes it once a minute. The program
//! also prints the time per tick, but asserts nothing about it.

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

/// Number of reports of each scene.
const REPORTS: u64 = 12;

/// Bytes by which the memory in use may grow after the first report. Queues of Bevy's threads double when they are fuller
/// than ever before. This added up to 108 KB in three minutes of the car, a different amount in each run.
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

/// Returns whether all scenes were sound.
fn soak() -> Result<bool, lexopt::Error> {
    let (mut hours, mut only, mut pause) = (HOURS, None::<String>, None);
    let mut words = lexopt::Parser::from_env();
    while let Some(word) = words.next()? {
        match word {
            Long("hours") => hours = words.value()?.parse()?,
            Long("pause") => pause = Some(words.value()?.parse()?),
            Long("scene") => only = Some(words.value()?.parse()?),
            // Arguments that Cargo passes to every test program.
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

/// Absolute value, and infinity for NaN, which `max` would ignore.
fn size(number: f64) -> f64 {
    if number.is_finite() {
        number.abs()
    } else {
        f64::INFINITY
    }
}

/// Plays a scene for a time and prints what is wrong. Returns whether nothing is.
fn is_sound(mut scene: Endurance, hours: f64) -> bool {
    let intervals = ((3600.0 * hours / f64::from(scene.pause)).round() as u64).max(2);
    let every = (intervals / REPORTS).max(1);
    let region = Region::new(MEMORY);
    // Memory that grows only once does so in this first interval.
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
        if number % every == 0 || number == intervals {
            let memory = in_use(&region);
            let grown = memory - *first.get_or_insert(memory);
            let played = number - (number - 1) / every * every;
            let ticks = played as f64 * f64::from(scene.pause) * 60.0;
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
