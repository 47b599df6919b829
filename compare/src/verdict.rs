//! Sentences that sum up a scene: how many settings of the others bevy_coilover beats, and which settings diverge.
//!
//! A setting that diverges counts neither as beaten nor as compared. It is named, of bevy_coilover as of the others.

use crate::front::{best_of, find, unbeaten, unbeaten_at_their_step};
use crate::method::{Method, Setting};
use crate::table::Row;
use crate::words::{digits, length, name, name_at};
use std::fmt::Write;

/// Methods that a scene is compared with. Avian has two variants in the tables.
const OTHERS: [Method; 3] = [Method::Joint, Method::Force, Method::Avian];

/// Sentences that sum up a scene's table.
pub fn verdict(rows: &[Row]) -> String {
    let is_ours = |row: &Row| row.setting.method == Method::Ours;
    let (ours, peers): (Vec<Row>, Vec<Row>) = rows.iter().copied().partition(is_ours);
    if peers.is_empty() || ours.is_empty() {
        return String::new();
    }
    let mut text = beaten(rows, &ours, &peers);
    text.push_str(&diverging("their", &peers));
    text.push_str(&diverging("our", &ours));
    text.push_str(&not_run(rows));
    for method in OTHERS {
        text.push_str(&against(rows, method));
    }
    text
}

/// How many of the others' settings that do not diverge have a larger error than ours, and which do not.
fn beaten(rows: &[Row], ours: &[Row], peers: &[Row]) -> String {
    let sum = peers.iter().filter(|r| !r.strayed.diverged).count();
    if sum == 0 {
        return "**Every setting of the others diverges.**".into();
    }
    let left = unbeaten(rows);
    let share = match left.len() {
        0 => format!("all {sum}"),
        count => format!("{} of the {sum}", sum - count),
    };
    let mut text = format!(
        "**Our error is below that of {share} settings of the others that do not diverge, in no more computing time.**"
    );
    let cheapest = ours.iter().map(Row::work).fold(f64::INFINITY, f64::min);
    let (cheap, close): (Vec<Row>, Vec<Row>) = left.into_iter().partition(|r| r.work() < cheapest);
    for (head, rows) in [
        ("Cheaper than every setting of ours", cheap),
        ("No less exact than ours in the same time", close),
    ] {
        if !rows.is_empty() {
            let _ = write!(text, " {head}: {}.", list(&rows));
        }
    }
    let _ = write!(
        text,
        " With the same time step as theirs, our error is below that of {} of {sum}.",
        sum - unbeaten_at_their_step(rows).len()
    );
    text
}

fn list(rows: &[Row]) -> String {
    const MOST: usize = 5;
    let mut parts: Vec<String> = rows
        .iter()
        .take(MOST)
        .map(|r| format!("{} ({})", name(r.setting), length(r)))
        .collect();
    if rows.len() > MOST {
        parts.push(format!("and {} more", rows.len() - MOST));
    }
    parts.join("; ")
}

/// How many of somebody's settings diverge, and which.
fn diverging(whose: &str, rows: &[Row]) -> String {
    let sum = rows.len();
    let lost: Vec<Setting> = rows
        .iter()
        .filter(|r| r.strayed.diverged)
        .map(|r| r.setting)
        .collect();
    let names = together(&lost);
    match lost.len() {
        0 => format!(" None of {whose} {sum} settings diverges."),
        1 => format!(" One of {whose} {sum} settings diverges: {names}."),
        count => format!(" {count} of {whose} {sum} settings diverge: {names}."),
    }
}

/// Names of settings. Those that differ only in their tick rate are named together.
fn together(settings: &[Setting]) -> String {
    let mut sorted = settings.to_vec();
    sorted.sort_by_key(|s| (s.method, s.dial, s.rate));
    let parts: Vec<String> = sorted
        .chunk_by(|a, b| (a.method, a.dial) == (b.method, b.dial))
        .map(|same| {
            let rates: Vec<String> = same.iter().map(|s| s.rate.to_string()).collect();
            name_at(same[0], &rates.join(", "))
        })
        .collect();
    parts.join("; ")
}

