//! A net of a thousand springs that floats.

use super::{Endurance, direction, lab};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const SIDE: usize = 8;
const DEEP: usize = 6;
/// m.
const PITCH: f32 = 0.5;
/// N/m and N s/m.
const STIFFNESS: f32 = 300.0;
const DAMPING: f32 = 1.0;

/// A lattice of 8 × 8 × 6 boxes of 0.5 to 1 kg, with 1 008 springs from corner to corner. It weighs nothing, so its centre of
/// mass stays where it is.
pub fn net() -> Endurance {
    let mut app = lab(0.0);
    let world = app.world_mut();
    let index = |x: usize, y: usize, z: usize| (z * SIDE + y) * SIDE + x;
    let mut bodies = Vec::new();
    for i in 0..SIDE * SIDE * DEEP {
        let (x, y, z) = (i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        let mass = 0.5 + 0.5 * (i % 3) as f32 / 2.0;
        let properties = AdditionalMassProperties::MassProperties(MassProperties {
            mass,
            principal_inertia: mass * 0.01 * Vec3::new(1.0, 1.2, 1.5),
            ..default()
        });
        let at = Transform::from_translation(PITCH * Vec3::new(x as f32, y as f32, z as f32));
        let body = (
            RigidBody::Dynamic,
            at,
            properties,
            Velocity::default(),
            ReadMassProperties::default(),
        );
        bodies.push(world.spawn(body).id());
    }
    let mut springs = Vec::new();
    for i in 0..bodies.len() {
        let (x, y, z) = (i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        for (fits, j, along) in [
            (x + 1 < SIDE, index(x + 1, y, z), Vec3::X),
            (y + 1 < SIDE, index(x, y + 1, z), Vec3::Y),
            (z + 1 < DEEP, index(x, y, z + 1), Vec3::Z),
        ] {
            if fits {
                let spring = SpringDamper::new(bodies[i], bodies[j])
                    .with_stiffness(STIFFNESS)
                    .with_damping(DAMPING)
                    .with_rest_length(PITCH - 0.2);
                springs.push(
                    world
                        .spawn((spring, Anchors::new(0.1 * along, -0.1 * along)))
                        .id(),
                );
            }
        }
    }
    Endurance {
        title: "net",
        app,
        bodies,
        springs,
        gravity: 0.0,
        pause: 20.0,
        strike: |scene, strike| {
            // Equal and opposite pushes, or it would leave.
            for pair in 0..scene.bodies.len() / 2 {
                let by = direction(strike, pair as u64);
                let ends = [
                    scene.bodies[pair],
                    scene.bodies[scene.bodies.len() - 1 - pair],
                ];
                let masses = ends.map(|body| {
                    scene
                        .app
                        .world()
                        .get::<ReadMassProperties>(body)
                        .map_or(1.0, |m| m.mass)
                });
                scene.push(ends[0], by / masses[0]);
                scene.push(ends[1], -by / masses[1]);
            }
        },
        stands: |scene| {
            // How far its centre of mass has wandered, as a share of its size.
            let (mut sum, mut mass) = (Vec3::ZERO, 0.0);
            for body in &scene.bodies {
                let own = scene
                    .app
                    .world()
                    .get::<ReadMassProperties>(*body)
                    .map_or(0.0, |m| m.mass);
                sum += own * scene.place(*body);
                mass += own;
            }
            let middle =
                0.5 * PITCH * Vec3::new((SIDE - 1) as f32, (SIDE - 1) as f32, (DEEP - 1) as f32);
            (f64::from((sum / mass).distance(middle)), 0.5)
        },
        strikes: 0,
        explained: Some(0.02),
    }
}
