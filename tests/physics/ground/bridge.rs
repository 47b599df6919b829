//! Bridges of planks with a load on them.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const PLANKS: usize = 30;

/// 30 planks of 4 kg between two banks, and three boxes of `load` kg above them. Springs join the planks. If hinged,
/// hinges do, and springs are at the banks only. The springs are lightly damped.
pub fn bridge(k: f32, load: f32, hinged: bool) -> Stand {
    damped_bridge([k, 0.1 * (k * 4.0).sqrt()], load, hinged)
}

/// As [`bridge`], with springs of stiffness `k` and damping `c`.
pub fn damped_bridge([k, c]: [f32; 2], load: f32, hinged: bool) -> Stand {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    let bank = |scene: &mut Stand, x: f32| {
        scene.lab.spawn((
            RigidBody::Fixed,
            Collider::cuboid(0.2, 0.05, 0.5),
            Transform::from_xyz(x, 3.0, 0.0),
        ))
    };
    let near = bank(&mut scene, -0.5);
    let far = bank(&mut scene, PLANKS as f32 * 0.5);
    let mut last = near;
    for i in 0..=PLANKS {
        let next = if i < PLANKS {
            scene.body(
                Transform::from_xyz(0.5 * i as f32, 3.0, 0.0),
                (
                    Collider::cuboid(0.2, 0.03, 0.5),
                    ColliderMassProperties::Mass(4.0),
                ),
            )
        } else {
            far
        };
        if hinged && i > 0 && i < PLANKS {
            let hinge = RevoluteJointBuilder::new(Vec3::Z)
                .local_anchor1(Vec3::X * 0.25)
                .local_anchor2(Vec3::NEG_X * 0.25);
            let joint = ImpulseJoint::new(last, hinge);
            scene.lab.app.world_mut().entity_mut(next).insert(joint);
        } else {
            for z in [-0.45, 0.45] {
                let anchors = [Vec3::new(0.2, 0.0, z), Vec3::new(-0.2, 0.0, z)];
                scene.coil([last, next], anchors, [k, c], None);
            }
        }
        last = next;
    }
    for x in [4.0, 7.0, 10.0] {
        scene.body(
            Transform::from_xyz(x, 3.6, 0.0),
            (
                Collider::cuboid(0.3, 0.3, 0.3),
                ColliderMassProperties::Mass(load),
            ),
        );
    }
    scene
}

#[test]
fn a_bridge_of_springs_carries_boxes_and_wins_nothing() {
    for (k, load, hinged) in [
        (5e4, 100.0, false),
        (5e5, 100.0, false),
        (5e5, 1000.0, false),
        (2e4, 100.0, true),
        (5e5, 100.0, true),
    ] {
        let mut scene = bridge(k, load, hinged);
        scene.lab.tick();
        let first = scene.energy();
        let most = scene.most(20.0) / first;
        let speed = scene.speed();
        println!(
            "bridge, {k} N/m, boxes of {load} kg, hinged {hinged}: E × {most:.4} of {first:.0} J, {speed:.2e} m/s after 20 s"
        );
        assert!(most < 1.02, "{k} {load} {hinged}: E × {most}");
    }
}
