//! Builds docs/speed_vs_error.md from the stored tables.

use crate::front::{find, front};
use crate::machine;
use crate::marked::mark;
use crate::method::{Dial, Method, Setting};
use crate::scenes::Scene;
use crate::table::Row;
use crate::words::{best_of, digits, length, time, verdict};
use std::fmt::Write;

/// Title of the report and an explanation of how to read it.
pub fn opening() -> String {
    format!(
        "# Speed against error\n\n\
         Made by `cargo run --release -p compare`, which measures every spring that a Bevy game could use on the \
         same scenes. Do not edit: the command writes this file, and copies the first table into `docs/accuracy.md`.\n\n\
         - **Methods.** bevy_coilover at 1 to 16 micro-steps, extrapolated, and by tolerance; the tutorial's \
         force `k·stretch + c·rate` written once per step into `ExternalForce`; Rapier's `SpringJoint` at 4 to 32 \
         solver iterations; Avian 0.7's `DistanceJoint` with compliance 1/k and `JointDamping` c/m at 6 to 48 \
         substeps. That damping also brakes motion across the line, and Avian has none along the line alone. So Avian \
         is run with and without it, and the smaller error is given.\n\
         - **Error** is the largest distance of a watched body from its place in an analytic solution or in one by \
         DOP853 (1e-10 to 1e-12), over the whole time that the scene's description names. A method has diverged if \
         its error is ten times the size of the motion.\n\
         - **Time per step** is one whole `app.update()`, everything that Bevy and the engine do included: median \
         of 15 turns or more, all methods in turns, after a warm-up, on bodies that may not sleep. *Computing \
         time* is that times the steps in 1/60 s of the scene, so that different time steps can be compared.\n\
         - **Machine.** {}. Compare numbers within this file, not with another machine's.\n\n",
        machine::describe()
    )
}

/// The table of the section "In short", which is also copied into `docs/accuracy.md`.
pub fn headline(scenes: &[(&Scene, Vec<Row>)]) -> String {
    let mut text = String::from(
        "Largest position error · time per step, at 60 steps a second (made by `cargo run --release -p compare`, \
         which writes all of it to `docs/speed_vs_error.md`):\n\n",
    );
    text.push_str(
        "| scene | bevy_coilover | extrapolated | force once per step | Rapier `SpringJoint` | Avian distance joint | error, joint : ours | time, ours : joint |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for (scene, rows) in scenes {
        let ours = find(rows, Setting::default_of(Method::Ours, 60));
        let extrapolated = find(
            rows,
            Setting {
                method: Method::Ours,
                dial: Dial::Extrapolated,
                rate: 60,
            },
        );
        let cell = |row: Option<Row>| {
            row.map_or("–".into(), |r| format!("{} · {}", length(&r), time(&r)))
        };
        let joint = best_of(rows, Method::Joint);
        let (mut less, mut longer) = ("–".into(), "–".into());
        if let (Some(ours), Some(joint)) = (ours, joint) {
            less = digits(joint.strayed.error / ours.strayed.error);
            longer = format!("{:.2}", ours.times.median / joint.times.median);
        }
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {less} | {longer} |",
            scene.title,
            cell(ours),
            cell(extrapolated),
            cell(best_of(rows, Method::Force)),
            cell(joint),
            cell(best_of(rows, Method::Avian)),
        );
    }
    mark(&text)
}

/// Chart, sentences and tables of a scene.
pub fn section(scene: &Scene, rows: &[Row]) -> String {
    let mut text = format!(
        "## {}\n\n{}\n\n![{}: error against computing time](speed_vs_error/{}.svg)\n\n{}\n\n",
        scene.title,
        scene.note,
        scene.title,
        scene.name,
        verdict(rows)
    );
    text.push_str("At 60 steps a second:\n\n");
    let at_60: Vec<Row> = rows
        .iter()
        .filter(|r| r.setting.rate == 60)
        .copied()
        .collect();
    table(&mut text, &at_60);
    text.push_str("\nThe Pareto front, of all settings at 30 to 960 steps a second:\n\n");
    table(&mut text, &front(rows));
    text.push('\n');
    text
}

fn table(text: &mut String, rows: &[Row]) {
    let energy = rows.iter().any(|r| r.strayed.energy.is_some());
    let momentum = rows.iter().any(|r| r.strayed.momentum.is_some());
    text.push_str(
        "| method | setting | Hz | largest error | time per step | quartiles | per 1/60 s |",
    );
    let mut line = String::from("|---|---|---|---|---|---|---|");
    for (wanted, head) in [(energy, " energy drift |"), (momentum, " momentum drift |")] {
        if wanted {
            text.push_str(head);
            line.push_str("---|");
        }
    }
    let _ = writeln!(text, "\n{line}");
    for row in rows {
        let _ = write!(
            text,
            "| {} | {} | {} | {} | {} | {:.1}–{:.1} | {:.1} µs |",
            row.setting.method.title(),
            row.setting.dial,
            row.setting.rate,
            length(row),
            time(row),
            1e6 * row.times.low,
            1e6 * row.times.high,
            1e6 * row.work() / 60.0,
        );
        let share = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.1e}"));
        if energy {
            let _ = write!(text, " {} |", share(row.strayed.energy));
        }
        if momentum {
            let _ = write!(text, " {} |", share(row.strayed.momentum));
        }
        text.push('\n');
    }
}
