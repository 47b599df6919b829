//! Builds docs/speed_vs_error.md from the stored tables.

use crate::cost::WAYS;
use crate::front::{best_of, find, front};
use crate::machine;
use crate::marked::mark;
use crate::method::{Dial, Method, Setting};
use crate::scenes::Scene;
use crate::table::Row;
use crate::verdict::verdict;
use crate::words::{digits, length, time};
use std::fmt::Write;

/// Title of the report and an explanation of how to read it.
pub fn opening() -> String {
    format!(
        "# Speed against error\n\n\
         Made by `cargo run --release -p compare`, which measures every spring that a Bevy game could use on the \
         same scenes. Do not edit: the command writes this file, and copies the table of *In short* into `docs/accuracy.md`.\n\n\
         - **Methods.** bevy_coilover at 1 to 16 micro-steps, extrapolated, and by tolerance; the tutorial's \
         force `k·stretch + c·rate` written once per step into `ExternalForce`; Rapier's `SpringJoint` at 4 to 32 \
         solver iterations; Avian 0.7's `DistanceJoint` with compliance 1/k and `JointDamping` c/m at 6 to 48 \
         substeps. That damping also brakes motion across the line, and Avian has none along the line alone. So Avian \
         is run with and without it, and the smaller error is given.\n\
         - **Error** is the largest distance of a watched body from its place in an analytic solution or in one by \
         DOP853 or Radau (1e-10 to 1e-12), over the whole time that the scene's description names. A setting has \
         diverged if its error is more than ten times the size of the motion, or not a number. Such settings are \
         named, ours too, and no comparison counts them as beaten.\n\
         - **Time per step** is one whole `app.update()`, everything that Bevy and the engine do included: mean \
         of 15 turns or more, spread over the scene, all methods in turns, after a warm-up, on bodies that may not sleep. *Computing \
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
                dial: Dial::Extrapolated(1),
                rate: 60,
            },
        );
        let cell = |row: Option<Row>| {
            row.map_or("not run".into(), |r| {
                format!("{} · {}", length(&r), time(&r))
            })
        };
        let joint = best_of(rows, Method::Joint);
        let [less, longer] = ratios(ours, joint);
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

/// The joint's error divided by ours, and our time divided by the joint's. A row that diverges has no error to divide.
fn ratios(ours: Option<Row>, joint: Option<Row>) -> [String; 2] {
    let (Some(ours), Some(joint)) = (ours, joint) else {
        return ["–", "–"].map(String::from);
    };
    let less = match (ours.strayed.diverged, joint.strayed.diverged) {
        (true, true) => "both diverge".into(),
        (true, false) => "ours diverges".into(),
        (false, true) => "diverges".into(),
        (false, false) => digits(joint.strayed.error / ours.strayed.error),
    };
    let longer = format!("{:.2}", ours.times.mean / joint.times.mean);
    [less, longer]
}

/// Least number of steps a second from which on none of `rows` diverges, if there is one.
fn stable_from<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<u32> {
    let diverged = rows.clone().filter(|row| row.strayed.diverged);
    let last = diverged.map(|row| row.setting.rate).max();
    let rates = rows.map(|row| row.setting.rate);
    rates
        .filter(|rate| last.is_none_or(|last| *rate > last))
        .min()
}

/// Table of how many settings of each method diverge, in the scenes where some do. Empty if none does.
pub fn diverging(scenes: &[(&Scene, Vec<Row>)]) -> String {
    let mut lines = String::new();
    for (scene, rows) in scenes {
        if !rows.iter().any(|row| row.strayed.diverged) {
            continue;
        }
        let _ = write!(lines, "| {} |", scene.title);
        for way in WAYS {
            let of = rows.iter().filter(|r| way.contains(&r.setting.method));
            let lost = of.clone().filter(|r| r.strayed.diverged).count();
            let cell = match of.clone().count() {
                0 => "not run".into(),
                sum => match stable_from(of) {
                    Some(rate) => format!("{lost} of {sum}, none from {rate} Hz"),
                    None => format!("{lost} of {sum}, also with the shortest step"),
                },
            };
            let _ = write!(lines, " {cell} |");
        }
        lines.push('\n');
    }
    if lines.is_empty() {
        return lines;
    }
    format!(
        "## What diverges\n\nHow many settings diverge, of all that were run, at all time steps, and from how many steps a second \
         on none does: that is the largest stable step. In the scenes that are not named here, none diverges. The sections of the \
         scenes name the settings.\n\n\
         | scene | bevy_coilover | Rapier SpringJoint | Avian distance joint | force once per step |\n\
         |---|---|---|---|---|\n{lines}\n"
    )
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::SCENES;
    use crate::table::row;

    #[test]
    fn what_diverges_has_no_ratio_of_errors() {
        let (ours, joint) = (
            row(Method::Ours, 60, 30e-6, 1e-3),
            row(Method::Joint, 60, 20e-6, 1e-2),
        );
        let lost = |mut row: Row| {
            row.strayed.diverged = true;
            Some(row)
        };
        assert_eq!(ratios(Some(ours), Some(joint)), ["10", "1.50"]);
        assert_eq!(ratios(Some(ours), lost(joint)), ["diverges", "1.50"]);
        assert_eq!(ratios(lost(ours), Some(joint)), ["ours diverges", "1.50"]);
        assert_eq!(ratios(Some(ours), None), ["–", "–"]);
        let rows = vec![
            row(Method::Ours, 60, 30e-6, 1e-3),
            row(Method::Force, 30, 30e-6, 1e-3),
        ];
        let stable = row(Method::Ours, 120, 30e-6, 1e-3);
        let lost = [ours, joint].map(lost).into_iter().flatten();
        let lost = lost.chain([stable]).collect();
        let told = diverging(&[(&SCENES[0], rows), (&SCENES[1], lost)]);
        assert!(!told.contains(SCENES[0].title), "{told}");
        let line = format!(
            "| {} | 1 of 2, none from 120 Hz | 1 of 1, also with the shortest step | not run | not run |",
            SCENES[1].title
        );
        assert!(told.contains(&line), "{told}");
    }
}
