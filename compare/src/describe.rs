//! Writes scenes of point masses as plain text, for engines that run outside this process (`compare/peers`).

use crate::problem::{Kind, Problem};
use crate::scenes::SCENES;
use bevy::math::Vec3;
use std::fmt::Write;
use std::path::Path;
use std::{fs, io};

/// Writes one file for every scene that consists of point masses and linear springs only.
pub fn write_all(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    for scene in &SCENES {
        if let Some(text) = describe(&(scene.make)()) {
            fs::write(folder.join(format!("{}.txt", scene.name)), text)?;
        }
    }
    Ok(())
}

/// Returns the text of a scene, or `None` if it has more than points and linear springs. It has one line for each of:
/// gravity; seconds; size; every body (mass or 0 if fixed, position, velocity); every link (ends, stiffness, damping,
/// rest length); the watched bodies; and, every 1/240 s, the time and the true positions of the watched bodies.
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
