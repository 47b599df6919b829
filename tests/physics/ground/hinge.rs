//! Springs on a body that a hinge holds.

use super::stand::*;
use crate::dice::span;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A level arm of 1 m and 2 kg on a hinge, with a spring from its free end up to a hook. `phase`
/// is ω·dt of the arm about its hinge.
fn arm(plugin: CoiloverPlugin, phase: f32, zeta: f32) -> Stand {
    let mut scene = Stand::new(plugin, Engine::default());
    let wall = scene.lab.spawn((RigidBody::Fixed, Transform::default()));
    let hook = scene
        .lab
        .spawn((RigidBody::Fixed, Transform::from_xyz(1.0, 1.0, 0.0)));
    let mass = 2.0;
    let arm = scene.body(
        Transform::from_xyz(0.5, 0.0, 0.0),
        (
            Collider::cuboid(0.5, 0.03, 0.03),
            ColliderMassProperties::Mass(mass),
            ImpulseJoint::new(
                wall,
                RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.5),
            ),
        ),
    );
    // Effective mass of the arm at its free end: inertia about the hinge over length squared.
    let at_the_end = mass / 3.0;
    let omega = phase / DT;
    let (k, c) = (at_the_end * omega * omega, 2.0 * zeta * at_the_end * omega);
    let anchors = [Vec3::ZERO, Vec3::X * 0.5];
    scene.coil([hook, arm], anchors, [k, c], Some(0.9));
    scene
}

#[test]
fn a_stiff_spring_on_a_hinged_arm_wins_nothing() {
    for phase in [0.1, 1.0, 5.0, 10.0, 20.0] {
        for zeta in [0.0, 0.1, 1.0] {
            for (name, way) in ways() {
                let mut scene = arm(way, phase, zeta);
                scene.lab.tick();
                let floor = -2.0 * GRAVITY;
                let first = scene.energy() - floor;
                let most = (scene.most(span(20.0)) - floor) / first;
                let last = (scene.energy() - floor) / first;
                println!(
                    "arm, ω·dt {phase}, ζ {zeta}, {name}: E × {most:.4} of {first:.1} J, at the end × {last:.4} and {:.2e} m/s",
                    scene.speed()
                );
                assert!(most < 1.02, "ω·dt {phase}, ζ {zeta}, {name}: E × {most}");
            }
        }
    }
}

/// Twist of a torsion bar at rest as a multiple of the twist that statics gives. The bar carries an arm with a load at its end.
fn loaded_arm(damping: f32, inertia: f32, on_a_body: bool) -> f64 {
    const ARM: f32 = 0.7;
    const LOAD: f32 = 40.0;
    const BAR: f32 = 700.0;
    const SET: f32 = 0.45;
    let mut lab = Lab::new();
    let frame = if on_a_body {
        lab.spawn((brick(1e4, Vec3::splat(1e5), Vec3::ZERO), LockedAxes::all()))
    } else {
        lab.spawn((RigidBody::Fixed, Transform::default()))
    };
    let hinge = RevoluteJointBuilder::new(Vec3::Z).build();
    let arm = lab.spawn((
        RigidBody::Dynamic,
        AdditionalMassProperties::MassProperties(MassProperties {
            local_center_of_mass: Vec3::X * ARM,
            mass: LOAD,
            principal_inertia: Vec3::splat(inertia),
            ..default()
        }),
        Transform::from_rotation(Quat::from_rotation_z(SET)),
        ImpulseJoint::new(frame, TypedJoint::RevoluteJoint(hinge)),
    ));
    let bar = lab.spawn(
        TorsionSpringDamper::new(frame, arm, Vec3::Z)
            .with_stiffness(BAR)
            .with_damping(damping)
            .with_rest_angle(SET),
    );
    lab.run(15.0);
    let twist = f64::from(SET - lab.readout(bar).length);
    let moment = f64::from(LOAD * ARM) * GRAVITY * (f64::from(SET) - twist).cos();
    twist / (moment / f64::from(BAR))
}

#[test]
fn an_arm_rests_where_statics_say_however_light_it_is_beside_its_load() {
    let mut worst = 0.0_f64;
    for on_a_body in [false, true] {
        for (damping, inertia) in [(60.0, 0.4), (200.0, 0.4), (60.0, 5.0), (200.0, 5.0)] {
            let twist = loaded_arm(damping, inertia, on_a_body);
            println!(
                "arm, {damping} N m s/rad, {inertia} kg m², on a body {on_a_body}: twist × {twist:.5}"
            );
            worst = worst.max((twist - 1.0).abs());
        }
    }
    assert!(worst < 1e-3, "{worst}");
}
