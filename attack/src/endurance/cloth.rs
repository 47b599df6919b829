//! A hanging cloth that wind blows at.

use super::{Endurance, GRAVITY, body, direction, lab};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::BTreeMap;

const SIDE: usize = 16;
/// Distance between neighbouring points, m.
const PITCH: f32 = 0.1;
/// Mass of a point, kg.
const POINT: f32 = 0.01;
/// Stiffness in N/m and damping in N s/m of each thread.
const STIFFNESS: f32 = 100.0;
const DAMPING: f32 = 0.3;
/// Damping that stands for air, at each fourth point of each fourth row, N s/m.
const AIR: f32 = 0.3;

/// A cloth of 16 × 16 points that hangs from its uppermost row.
pub fn cloth() -> Endurance {
    let mut app = lab(GRAVITY);
    let world = app.world_mut();
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, row) = (i % SIDE, i / SIDE);
        let at = PITCH * Vec3::new(x as f32, -(row as f32), 0.0);
        points.push(if row == 0 {
            let at = Transform::from_translation(at);
            world.spawn((RigidBody::Fixed, at)).id()
        } else {
            let locked = LockedAxes::ROTATION_LOCKED;
            world.spawn((body(at, (POINT, Vec3::ONE)), locked)).id()
        });
    }
    let mut springs = Vec::new();
    for i in 0..SIDE * SIDE {
        for (fits, j) in [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ] {
            if fits && j >= SIDE {
                let thread = SpringDamper::new(points[i], points[j])
                    .with_stiffness(STIFFNESS)
                    .with_damping(DAMPING)
                    .with_rest_length(PITCH);
                springs.push(world.spawn(thread).id());
            }
        }
    }
    // The dampers' other ends are far behind the cloth, so that they act across it.
    for i in (0..SIDE * SIDE).filter(|i| i % SIDE % 4 == 3 && i / SIDE % 4 == 3) {
        let at = Vec3::new(PITCH * (i % SIDE) as f32, -PITCH * (i / SIDE) as f32, -50.0);
        let far = world.spawn(Transform::from_translation(at)).id();
        let air = Damper::new(far, points[i]).with_damping(AIR);
        springs.push(world.spawn(air).id());
    }
    Endurance {
        title: "cloth",
        app,
        bodies: points.split_off(SIDE),
        masses: vec![(POINT, Vec3::ONE); SIDE * (SIDE - 1)],
        springs,
        gravity: GRAVITY,
        period: 20.0,
        strike: |scene, strike| {
            let wind = Vec3::Z * direction(strike, 0).z;
            for index in 0..scene.bodies.len() {
                let body = scene.bodies[index];
                scene.push(body, 1.5 * wind);
            }
        },
        stands: |scene| {
            // Expected mean height of the lowest row, by the statics of one hanging thread: each
            // link carries the points below it.
            let row: f32 = (1..SIDE)
                .map(|n| PITCH + (SIDE - n) as f32 * POINT * GRAVITY / STIFFNESS)
                .sum();
            let lowest = &scene.bodies[scene.bodies.len() - SIDE..];
            let mean: f32 =
                lowest.iter().map(|body| scene.place(*body).y).sum::<f32>() / SIDE as f32;
            (f64::from((mean + row).abs() / row), 0.01)
        },
        strikes: 0,
        missing: Some(0.02),
        surplus: 0.02,
        // Columns between those with air dampers swing on for long (0.08 to 0.11 m/s).
        rests: 0.15,
        faults: BTreeMap::new(),
    }
}
