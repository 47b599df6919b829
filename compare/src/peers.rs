//! What the scripts in `compare/peers` have found out about engines outside of this process.

use crate::words::digits;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Their table at 60 and 240 steps a second, or nothing where they have not run.
pub fn section(folder: &Path) -> String {
    let Ok(csv) = fs::read_to_string(folder.join("peers.csv")) else {
        return String::new();
    };
    let mut text = String::from(
        "## Engines outside of Bevy\n\nMeasured by `compare/peers/run`, on the same scenes of points, each engine in \
         its own language: MuJoCo's spatial tendon from Python, with a call per step, Exudyn's spring-damper, called once for all steps, and Jolt's distance constraint \
         in WebAssembly. **Their times are not comparable with those above**: they hold the cost of another language, \
         and no Bevy app. Their errors are.\n\n\
         | scene | peer | setting | Hz | largest error | step (not comparable) |\n|---|---|---|---|---|---|\n",
    );
    for line in csv.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [peer, setting, scene, rate, error, diverged, step] = cells.as_slice() else {
            continue;
        };
        if !["60", "240"].contains(rate) {
            continue;
        }
        let error = match error.parse::<f64>() {
            Ok(error) if *diverged == "0" => format!("{} mm", digits(1e3 * error)),
            _ => "diverges".into(),
        };
        let _ = writeln!(
            text,
            "| {scene} | {peer} | {setting} | {rate} | {error} | {step} µs |"
        );
    }
    text.push('\n');
    text
}
