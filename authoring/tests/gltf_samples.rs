//! Runs the samples and tests of the `KHR_physics_rigid_bodies` repository as an independent check.
//!
//! These files are not part of this repository: the environment variable `COILOVER_GLTF_PHYSICS` names the folder with
//! `samples/` and `tests/` of github.com/eoineoineoin/glTF_Physics. Without it the test prints so and is skipped. With
//! `-- --nocapture` it prints the table of `docs/gltf.md`.

use crate::gltf_sample::Sample;
use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::path::{Path, PathBuf};

/// Runs a file and checks the behaviour that its page describes. Returns what was found.
fn judge(folder: &Path, file: &str) -> Result<String, String> {
    let mut sample = Sample::load(folder, file);
    let stem = Path::new(file)
        .file_stem()
        .map(|s| s.to_string_lossy().into_owned())
        .unwrap_or_default();
    let (group, number) = stem.rsplit_once('_').unwrap_or((&stem, ""));
    let check = |right: bool, what: String| if right { Ok(what) } else { Err(what) };
    match (group, number) {
        ("RigidBodies_ColliderTypeMatrix", _) => {
            sample.run(4.0);
            sample.sound()?;
            let moving = (0..3)
                .find(|i| sample.physics(*i).get("motion").is_some())
                .unwrap_or(1);
            let before = sample.at(moving).y;
            sample.run(1.0);
            let y = sample.at(moving).y;
            // Boxes rest half a metre lower than the page says, and the origin of a hull is at its lower end.
            let rests = (y - before).abs() < 0.02 && y > -0.51;
            check(rests, format!("the body rests at {y:.2} m"))
        }
        ("RigidBodies_CollisionFilter", "00" | "01") => {
            sample.run(4.0);
            sample.sound()?;
            let y = [0, 1].map(|node| sample.at(node).y);
            check(
                y[0] > 0.9 && y[1] < -5.0,
                format!("one stays at {:.2} m, one falls to {:.1} m", y[0], y[1]),
            )
        }
        ("RigidBodies_CollisionFilter", _) => {
            sample.run(4.0);
            sample.sound()?;
            let y = [0, 3].map(|node| sample.at(node).y);
            // Each body has two boxes. It rests on its lower box if the filter lets that one collide, else on its upper box.
            check(
                (y[0] - y[1]).abs() > 0.5,
                format!("they rest at {:.2} m and {:.2} m", y[0], y[1]),
            )
        }
        ("RigidBodies_Joint", "09") => {
            // The damping rate is 1/s: the speed error falls by the factor e in each second.
            sample.run(8.0);
            sample.sound()?;
            sample.limits_hold(0.02)?;
            let entity = sample.nodes[&3];
            let speed = sample.stage.get::<Velocity>(entity).angular.x;
            check(
                (speed - std::f32::consts::FRAC_PI_2).abs() < 0.02,
                format!("it turns with {speed:.3} rad/s"),
            )
        }
        ("RigidBodies_Joint", "10") => {
            sample.run(6.0);
            sample.sound()?;
            sample.limits_hold(0.02)?;
            let y = sample.at(3).y;
            check(
                (y - (2.0 - 9.81 / 100.0)).abs() < 0.03,
                format!("it rests at {y:.3} m"),
            )
        }
        ("RigidBodies_Joint", _) => {
            for _ in 0..8 {
                sample.run(0.5);
                sample.sound()?;
                sample.limits_hold(0.02)?;
            }
            Ok("limits hold within 2 cm and 0.02 rad".into())
        }
        ("RigidBodies_Materials", "00" | "01") => {
            let mut peaks = [0.0_f32; 2];
            let mut met = [false; 2];
            for _ in 0..(4.0 / DT) as usize {
                sample.stage.app.update();
                for i in 0..2 {
                    let y = sample.at(i).y;
                    met[i] |= y < 1.05;
                    peaks[i] = if met[i] { peaks[i].max(y) } else { 0.0 };
                }
            }
            sample.sound()?;
            check(
                met == [true; 2] && peaks[1] > peaks[0] + 0.5,
                format!("they jump to {:.2} m and {:.2} m", peaks[0], peaks[1]),
            )
        }
        ("RigidBodies_Materials", _) => {
            let before = [0, 1].map(|i| sample.at(i));
            sample.run(1.0);
            sample.sound()?;
            let slid = [0, 1].map(|i| sample.at(i).distance(before[i]));
            check(
                slid[0] > 1.0 && slid[1] < 0.1,
                format!("they slide {:.2} m and {:.3} m", slid[0], slid[1]),
            )
        }
        ("RigidBodies_MotionProperties", number) => {
            let node = usize::from(matches!(number, "03" | "04" | "05" | "07"));
            let before = sample.place(node);
            let others = [0, 2, 1, 3].map(|i| {
                if number == "06" {
                    sample.at(i)
                } else {
                    Vec3::ZERO
                }
            });
            sample.run(1.0);
            sample.sound()?;
            let after = sample.place(node);
            let moved = after.translation - before.translation;
            let turned = after.rotation.angle_between(before.rotation);
            // Tolerance for one step of 1/60 s and for the frame in which the scene spawns.
            let near = |v: Vec3, to: Vec3| v.distance(to) < 0.04;
            match number {
                "00" => check(
                    moved.length() < 1e-4,
                    format!("it moves {:.1e} m", moved.length()),
                ),
                "01" | "03" => check(near(moved, Vec3::X), format!("it moves {moved:.3}")),
                "02" | "04" => check(
                    (turned - 1.0).abs() < 0.04,
                    format!("it turns {turned:.3} rad"),
                ),
                "05" => check(
                    moved.length() < 1e-4,
                    format!("it moves {:.1e} m", moved.length()),
                ),
                "06" => {
                    let now = [0, 2, 1, 3].map(|i| sample.at(i));
                    let heavy = (now[3] - others[3]).x;
                    let light = (now[1] - others[1]).x;
                    check(
                        heavy > light + 0.5,
                        format!("struck by 100 kg it goes {heavy:.2} m, by 1 kg {light:.2} m"),
                    )
                }
                _ => check(turned < 1e-3, format!("it turns {turned:.1e} rad")),
            }
        }
        _ => {
            sample.run(5.0);
            sample.sound()?;
            sample.limits_hold(0.08)?;
            Ok("loads, runs 5 s, limits hold".into())
        }
    }
}

