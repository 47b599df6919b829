//! A cloth that hangs and is blown at.

use super::{Endurance, GRAVITY, direction, lab};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SIDE: usize = 24;
/// m.
const PITCH: f32 = 0.1;
/// kg.
const POINT: f32 = 0.01;
/// N/m and N s/m of each thread.
const STIFFNESS: f32 = 200.0;
const DAMPING: f32 = 0.3;

/// 24 × 24 points that hang from those of their uppermost row: what all weigh hangs on that row.
pub fn cloth() -> Endurance {
    let mut app = lab(GRAVITY);
    let world = app.world_mut();
    let mut points = Vec::new();
    for i in 0..SIDE * SIDE {
        let (x, row) = (i % SIDE, i / SIDE);
        let at = Transform::from_xyz(PITCH * x as f32, -PITCH * row as f32, 0.0);
        points.push(if row == 0 {
            world.spawn((RigidBody::Fixed, at)).id()
        } else {
            let mass = AdditionalMassProperties::Mass(POINT);
            let locked = LockedAxes::ROTATION_LOCKED;
            let body = (
                RigidBody::Dynamic,
                at,
                mass,
                locked,
                Velocity::default(),
                ReadMassProperties::default(),
            );
            world.spawn(body).id()
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
    Endurance {
        title: "cloth",
        app,
        bodies: points.split_off(SIDE),
        springs,
        gravity: GRAVITY,
        pause: 20.0,
        strike: |scene, strike| {
            let wind = direction(strike, 0);
            for index in 0..scene.bodies.len() {
                let body = scene.bodies[index];
                scene.push(body, Vec3::new(0.3 * wind.x, 0.0, 1.5 * wind.z));
            }
        },
        stands: |scene| {
            // The middle of its lowest row, where statics of one hanging thread put it: each thread carries what is below.
            let row: f32 = (1..SIDE)
                .map(|n| PITCH + (SIDE - n) as f32 * POINT * GRAVITY / STIFFNESS)
                .sum();
            let lowest = &scene.bodies[scene.bodies.len() - SIDE..];
            let mean: f32 =
                lowest.iter().map(|body| scene.place(*body).y).sum::<f32>() / SIDE as f32;
            (f64::from((mean + row).abs() / row), 0.01)
        },
        strikes: 0,
        explained: Some(0.02),
    }
}
