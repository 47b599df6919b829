//! Long runs: memory stays flat, dissipation explains the energy loss, and everything rests where it should.
//!
//! `cargo test --workspace --test soak` plays a minute of each scene. `cargo test --release --workspace --test soak --
//! --hours 24` plays a day. `--scene car` plays one scene alone, and `--period 60` strikes it once a minute. `--keep FOLDER`
//! saves each scene there now and then, and continues what is saved there: a day of the net can be played in several runs,
//! with the same bits. The program also prints the time per tick, but asserts nothing about it.

use attack::endurance::{Endurance, Interval, Saved, car, cloth, net};
use lexopt::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Hours of a short run.
const HOURS: f64 = 1.0 / 60.0;

/// Number of reports of each scene.
const REPORTS: u64 = 12;

/// Strikes from one saving to the next: minutes of the machine's time.
const SAVED: u64 = 60;

/// Bytes by which the memory in use may grow after the first report. Queues of Bevy's threads double when they are fuller
/// than ever before. This added up to 108 KB in three minutes of the car, a different amount in each run.
const GROWTH: isize = 256 << 10;

fn main() -> ExitCode {
    match soak() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(wrong) => {
            eprintln!("{wrong}\n[--hours N] [--scene NAME] [--period SECONDS] [--keep FOLDER]");
            ExitCode::FAILURE
        }
    }
}

/// Returns whether all scenes were sound.
fn soak() -> Result<bool, Box<dyn Error>> {
    let (mut hours, mut only, mut period, mut keep) = (HOURS, None::<String>, None, None);
    let mut words = lexopt::Parser::from_env();
    while let Some(word) = words.next()? {
        match word {
            Long("hours") => hours = words.value()?.parse()?,
            Long("period") => period = Some(words.value()?.parse()?),
            Long("keep") => keep = Some(PathBuf::from(words.value()?)),
            Long("scene") => only = Some(words.value()?.parse()?),
            // Arguments that Cargo passes to every test program.
            Value(filter) if !"soak".contains(&*filter.to_string_lossy()) => return Ok(true),
            Value(_) | Long("nocapture" | "quiet") | Short('q') => {}
            other => return Err(other.unexpected().into()),
        }
    }
    let mut sound = true;
    for new in [car, cloth, net] {
        let mut scene = new();
        if only.as_ref().is_some_and(|name| name != scene.title) {
            continue;
        }
        scene.period = period.unwrap_or(scene.period);
        let file = keep.as_ref().map(|folder| folder.join(scene.title));
        if let Some(file) = file.as_ref().filter(|file| file.exists()) {
            scene.resume(&ciborium::from_reader(&fs::read(file)?[..])?)?;
        }
        sound &= is_sound(&mut scene, hours, file.as_deref())?;
        sound &= continues_alike(scene, new())?;
    }
    Ok(sound)
}

fn bytes(saved: &Saved) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(saved, &mut bytes)?;
    Ok(bytes)
}

/// Returns whether a new scene that continues an old one does in a second what the old one does, bit for bit.
fn continues_alike(mut old: Endurance, mut new: Endurance) -> Result<bool, Box<dyn Error>> {
    new.resume(&ciborium::from_reader(&bytes(&old.save())?[..])?)?;
    (old.period, new.period) = (1.0, 1.0);
    let alike = old.interval() == new.interval();
    if !alike {
        println!("{}: saved and continued, it does something else", old.title);
    }
    Ok(alike)
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

/// Plays a scene until it is so many hours old and prints what is wrong. Returns whether nothing is.
fn is_sound(
    scene: &mut Endurance,
    hours: f64,
    keep: Option<&Path>,
) -> Result<bool, Box<dyn Error>> {
    let period = f64::from(scene.period);
    let intervals = ((3600.0 * hours / period).round() as u64).max(2);
    let every = (intervals / REPORTS).max(1);
    let region = Region::new(MEMORY);
    // Memory that grows only once does so in this first interval.
    scene.interval();
    let (mut first, mut wrong) = (None, Vec::new());
    let (mut worst, mut began, mut played) = (Interval::default(), Instant::now(), 0);
    while scene.strikes <= intervals {
        let one = scene.interval();
        let number = scene.strikes - 1;
        played += 1;
        worst.turned_over = worst.turned_over.max(one.turned_over);
        worst.unexplained = worst
            .unexplained
            .max(size(one.unexplained / one.turned_over));
        worst.off = (worst.off.0.max(size(one.off.0)), one.off.1);
        worst.speed = worst.speed.max(size(one.speed));
        if let Some(file) = keep.filter(|_| number.is_multiple_of(SAVED) || number == intervals) {
            // Not half written when the program is stopped.
            let new = file.with_extension("new");
            fs::write(&new, bytes(&scene.save())?)?;
            fs::rename(&new, file)?;
        }
        if number.is_multiple_of(every) || number == intervals {
            let memory = in_use(&region);
            let grown = memory - *first.get_or_insert(memory);
            let ticks = played as f64 * period * 60.0;
            println!(
                "{}, {:.2} h: {:.1} us a tick, {grown:+} bytes, unexplained {:.1e} of {:.3} J, off by {:.1e}, {:.1e} m/s left",
                scene.title,
                number as f64 * period / 3600.0,
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
            (worst, began, played) = (Interval::default(), Instant::now(), 0);
        }
    }
    for one in &wrong {
        println!("{}: {one}", scene.title);
    }
    Ok(wrong.is_empty())
}
