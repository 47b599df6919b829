//! Long runs: memory stays flat, dissipation explains the energy loss, and everything rests where it should.
//!
//! `cargo test --workspace --test soak` plays a minute of each scene. `cargo test --release --workspace --test soak --
//! --hours 24` plays a day. `--scene car` plays one scene alone, and `--period 60` strikes it once a minute. `--keep FOLDER`
//! saves each scene there now and then, and continues what is saved there: a day of the net can be played in several runs,
//! with the same bits. What was wrong in one of these runs is saved too, and makes the later ones fail. The program also
//! prints the time per tick, but asserts nothing about it.
//!
//! Every interval from one strike to the next is judged, also the first. Only the memory in use counts from the end of the
//! first interval of a run: what grows only once has grown by then.

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

/// Bytes by which the memory in use may grow after a run's first interval. Queues of Bevy's threads double when they are
/// fuller than ever before. This added up to 108 KB in three minutes of the car, a different amount in each run.
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

/// What the command line asks for.
struct Wishes {
    hours: f64,
    only: Option<String>,
    period: Option<f32>,
    keep: Option<PathBuf>,
}

impl Wishes {
    /// Reads the command line. `None` if it asks for other tests than this one.
    fn read() -> Result<Option<Self>, Box<dyn Error>> {
        let (mut hours, mut only, mut period, mut keep) = (HOURS, None, None, None);
        let mut words = lexopt::Parser::from_env();
        while let Some(word) = words.next()? {
            match word {
                Long("hours") => hours = words.value()?.parse()?,
                Long("period") => period = Some(words.value()?.parse()?),
                Long("keep") => keep = Some(PathBuf::from(words.value()?)),
                Long("scene") => only = Some(words.value()?.parse()?),
                // Arguments that Cargo passes to every test program.
                Value(filter) if !"soak".contains(&*filter.to_string_lossy()) => return Ok(None),
                Value(_) | Long("nocapture" | "quiet") | Short('q') => {}
                other => return Err(other.unexpected().into()),
            }
        }
        let is_time = |time: f64| time.is_finite() && time > 0.0;
        if !(is_time(hours) && period.is_none_or(|period: f32| is_time(period.into()))) {
            return Err("hours and seconds must be finite and above zero".into());
        }
        Ok(Some(Self {
            hours,
            only,
            period,
            keep,
        }))
    }
}

/// Returns whether all scenes were sound.
fn soak() -> Result<bool, Box<dyn Error>> {
    let Some(wishes) = Wishes::read()? else {
        println!("soak: filtered out, no scene was played");
        return Ok(true);
    };
    if let Some(folder) = &wishes.keep {
        fs::create_dir_all(folder)?;
    }
    let (mut sound, mut played) = (true, 0);
    for new in [car, cloth, net] {
        let mut scene = new();
        if wishes.only.as_ref().is_some_and(|name| name != scene.title) {
            continue;
        }
        played += 1;
        scene.period = wishes.period.unwrap_or(scene.period);
        let file = wishes.keep.as_ref().map(|folder| folder.join(scene.title));
        if let Some(file) = file.as_ref().filter(|file| file.exists()) {
            resume(&mut scene, file)?;
        }
        play(&mut scene, wishes.hours, file.as_deref())?;
        let (title, strikes, mut saved) = (scene.title, scene.strikes, scene.save());
        if !continues_alike(scene, new(), &saved)? {
            let kind = "saved and continued, it does something else";
            let at = format!("after {strikes} strikes");
            saved.faults.entry(kind.into()).or_insert(at);
            if let Some(file) = &file {
                write(file, &saved)?;
            }
        }
        for (kind, seen) in &saved.faults {
            println!("{title}: {kind}: {seen}");
        }
        sound &= saved.faults.is_empty();
    }
    match (played, wishes.only) {
        (0, Some(name)) => Err(format!("no scene has the name {name}").into()),
        _ => Ok(sound),
    }
}

fn bytes(saved: &Saved) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(saved, &mut bytes)?;
    Ok(bytes)
}

/// Saves a scene, never half: the program may be stopped at any time.
fn write(file: &Path, saved: &Saved) -> Result<(), Box<dyn Error>> {
    let new = file.with_extension("new");
    fs::write(&new, bytes(saved)?)?;
    fs::rename(&new, file)?;
    Ok(())
}

