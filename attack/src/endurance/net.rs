//! A floating net of a thousand springs.

use super::{Endurance, body, direction, lab};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::BTreeMap;

const SIDE: usize = 8;
const DEEP: usize = 6;
/// Distance between neighbouring boxes, m.
const PITCH: f32 = 0.5;
/// Stiffness in N/m and damping in N s/m of each spring.
const STIFFNESS: f32 = 300.0;
const DAMPING: f32 = 5.0;

/// A lattice of 8 × 8 × 6 boxes of 0.5 to 1 kg, with 1 008 springs between neighbours. There is no gravity, so its centre
/// of mass stays where it is.
pub fn net() -> Endurance {
    let mut app = lab(0.0);
    let world = app.world_mut();
    let index = |x: usize, y: usize, z: usize| (z * SIDE + y) * SIDE + x;
    let (mut bodies, mut masses) = (Vec::new(), Vec::new());
    for i in 0..SIDE * SIDE * DEEP {
        let (x, y, z) = (i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE);
        let mass = 0.5 + 0.5 * (i % 3) as f32 / 2.0;
        let mass = (mass, mass * 0.01 * Vec3::new(1.0, 1.2, 1.5));
        let at = PITCH * Vec3::new(x as f32, y as f32, z as f32);
        bodies.push(world.spawn(body(at, mass)).id());
        masses.push(mass);
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
        masses,
        springs,
        gravity: 0.0,
        period: 20.0,
        strike: |scene, strike| {
            // Opposite bodies get equal impulses, so that the net turns little: 0.3 rad/s after a day. The next pair gets the
            // opposite impulse, so that the net does not drift away.
            for pair in 0..scene.bodies.len() / 2 {
                let by = direction(strike, pair as u64 / 2);
                let by = if pair % 2 == 0 { by } else { -by };
                for index in [pair, scene.bodies.len() - 1 - pair] {
                    let mass = scene.masses[index].0;
                    scene.push(scene.bodies[index], by / mass);
                }
            }
        },
        stands: |scene| {
            // Distance of the centre of mass from its first place, m.
            let (mut sum, mut mass) = (Vec3::ZERO, 0.0);
            for (body, (own, _)) in scene.bodies.iter().zip(&scene.masses) {
                sum += *own * scene.place(*body);
                mass += *own;
            }
            let middle =
                0.5 * PITCH * Vec3::new((SIDE - 1) as f32, (SIDE - 1) as f32, (DEEP - 1) as f32);
            (f64::from((sum / mass).distance(middle)), 0.5)
        },
        strikes: 0,
        // 0.079 in a day. It is the error of a step: 0.026 at 120 steps a second, 0.010 at 240.
        missing: Some(0.1),
        surplus: 0.05,
        // Nothing resists a little shear, so a twentieth of the energy is still there after 20 s, and of that a hundredth in
        // springs: 0.32 to 0.34 m/s.
        rests: 0.4,
        faults: BTreeMap::new(),
    }
}
