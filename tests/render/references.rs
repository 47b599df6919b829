//! Do the examples look as they did? Each is run as a user runs it, and its picture compared with
//! `references/`. After a change that is meant to be seen, look at the new pictures and keep them:
//! `UPDATE_REFERENCES=1 cargo test --test render look`.

use crate::canvas::{alone, can_draw};
use image::imageops;
use std::path::Path;
use std::process::Command;

const SCENES: [&str; 8] = [
    "spring_3d",
    "damper_3d",
    "damper_visible",
    "spring_damper",
    "coilover_visible",
    "free_fall",
    "natural_frequency",
    "showcase",
];
/// Pictures are compared and kept this small: what matters is still seen.
const SIZE: (u32, u32) = (480, 270);
/// One is the same picture. Other drivers' edges and rounding cost a few thousandths; a missing or
/// misplaced part costs more than this.
const ALIKE: f64 = 0.97;

#[test]
fn the_examples_look_as_they_did_and_their_checks_hold() {
    if !can_draw() {
        return;
    }
    let _alone = alone();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for scene in SCENES {
        let shot = std::env::temp_dir().join(format!("{scene}_{}.png", std::process::id()));
        let run = Command::new(env!("CARGO"))
            .current_dir(root)
            .args(["run", "--quiet", "--example", scene, "--", "--screenshot"])
            .arg(&shot)
            .output()
            .expect("cargo runs");
        let told = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{scene}: {told}");
        let full = image::open(&shot).expect("a picture").to_rgb8();
        let _ = std::fs::remove_file(&shot);
        let seen = imageops::resize(&full, SIZE.0, SIZE.1, imageops::FilterType::Triangle);
        let kept = root.join(format!("tests/render/references/{scene}.png"));
        if std::env::var_os("UPDATE_REFERENCES").is_some() {
            seen.save(&kept).expect("written");
            continue;
        }
        let kept = image::open(&kept).expect("a reference").to_rgb8();
        let likeness = image_compare::rgb_hybrid_compare(&seen, &kept).expect("equal sizes");
        println!("{scene}: {:.4} alike", likeness.score);
        assert!(
            likeness.score > ALIKE,
            "{scene}: only {:.4} alike",
            likeness.score
        );
    }
}
