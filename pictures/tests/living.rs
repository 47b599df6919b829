//! Checks that the examples still look as they should after ten minutes in their windows. Nothing is drawn: each
//! example watches the positions of its bodies. Runs each for half a minute or
//! until its check after the first restart by default, the whole time with `MINUTES=all`.

#![allow(missing_docs, reason = "a test")]

use pictures::{command, two_at_a_time};

/// Those that take longest to compute come first.
const SCENES: [&str; 25] = [
    "trampoline",
    "flag",
    "rope_bridge",
    "crane",
    "jelly",
    "catapult",
    "tensegrity",
    "newtons_chain",
    "showcase",
    "suspension",
    "active_suspension",
    "breakable",
    "bungee",
    "coilover_visible",
    "damper_3d",
    "damper_visible",
    "door_closer",
    "free_fall",
    "linear_spring",
    "natural_frequency",
    "nonlinear_spring",
    "shock_absorber",
    "spring_3d",
    "spring_damper",
    "torsion_bar",
];

#[test]
fn after_ten_minutes_nothing_has_left_the_picture_or_lies_askew() {
    let all = std::env::var("MINUTES").is_ok_and(|minutes| minutes == "all");
    two_at_a_time(&SCENES, |scene| {
        watch(scene, if all { "10" } else { "0.5" })
    });
}

fn watch(scene: &str, minutes: &str) {
    let run = command(scene).args(["--minutes", minutes]).output();
    let run = run.expect("the example runs");
    let told = String::from_utf8_lossy(&run.stdout);
    println!("{}", told.lines().last().unwrap_or(scene));
    let wrong = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{scene}: {wrong}");
}
