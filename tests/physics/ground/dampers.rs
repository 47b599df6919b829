//! Strong dampers between bodies that touch something.

use super::bridge::damped_bridge;
use super::stand::*;
use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Resistance of the air, which ends the swinging across the springs.
const AIR: Damping = Damping {
    linear_damping: 1.0,
    angular_damping: 1.0,
};

/// Largest share of its weight that the springs of a body do not carry, among `bodies`, which touch nothing.
fn uncarried(scene: &Stand, bodies: &[Entity]) -> f64 {
    let lacks = |body: &Entity| {
        let mass = f64::from(scene.lab.get::<ReadMassProperties>(*body).get().mass);
        let weight = mass * scene.gravity;
        let mut force = weight * DVec3::NEG_Y;
        for coil in &scene.coils {
            for (end, sign) in [1.0, -1.0].into_iter().enumerate() {
                if coil.ends[end] == *body {
                    let [a, b] = scene.places(coil.ends, coil.anchors);
                    let stretch = scene.length(coil) - f64::from(coil.rest_length);
                    let direction = (b - a).normalize().as_dvec3();
                    force += sign * f64::from(coil.stiffness) * stretch * direction;
                }
            }
        }
        let lacks = force.length() / weight;
        assert!(lacks.is_finite(), "{body}: {force}");
        lacks
    };
    bodies.iter().map(lacks).fold(0.0, f64::max)
}

#[test]
fn springs_with_strong_dampers_carry_each_plank_at_rest() {
    let k = 5e4_f32;
    // Damping in units of √(k m). At 2 a plank on one spring would be critically damped.
    for share in [0.1, 1.0, 3.0, 7.0] {
        let mut scene = damped_bridge([k, share * (k * 4.0).sqrt()], 20.0, false);
        for body in scene.bodies.clone() {
            scene.lab.app.world_mut().entity_mut(body).insert(AIR);
        }
        scene.most(30.0);
        // Boxes lie on some of the others.
        let free: Vec<_> = [0, 1, 2, 3, 4, 25, 26, 27, 28, 29]
            .map(|plank| scene.bodies[plank])
            .into();
        let (lacks, speed) = (uncarried(&scene, &free), scene.speed());
        println!(
            "damping {share} √(k m): {lacks:.1e} of a plank's weight not carried, {speed:.1e} m/s"
        );
        assert!(lacks < 0.15, "{share}: {lacks}");
        assert!(speed < 2e-3, "{share}: {speed} m/s");
    }
}

#[test]
fn a_net_with_strong_dampers_carries_its_knots_under_a_ball() {
    const SIDE: usize = 7;
    let (k, mass) = (2e3_f32, 0.3_f32);
    for share in [0.1, 1.0, 3.0, 7.0] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let mut knots = Vec::new();
        let mut free = Vec::new();
        for i in 0..SIDE * SIDE {
            let (x, z) = (i % SIDE, i / SIDE);
            let at = Vec3::new(0.5 * x as f32 - 1.5, 3.0, 0.5 * z as f32 - 1.5);
            let is_rim = [x, z].iter().any(|i| [0, SIDE - 1].contains(i));
            knots.push(if is_rim {
                scene
                    .lab
                    .spawn((RigidBody::Fixed, Transform::from_translation(at)))
            } else {
                let mass = ColliderMassProperties::Mass(mass);
                let body = (Collider::ball(0.05), mass, LockedAxes::ROTATION_LOCKED, AIR);
                let knot = scene.body(Transform::from_translation(at), body);
                if at.xz().length() > 0.8 {
                    free.push(knot);
                }
                knot
            });
        }
        for i in 0..knots.len() {
            for next in [(i % SIDE + 1 < SIDE).then_some(i + 1), Some(i + SIDE)] {
                if let Some(next) = next.filter(|next| *next < knots.len()) {
                    let damping = share * (k * mass).sqrt();
                    let ends = [knots[i], knots[next]];
                    scene.coil(ends, [Vec3::ZERO; 2], [k, damping], Some(0.4));
                }
            }
        }
        let ball = (Collider::ball(0.4), ColliderMassProperties::Mass(5.0), AIR);
        scene.body(Transform::from_xyz(0.0, 3.5, 0.0), ball);
        scene.most(20.0);
        let (lacks, speed) = (uncarried(&scene, &free), scene.speed());
        println!(
            "damping {share} √(k m): {lacks:.1e} of a knot's weight not carried, {speed:.1e} m/s"
        );
        assert!(lacks < 0.15, "{share}: {lacks}");
        assert!(speed < 2e-3, "{share}: {speed} m/s");
    }
}

#[test]
fn sliders_on_a_rail_with_strong_dampers_carry_one_another() {
    let (k, mass) = (5e3_f32, 1.0_f32);
    for share in [0.1, 1.0, 3.0, 7.0] {
        let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
        let rail = (RigidBody::Fixed, Transform::from_xyz(0.0, 9.0, 0.0));
        let rail = scene.lab.spawn(rail);
        let mut last = rail;
        for i in 1..=16 {
            let below = Vec3::NEG_Y * (0.5 * i as f32);
            let guide = PrismaticJointBuilder::new(Vec3::Y).local_anchor1(below);
            let slider = (
                AdditionalMassProperties::MassProperties(MassProperties {
                    mass,
                    principal_inertia: Vec3::splat(0.01),
                    ..default()
                }),
                ImpulseJoint::new(rail, guide),
                AIR,
            );
            let next = scene.body(Transform::from_translation(Vec3::Y * 9.0 + below), slider);
            let damping = share * (k * mass).sqrt();
            scene.coil([last, next], [Vec3::ZERO; 2], [k, damping], None);
            last = next;
        }
        scene.most(20.0);
        let (lacks, speed) = (uncarried(&scene, &scene.bodies.clone()), scene.speed());
        println!(
            "on a rail, damping {share} √(k m): {lacks:.1e} of a slider's weight not carried, {speed:.1e} m/s"
        );
        assert!(lacks < 0.15, "{share}: {lacks}");
        assert!(speed < 2e-3, "{share}: {speed} m/s");
    }
}