/// Continues a scene that an earlier run saved, and says what was wrong in it.
fn resume(scene: &mut Endurance, file: &Path) -> Result<(), Box<dyn Error>> {
    let saved: Saved = ciborium::from_reader(&fs::read(file)?[..])?;
    scene.resume(&saved)?;
    println!("{}: continued after {} strikes", scene.title, scene.strikes);
    for (kind, seen) in &scene.faults {
        println!("{}: an earlier run found: {kind}: {seen}", scene.title);
    }
    Ok(())
}

/// Returns whether a new scene that continues an old one does in a second what the old one does, bit for bit.
fn continues_alike(
    mut old: Endurance,
    mut new: Endurance,
    saved: &Saved,
) -> Result<bool, Box<dyn Error>> {
    new.resume(&ciborium::from_reader(&bytes(saved)?[..])?)?;
    (old.period, new.period) = (1.0, 1.0);
    Ok(old.interval() == new.interval() && old.is_like(&new))
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

/// Plays a scene until it is so many hours old. Its faults are noted in it.
fn play(scene: &mut Endurance, hours: f64, keep: Option<&Path>) -> Result<(), Box<dyn Error>> {
    let period = f64::from(scene.period);
    let intervals = ((3600.0 * hours / period).round() as u64).max(2);
    let every = (intervals / REPORTS).max(1);
    if scene.strikes >= intervals {
        println!("{}: played to its end by earlier runs", scene.title);
    }
    let region = Region::new(MEMORY);
    let mut first = None;
    let (mut worst, mut began, mut played) = (Interval::default(), Instant::now(), 0);
    while scene.strikes < intervals {
        let one = scene.interval();
        let memory = in_use(&region);
        let grown = memory - *first.get_or_insert(memory);
        let number = scene.strikes;
        let age = format!("{:.2} h", number as f64 * period / 3600.0);
        judge(scene, &one, grown, &age);
        (worst, played) = (worse(&worst, &one), played + 1);
        if number.is_multiple_of(every) || number == intervals {
            let ticks = played as f64 * period * 60.0;
            println!(
                "{}, {age}: {:.1} us a tick, {grown:+} bytes, of {:.3} J missing {:.1e}, from nothing {:.1e}, off by {:.1e}, {:.1e} m/s left",
                scene.title,
                began.elapsed().as_secs_f64() / ticks * 1e6,
                worst.turned_over,
                worst.missing,
                worst.surplus,
                worst.off.0,
                worst.speed,
            );
            (worst, began, played) = (Interval::default(), Instant::now(), 0);
        }
        // After judging, so that a fault is never forgotten.
        if let Some(file) = keep.filter(|_| number.is_multiple_of(SAVED) || number == intervals) {
            write(file, &scene.save())?;
        }
    }
    Ok(())
}

/// The energy balance of an interval as shares of the energy turned over, and the greater one of each number.
fn worse(worst: &Interval, one: &Interval) -> Interval {
    let share = |joules: f64| size(joules / one.turned_over);
    Interval {
        turned_over: worst.turned_over.max(one.turned_over),
        missing: worst.missing.max(share(one.missing)),
        surplus: worst.surplus.max(share(one.surplus)),
        off: (worst.off.0.max(size(one.off.0)), one.off.1),
        speed: worst.speed.max(size(one.speed)),
        ..*one
    }
}

/// Notes in a scene what is wrong with an interval, the first time that it is wrong.
fn judge(scene: &mut Endurance, one: &Interval, grown: isize, age: &str) {
    let mut note = |is_wrong: bool, kind: &str, seen: String| {
        if is_wrong && !scene.faults.contains_key(kind) {
            scene
                .faults
                .insert(kind.into(), format!("{seen}, at {age}"));
        }
    };
    let share = |joules: f64| size(joules / one.turned_over);
    let (missing, surplus) = (share(one.missing), share(one.surplus));
    let of = format!("of {:.3} J", one.turned_over);
    let (off, most) = (size(one.off.0), one.off.1);
    note(grown > GROWTH, "memory grows", format!("{grown} bytes"));
    let is_missing = scene.missing.is_some_and(|most| missing > most);
    note(
        is_missing,
        "energy is missing",
        format!("{missing:.1e} {of}"),
    );
    let is_surplus = surplus > scene.surplus;
    note(
        is_surplus,
        "energy from nothing",
        format!("{surplus:.1e} {of}"),
    );
    note(
        off > most,
        "is not where it should be",
        format!("off by {off:.1e}"),
    );
    let is_fast = size(one.speed) > scene.rests;
    note(is_fast, "does not rest", format!("{:.1e} m/s", one.speed));
    note(
        one.idle > 0,
        "springs do not act",
        format!("{} of them", one.idle),
    );
    note(one.work == 0.0, "the strike does nothing", "0 J".into());
}
