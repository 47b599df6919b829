//! A ragdoll on ball joints with springs for muscles, which falls on the ground.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Kind and stiffness of the muscles.
#[derive(Clone, Copy, Debug)]
pub enum Muscle {
    /// Torsion element about the joint, N m/rad.
    Torsion(f32),
    /// Spring beside the joint, N/m.
    Linear(f32),
}

/// A ragdoll in the air: a torso, a head, and arms and legs of two parts each.
pub fn ragdoll(plugin: CoiloverPlugin, muscle: Muscle) -> Stand {
    let mut scene = Stand::new(plugin, Engine::default());
    scene.ground();
    let capsule = |scene: &mut Stand, at: Vec3, half: f32, radius: f32, mass: f32| {
        let tilt = Quat::from_rotation_x(1.1) * Quat::from_rotation_z(0.3);
        scene.body(
            Transform::from_translation(tilt * at + Vec3::Y * 2.0).with_rotation(tilt),
            (
                Collider::capsule_y(half, radius),
                ColliderMassProperties::Mass(mass),
                CollisionGroups::new(Group::GROUP_2, Group::GROUP_1),
            ),
        )
    };
    let torso = capsule(&mut scene, Vec3::ZERO, 0.2, 0.12, 30.0);
    // Parent; centre of the part in the torso's frame; half length; radius; mass; y of the joint from the part's centre.
    let mut parts = vec![(torso, Vec3::ZERO)];
    for (parent, at, half, radius, mass, up) in [
        (0, Vec3::new(0.0, 0.50, 0.0), 0.05, 0.1, 5.0, -0.15),
        (0, Vec3::new(0.20, 0.05, 0.0), 0.10, 0.05, 2.5, 0.15),
        (2, Vec3::new(0.20, -0.25, 0.0), 0.10, 0.04, 1.5, 0.15),
        (0, Vec3::new(-0.20, 0.05, 0.0), 0.10, 0.05, 2.5, 0.15),
        (4, Vec3::new(-0.20, -0.25, 0.0), 0.10, 0.04, 1.5, 0.15),
        (0, Vec3::new(0.10, -0.55, 0.0), 0.15, 0.07, 8.0, 0.2),
        (6, Vec3::new(0.10, -0.95, 0.0), 0.15, 0.05, 4.0, 0.2),
        (0, Vec3::new(-0.10, -0.55, 0.0), 0.15, 0.07, 8.0, 0.2),
        (8, Vec3::new(-0.10, -0.95, 0.0), 0.15, 0.05, 4.0, 0.2),
    ] {
        let part = capsule(&mut scene, at, half, radius, mass);
        let (holder, holder_at) = parts[parent];
        let here = Vec3::Y * up;
        let there = at + here - holder_at;
        let joint = SphericalJointBuilder::new()
            .local_anchor1(there)
            .local_anchor2(here);
        let world = scene.lab.app.world_mut();
        world
            .entity_mut(part)
            .insert(ImpulseJoint::new(holder, joint));
        match muscle {
            Muscle::Torsion(stiffness) => {
                world.spawn(
                    TorsionSpringDamper::new(holder, part, Vec3::Y)
                        .with_stiffness(stiffness)
                        .with_damping(0.02 * stiffness)
                        .with_rest_angle(0.0),
                );
            }
            Muscle::Linear(stiffness) => {
                let aside = Vec3::Z * radius;
                let anchors = [there + aside + 0.1 * Vec3::Y, here + aside - 0.1 * Vec3::Y];
                let c = 0.1 * (stiffness * mass).sqrt();
                scene.coil([holder, part], anchors, [stiffness, c], None);
            }
        }
        parts.push((part, at));
    }
    scene
}

#[test]
fn a_ragdoll_falls_wins_nothing_and_lies_still() {
    for muscle in [
        Muscle::Torsion(5.0),
        Muscle::Torsion(100.0),
        Muscle::Linear(3e3),
        Muscle::Linear(30e3),
        Muscle::Linear(300e3),
    ] {
        for (name, way) in ways() {
            let mut scene = ragdoll(way, muscle);
            scene.lab.tick();
            let first = scene.energy();
            let most = scene.most(20.0) / first;
            let far = scene.wander(2.0);
            println!(
                "ragdoll, {muscle:?}, {name}: E × {most:.4} of {first:.0} J; after 20 s {} awake, {:.1e} m in 2 s, {:.2e} m/s",
                scene.awake(),
                far,
                scene.speed()
            );
            assert!(most < 1.02, "{muscle:?}, {name}: E × {most}");
            assert_eq!(scene.awake(), 0, "{muscle:?}, {name}");
        }
    }
}