/// Names the methods without a row.
fn not_run(rows: &[Row]) -> String {
    let missing: Vec<&str> = OTHERS
        .into_iter()
        .filter(|method| !rows.iter().any(|r| r.setting.method == *method))
        .map(Method::title)
        .collect();
    if missing.is_empty() {
        return String::new();
    }
    format!(
        " Not run in this scene, and so not counted: {}.",
        missing.join(", ")
    )
}

/// Compares the default of bevy_coilover with the default of another method, at 60 steps per second.
fn against(rows: &[Row], method: Method) -> String {
    let ours = find(rows, Setting::default_of(Method::Ours, 60));
    let (Some(ours), Some(peer)) = (ours, best_of(rows, method)) else {
        return String::new();
    };
    let ratio = ours.times.mean / peer.times.mean;
    let errors = match (ours.strayed.diverged, peer.strayed.diverged) {
        (true, true) => "both diverge".into(),
        (true, false) => "ours diverges".into(),
        (false, true) => "it diverges".into(),
        (false, false) if peer.strayed.error < ours.strayed.error => format!(
            "the error {} times larger",
            digits(ours.strayed.error / peer.strayed.error)
        ),
        (false, false) => format!(
            "the error {} times smaller",
            digits(peer.strayed.error / ours.strayed.error)
        ),
    };
    format!(
        " Our default step takes {ratio:.2} times as long as {}: {errors}.",
        name(peer.setting)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Dial;
    use crate::table::row;

    fn lost(method: Method, rate: u32, step: f64) -> Row {
        let mut row = row(method, rate, step, 14.0);
        row.strayed.diverged = true;
        row
    }

    #[test]
    fn what_diverges_is_named_and_not_beaten() {
        let mut finer = lost(Method::Ours, 30, 50e-6);
        finer.setting.dial = Dial::Microsteps(2);
        let rows = [
            lost(Method::Ours, 30, 50e-6),
            finer,
            row(Method::Ours, 60, 30e-6, 1e-3),
            lost(Method::Force, 30, 90e-6),
            lost(Method::Force, 60, 45e-6),
            row(Method::Joint, 30, 10e-6, 1e-1),
            row(Method::Joint, 60, 40e-6, 1e-1),
        ];
        let told = verdict(&rows);
        let wanted = "**Our error is below that of 1 of the 2 settings of the others that do not diverge, in no more \
                      computing time.** Cheaper than every setting of ours: Rapier SpringJoint, 4 iterations, at 30 Hz \
                      (100 mm). With the same time step as theirs, our error is below that of 1 of 2. 2 of their 4 \
                      settings diverge: force once per step at 30, 60 Hz. 2 of our 3 settings diverge: bevy_coilover, \
                      default, at 30 Hz; bevy_coilover, 2 micro-steps, at 30 Hz. Not run in this scene, and so not \
                      counted: Avian distance joint. Our default step takes 0.75 times as long as Rapier SpringJoint, 4 \
                      iterations, at 60 Hz: the error 100 times smaller. Our default step takes 0.67 times as long as \
                      force once per step at 60 Hz: it diverges.";
        assert_eq!(told, wanted);
    }

    #[test]
    fn nothing_is_beaten_where_ours_or_all_others_diverge() {
        let told = verdict(&[
            lost(Method::Ours, 60, 30e-6),
            row(Method::Joint, 60, 40e-6, 1e-1),
        ]);
        assert!(told.contains("below that of 0 of the 1 settings"), "{told}");
        assert!(told.contains("at 60 Hz: ours diverges."), "{told}");
        let told = verdict(&[
            row(Method::Ours, 60, 30e-6, 1e-3),
            lost(Method::Joint, 60, 40e-6),
        ]);
        assert!(!told.contains("below"), "{told}");
        assert!(told.contains("One of their 1 settings diverges"), "{told}");
    }
}
