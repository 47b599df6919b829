//! Compares speed and error of bevy_coilover with everything that a game could use instead.
//!
//! `cargo run --release -p compare` runs every scene with every method and writes the report
//! `docs/speed_vs_error.md`, with tables (CSV) and charts (SVG) in a folder beside it. `--help` lists the options.

mod advice;
mod campaign;
mod chart;
mod clock;
mod cost;
mod describe;
mod follow;
mod front;
mod ground;
mod machine;
mod marked;
mod method;
mod options;
mod paint;
mod peers;
mod problem;
mod report;
mod rig;
mod scale;
mod scenes;
mod stability;
mod study;
mod sweep;
mod table;
mod turning;
mod verdict;
mod words;

use ground::Ground;
use indicatif::{ProgressBar, ProgressStyle};
use options::{HELP, Options, Request};
use scale::Scale;
use scenes::SCENES;
use stability::Map;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use study::Study;
use sweep::Sweep;
use table::Table;
use turning::Turning;

fn main() -> ExitCode {
    let mut known: Vec<&str> = SCENES.iter().map(|s| s.name).collect();
    known.extend([Turning.name(), Sweep.name(), Scale.name(), Ground.name()]);
    known.extend(Map::ALL.iter().map(Map::name));
    let done = match Options::parse(&known) {
        Ok(Request::Help) => {
            println!("{HELP}");
            Ok(())
        }
        Ok(Request::List) => {
            println!("{}", known.join("\n"));
            Ok(())
        }
        Ok(Request::Scale(method, springs)) => {
            scale::tell(method, springs);
            Ok(())
        }
        Ok(Request::Describe(folder)) => describe::write_all(&folder).map_err(Into::into),
        Ok(Request::Updates(counts)) => {
            scale::update(counts);
            Ok(())
        }
        Ok(Request::Run(options)) => run(&options),
        Err(error) => Err(error.into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let folder = options.out.join("docs/speed_vs_error");
    std::fs::create_dir_all(&folder)?;
    let mut work = Vec::new();
    for scene in SCENES.iter().filter(|s| options.wants(s.name)) {
        let table = Table::open(&folder, scene.name);
        let chunks = campaign::missing(options, scene, &table);
        work.push((scene, table, chunks));
    }
    let studies = study::asked(&Turning, options).len()
        + study::asked(&Sweep, options).len()
        + study::asked(&Scale, options).len()
        + study::asked(&Ground, options).len()
        + Map::ALL
            .iter()
            .map(|map| study::asked(map, options).len())
            .sum::<usize>();
    let count: usize = work.iter().flat_map(|(_, _, c)| c).map(Vec::len).sum();
    let bar = ProgressBar::new((count + studies) as u64).with_style(ProgressStyle::with_template(
        "{bar:30} {pos}/{len} {elapsed} {wide_msg}",
    )?);
    for (scene, mut table, chunks) in work {
        campaign::run(options, scene, &mut table, chunks, &bar)?;
    }
    let mut extras = study::run(&Turning, options, &folder, &bar)?;
    extras += &study::run(&Sweep, options, &folder, &bar)?;
    for map in Map::ALL {
        extras += &study::run(&map, options, &folder, &bar)?;
    }
    extras += &study::run(&Scale, options, &folder, &bar)?;
    extras += &study::run(&Ground, options, &folder, &bar)?;
    bar.finish_and_clear();
    publish(options, &folder, &extras)
}

/// Writes the charts and the report from all existing tables.
fn publish(options: &Options, folder: &Path, extras: &str) -> Result<(), Box<dyn Error>> {
    let mut scenes = Vec::new();
    for scene in &SCENES {
        let rows = Table::open(folder, scene.name).rows;
        if !rows.is_empty() {
            let path = folder.join(format!("{}.svg", scene.name));
            chart::draw(&path, scene.title, &rows)?;
            scenes.push((scene, rows));
        }
    }
    let headline = report::headline(&scenes);
    cost::draw(&folder.join("cost.svg"), &scenes)?;
    let mut text = format!(
        "{}{}## In short\n\n{headline}\n\n{}",
        report::opening(),
        cost::section(&scenes),
        report::diverging(&scenes)
    );
    for (scene, rows) in &scenes {
        text.push_str(&report::section(scene, rows));
    }
    text.push_str(extras);
    text.push_str(&peers::section(folder, &scenes));
    text.push_str(&advice::section(&scenes));
    std::fs::write(
        options.out.join("docs/speed_vs_error.md"),
        text.trim_end().to_owned() + "\n",
    )?;
    marked::copy(&options.out.join("docs/accuracy.md"), &headline)?;
    Ok(())
}
