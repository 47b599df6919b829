//! Checks that the examples look as before. Each is run as a user runs it, and its picture is compared with
//! `references/`. After an intended visual change, look at the new pictures and keep them: `UPDATE_REFERENCES=1 cargo
//! test --workspace --test references look`.

#![allow(missing_docs, reason = "a test")]

use image::{RgbImage, imageops};
use pictures::{command, root, two_at_a_time};

const SCENES: [&str; 22] = [
    "rope_bridge",
    "linear_spring",
    "nonlinear_spring",
    "spring_3d",
    "damper_3d",
    "damper_visible",
    "spring_damper",
    "coilover_visible",
    "bungee",
    "torsion_bar",
    "door_closer",
    "free_fall",
    "natural_frequency",
    "suspension",
    "drive",
    "flag",
    "crane",
    "jelly",
    "catapult",
    "tensegrity",
    "newtons_chain",
    "showcase",
];
/// Size in which pictures are compared and kept: details that matter stay visible.
const SIZE: (u32, u32) = (480, 270);
/// Number of tiles across and down a picture. The worst tile counts, because a coil is a small part of a picture.
const TILES: (u32, u32) = (8, 5);
/// Least likeness of a tile; 1 is identical. Edges and rounding of other drivers lower it little, a missing coil much
/// more.
const ALIKE: f64 = 0.85;

/// Whether this machine may have no graphics adapter.
fn may_skip() -> bool {
    std::env::var_os("COILOVER_MUST_DRAW").is_none()
}

/// Returns the likeness of the most different tiles of two pictures.
fn likeness(a: &RgbImage, b: &RgbImage) -> f64 {
    let (width, height) = (SIZE.0 / TILES.0, SIZE.1 / TILES.1);
    let mut worst = 1.0_f64;
    for x in 0..TILES.0 {
        for y in 0..TILES.1 {
            let cut = |of: &RgbImage| {
                imageops::crop_imm(of, x * width, y * height, width, height).to_image()
            };
            let alike = image_compare::rgb_hybrid_compare(&cut(a), &cut(b)).expect("equal sizes");
            worst = worst.min(alike.score);
        }
    }
    worst
}

#[test]
fn the_examples_look_as_they_did_and_their_checks_hold() {
    two_at_a_time(&SCENES, |scene| looks_as_it_did(scene));
}

fn looks_as_it_did(scene: &str) {
    let shot = std::env::temp_dir().join(format!("{scene}_{}.png", std::process::id()));
    let mut example = command(scene);
    let run = example.arg("--small").arg("--screenshot").arg(&shot);
    let run = run.output().expect("the example runs");
    let told = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{scene}: {told}");
    if !shot.exists() {
        assert!(may_skip(), "{scene}: {told}");
        eprintln!("SKIPPED: {scene} finds no graphics adapter on this machine: {told}");
        return;
    }
    let full = image::open(&shot).expect("a picture").to_rgb8();
    let _ = std::fs::remove_file(&shot);
    let seen = imageops::resize(&full, SIZE.0, SIZE.1, imageops::FilterType::Triangle);
    let kept = root()
        .join("pictures/references")
        .join(format!("{scene}.png"));
    if std::env::var_os("UPDATE_REFERENCES").is_some() {
        seen.save(&kept).expect("written");
        return;
    }
    let kept = image::open(&kept).expect("a reference").to_rgb8();
    let alike = likeness(&seen, &kept);
    println!("{scene}: {alike:.4} alike");
    assert!(alike > ALIKE, "{scene}: only {alike:.4} alike");
}

#[test]
fn a_missing_coil_would_be_noticed() {
    let kept = root().join("pictures/references");
    for scene in ["spring_3d", "spring_damper", "natural_frequency"] {
        let whole = image::open(kept.join(format!("{scene}.png")));
        let whole = whole.expect("a reference").to_rgb8();
        let mut without = whole.clone();
        for x in 0..SIZE.0 {
            for y in 0..SIZE.1 {
                let [r, g, _] = whole.get_pixel(x, y).0;
                if r > g.saturating_add(30) {
                    *without.get_pixel_mut(x, y) = *whole.get_pixel(4, y);
                }
            }
        }
        let alike = likeness(&without, &whole);
        println!("{scene} without its coils: {alike:.4} alike");
        assert!(alike < ALIKE, "{scene}: {alike:.4}");
    }
}

/// Sends the signal of Ctrl-C once the first picture of a film is there.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_film_and_keeps_the_pictures_that_are_done() {
    use std::process::Command;
    use std::time::Duration;

    let folder = std::env::temp_dir().join(format!("film_{}", std::process::id()));
    let example = command("linear_spring");
    // Of programs that a script starts in the background, the shell has the signal ignored; `env` undoes this.
    let mut film = Command::new("env")
        .arg("--default-signal=INT")
        .arg(example.get_program())
        .args(example.get_args())
        .args(["--small", "--frames"])
        .arg(&folder)
        .current_dir(root())
        .spawn()
        .expect("the example runs");
    let pictures = || {
        let files = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let names = files.map(|file| file.path());
        let done = names.filter(|name| !name.to_string_lossy().ends_with(".part.png"));
        done.collect::<Vec<_>>()
    };
    while pictures().is_empty() {
        if let Some(status) = film.try_wait().expect("a process") {
            assert!(status.success() && may_skip());
            eprintln!("SKIPPED: no graphics adapter on this machine");
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let signal = Command::new("kill")
        .args(["-INT", &film.id().to_string()])
        .status();
    assert!(signal.expect("a signal").success());
    // Had it not heeded the signal, all pictures would be there at its end.
    film.wait().expect("a process");
    let done = pictures();
    println!("{} pictures", done.len());
    assert!(done.len() < 48);
    for picture in &done {
        image::open(picture).expect("a whole picture");
    }
    let _ = std::fs::remove_dir_all(&folder);
}
