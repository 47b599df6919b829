//! Finds and runs the settings of a scene that are missing from its table.

use crate::clock::race;
use crate::follow::follow;
use crate::method::{Method, Setting, rates};
use crate::options::Options;
use crate::scenes::Scene;
use crate::table::{Row, Table};
use indicatif::ProgressBar;
use std::io;

/// Requested settings of a scene that its table lacks, one list per tick rate. The settings of a list are timed
/// in turns, and their rows are written before the next list starts.
pub fn missing(options: &Options, scene: &Scene, table: &Table) -> Vec<Vec<Setting>> {
    let problem = (scene.make)();
    let damped = problem.links.iter().any(|l| l.damping > 0.0);
    let nonlinear = problem.is_nonlinear();
    let methods = options.methods.iter().filter(|m| match m {
        Method::Ours | Method::Force => true,
        Method::Joint | Method::Avian => !nonlinear,
        Method::AvianBare => damped && !nonlinear,
    });
    let quick = options.quick || scene.few;
    let mut chunks = Vec::new();
    for rate in rates(quick) {
        let mut chunk = Vec::new();
        for method in methods.clone() {
            for dial in method.dials(quick) {
                let setting = Setting {
                    method: *method,
                    dial,
                    rate: *rate,
                };
                if options.fresh || !table.has(setting, options.turns()) {
                    chunk.push(setting);
                }
            }
        }
        if !chunk.is_empty() {
            chunks.push(chunk);
        }
    }
    chunks
}

/// Measures error and time of the missing settings and stores them in the table.
pub fn run(
    options: &Options,
    scene: &Scene,
    table: &mut Table,
    chunks: Vec<Vec<Setting>>,
    bar: &ProgressBar,
) -> io::Result<()> {
    for chunk in chunks {
        let problem = (scene.make)();
        let mut strayed = Vec::new();
        for setting in &chunk {
            bar.set_message(format!(
                "{}: {}, {} at {} Hz",
                scene.name,
                setting.method.name(),
                setting.dial,
                setting.rate
            ));
            strayed.push(follow(&problem, *setting));
            bar.inc(1);
        }
        bar.set_message(format!("{}: the clock runs", scene.name));
        let times = race(&problem, &chunk, options.turns());
        let rows = chunk.iter().zip(strayed).zip(times);
        let rows = rows
            .map(|((setting, strayed), times)| Row {
                setting: *setting,
                strayed,
                times,
                turns: options.turns(),
            })
            .collect();
        table.put(rows)?;
    }
    Ok(())
}
