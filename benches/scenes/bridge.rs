//! A long rope bridge: planks that turn, each hung on two ropes between its neighbours.

use super::{body, weigh};
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// The bridge is wound up like a ramp in a car park, so that all of it is so near the origin that `f32` resolves its motion. Radius
/// and rise per turn, m.
const RADIUS: f32 = 100.0;
const RISE: f32 = 3.0;
/// Distance between the middles of neighbouring planks, and half the length and width of a plank, m.
const PITCH: f32 = 0.5;
const HALF: Vec2 = Vec2::new(0.2, 0.5);

/// Spawns a bridge of `planks` planks, on two ropes per gap. Its outermost ropes end at fixed points.
pub fn bridge(world: &mut World, planks: u32) {
    let place = |plank: u32| {
        let angle = plank as f32 * PITCH / RADIUS;
        let turn = Quat::from_rotation_y(-angle);
        let rise = RISE * angle / std::f32::consts::TAU;
        Transform::from_translation(turn * Vec3::NEG_Z * RADIUS + Vec3::Y * rise)
            .with_rotation(turn)
    };
    let mut last = world.spawn(place(0)).id();
    for plank in 1..=planks + 1 {
        let at = place(plank);
        let next = if plank <= planks {
            let kick = Vec3::Y * (plank % 2) as f32 * 0.2;
            let next = body(world, at.translation, kick);
            weigh(world, next, 10.0, Vec3::new(0.9, 1.0, 0.2));
            world.entity_mut(next).insert(at);
            next
        } else {
            world.spawn(at).id()
        };
        for side in [HALF.y, -HALF.y] {
            let edge = |along: f32| Vec3::new(along, 0.0, side);
            world.spawn((
                SpringDamper::new(last, next)
                    .with_stiffness(2000.0)
                    .with_damping(10.0)
                    .with_rest_length(PITCH - 2.0 * HALF.x - 0.005),
                Anchors::new(edge(HALF.x), edge(-HALF.x)),
            ));
        }
        last = next;
    }
}
