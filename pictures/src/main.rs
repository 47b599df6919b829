//! Makes an animated GIF of an example's last seconds.
//!
//! `cargo run --release -p pictures -- showcase docs/showcase.gif`, after
//! `cargo build --release --example showcase`.

use gif::{Encoder, Frame, Repeat};
use image::imageops::{FilterType, resize};
use lexopt::prelude::*;
use std::error::Error;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Time that each picture is shown, in hundredths of a second: the rate at which the examples film.
const DELAY: u16 = 5;
const SIZE: (u16, u16) = (640, 360);
/// Speed of the colour selection: 1 is best, 30 is fastest.
const SPEED: i32 = 10;

const USAGE: &str = "pictures EXAMPLE FILE.gif: films the last seconds of an example";

fn main() -> ExitCode {
    match run() {
        Ok(said) => {
            println!("{said}");
            ExitCode::SUCCESS
        }
        Err(wrong) => {
            eprintln!("{wrong}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<String, Box<dyn Error>> {
    let mut words = lexopt::Parser::from_env();
    let mut given: Vec<PathBuf> = Vec::new();
    while let Some(word) = words.next()? {
        match word {
            Long("help") | Short('h') => return Ok(USAGE.into()),
            Value(value) => given.push(value.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    let [scene, file] = &given[..] else {
        return Err(USAGE.into());
    };
    let scene = scene.to_string_lossy();
    let folder = std::env::temp_dir().join(format!("film_{scene}_{}", std::process::id()));
    let filmed = pictures::command(&scene)
        .arg("--film")
        .arg(&folder)
        .status()
        .map_err(|wrong| format!("{scene} does not run: {wrong}"))?;
    if !filmed.success() {
        return Err(format!("{scene} ended with {filmed}; its pictures are in {folder:?}").into());
    }
    let frames = frames(&folder)?;
    bind(&frames, file)?;
    fs::remove_dir_all(&folder)?;
    Ok(format!("{} pictures in {}", frames.len(), file.display()))
}

/// Returns the pictures in a folder, in order.
fn frames(folder: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut frames = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "png") {
            frames.push(path);
        }
    }
    if frames.is_empty() {
        return Err(format!("no pictures in {folder:?}").into());
    }
    frames.sort();
    Ok(frames)
}

/// Combines the pictures into one animation.
fn bind(frames: &[PathBuf], file: &Path) -> Result<(), Box<dyn Error>> {
    let (width, height) = SIZE;
    let out = BufWriter::new(File::create(file)?);
    let mut encoder = Encoder::new(out, width, height, &[])?;
    encoder.set_repeat(Repeat::Infinite)?;
    for path in frames {
        let picture = image::open(path)?.to_rgb8();
        let small = resize(&picture, width.into(), height.into(), FilterType::Triangle);
        let mut frame = Frame::from_rgb_speed(width, height, &small, SPEED);
        frame.delay = DELAY;
        encoder.write_frame(&frame)?;
    }
    Ok(())
}
