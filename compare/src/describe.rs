//! Scenes of points as plain text, for peers that live outside of this process.

use crate::problem::{Kind, Problem};
use crate::scenes::SCENES;
use bevy::math::Vec3;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

/// Writes a file for every scene that points and springs alone can tell.
pub fn write_all(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for scene in &SCENES {
        if let Some(text) = describe(&(scene.make)()) {
            fs::write(folder.join(format!("{}.txt", scene.name)), text)?;
        }
    }
    Ok(())
}

/// A line each: gravity; seconds; bodies (mass, 0 when fixed, place, velocity); links (ends, stiffness, damping,
/// rest length); watched bodies; and where those are at a time, every 1/240 s.
fn describe(problem: &Problem) -> Option<String> {
    if problem.is_nonlinear() {
        return None;
    }
    let vector = |v: Vec3| format!("{} {} {}", v.x, v.y, v.z);
    let mut text = format!(
        "gravity {}\nseconds {}\nsize {}\n",
        vector(problem.gravity),
        problem.seconds,
        problem.size
    );
    for body in &problem.bodies {
        let mass = match body.kind {
            Kind::Fixed => 0.0,
            Kind::Free { mass, .. } if body.spin == Vec3::ZERO => mass,
            _ => return None,
        };
        let _ = writeln!(
            text,
            "body {mass} {} {}",
            vector(body.at),
            vector(body.velocity)
        );
    }
    for link in &problem.links {
        if link.anchors != [Vec3::ZERO; 2] {
            return None;
        }
        let _ = writeln!(
            text,
            "link {} {} {} {} {}",
            link.ends[0], link.ends[1], link.stiffness, link.damping, link.rest
        );
    }
    let watched: Vec<String> = problem.truth.watched.iter().map(usize::to_string).collect();
    let _ = writeln!(text, "watched {}", watched.join(" "));
    for row in 0..=(problem.seconds * 240.0) as u32 {
        let time = f64::from(row) / 240.0;
        let places = (problem.truth.at)(time)?;
        let places: Vec<String> = places
            .iter()
            .map(|p| format!("{} {} {}", p.x, p.y, p.z))
            .collect();
        let _ = writeln!(text, "at {time} {}", places.join(" "));
    }
    Some(text)
}
