//! Checks that the examples still look as they should after ten minutes in their windows. Nothing is drawn: each
//! example watches the positions of its bodies. Runs half a minute of each by default, the whole time with `MINUTES=all`.

#![allow(missing_docs, reason = "a test")]

use pictures::{command, two_at_a_time};

/// Scenes, and the number of minutes that each is watched.
const SCENES: [(&str, &str); 25] = [
    ("trampoline", "1"),
    // Cloth and bridge take long to compute. One crossing of the bridge shows as much as ten.
    ("flag", "5"),
    ("rope_bridge", "5"),
    ("crane", "5"),
    ("jelly", "5"),
    ("catapult", "5"),
    ("tensegrity", "5"),
    ("newtons_chain", "10"),
    ("showcase", "10"),
    ("suspension", "10"),
    ("active_suspension", "10"),
    ("breakable", "10"),
    ("bungee", "10"),
    ("coilover_visible", "10"),
    ("damper_3d", "10"),
    ("damper_visible", "10"),
    ("door_closer", "10"),
    ("free_fall", "10"),
    ("linear_spring", "10"),
    ("natural_frequency", "10"),
    ("nonlinear_spring", "10"),
    ("shock_absorber", "10"),
    ("spring_3d", "10"),
    ("spring_damper", "10"),
    ("torsion_bar", "10"),
];

#[test]
fn after_ten_minutes_nothing_has_left_the_picture_or_lies_askew() {
    let all = std::env::var("MINUTES").is_ok_and(|minutes| minutes == "all");
    two_at_a_time(&SCENES, |&(scene, minutes)| {
        watch(scene, if all { minutes } else { "0.5" })
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