fn files(folder: &Path, under: &str, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder.join(under))
        .into_iter()
        .flatten()
        .flatten()
    {
        let name = format!("{under}/{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files(folder, &name, found);
        } else if name.ends_with(".gltf") || name.ends_with(".glb") {
            found.push(name);
        }
    }
}

#[test]
fn samples_of_the_extensions_repository() {
    let Some(folder) = std::env::var_os("COILOVER_GLTF_PHYSICS").map(PathBuf::from) else {
        println!("skipped: COILOVER_GLTF_PHYSICS does not name a folder with the samples");
        return;
    };
    let mut all = Vec::new();
    files(&folder, "samples", &mut all);
    files(&folder, "tests", &mut all);
    all.sort();
    assert!(
        all.len() > 50,
        "{} files in {}",
        all.len(),
        folder.display()
    );
    let only = std::env::var("COILOVER_ONLY").unwrap_or_default();
    let mut wrong = Vec::new();
    for file in all.iter().filter(|file| file.contains(&only)) {
        let told = std::panic::catch_unwind(|| judge(&folder, file))
            .unwrap_or_else(|_| Err("it panics".into()));
        match &told {
            Ok(what) => println!("| {file} | holds | {what} |"),
            Err(what) => println!("| {file} | **fails** | {what} |"),
        }
        if told.is_err() {
            wrong.push(file);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
