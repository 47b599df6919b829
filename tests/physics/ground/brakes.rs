//! A braked wheel on a sprung trailing arm: Rapier's sweeps leave it a motion that nothing drives.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const LOAD: f32 = 300.0;
const ARM: f32 = 0.45;
const RADIUS: f32 = 0.33;
/// Angle of the arm below the horizontal, rad.
const DOWN: f32 = 0.3;
/// Damping of the motor that brakes the wheel, N m s/rad, as in the guide's car.
const GRIP: f32 = 1000.0;

/// Lets a quarter of a car stand on its braked wheel, with so many sweeps. Returns its speed, m/s, and the moment of its spring as a
/// share of that at rest.
fn stand(sweeps: usize) -> [f32; 2] {
    let mut lab = Lab::new();
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Friction::new(1.0),
        Transform::default(),
    ));
    let height = RADIUS + ARM * DOWN.sin();
    let post = lab.spawn((RigidBody::Fixed, Transform::from_xyz(0.0, height, 0.0)));
    let locked = JointAxesMask::LIN_Z | JointAxesMask::ANG_AXES;
    let guide = TypedJoint::GenericJoint(GenericJointBuilder::new(locked).build());
    let load = lab.spawn((
        brick(LOAD, Vec3::splat(50.0), Vec3::Y * height),
        ImpulseJoint::new(post, guide),
    ));
    let turned = Quat::from_rotation_z(DOWN);
    let half = 0.5 * ARM * Vec3::X;
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(half);
    let arm = lab.spawn((
        brick(10.0, Vec3::new(0.02, 0.17, 0.17), Vec3::ZERO),
        ImpulseJoint::new(load, hinge),
    ));
    let start = Vec3::Y * height;
    *lab.get_mut::<Transform>(arm) =
        Transform::from_translation(start - turned * half).with_rotation(turned);
    let axle = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(-half)
        .motor_model(MotorModel::ForceBased)
        .motor_velocity(0.0, GRIP);
    lab.spawn((
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(20.0),
        Friction::new(1.0),
        Transform::from_translation(start - 2.0 * (turned * half)),
        ImpulseJoint::new(arm, axle),
    ));
    let moment = GRAVITY as f32 * ARM * DOWN.cos() * (LOAD + 0.5 * 10.0);
    let stiffness = LOAD * (std::f32::consts::TAU * 1.5).powi(2) * ARM * ARM;
    let spring = lab.spawn(
        TorsionSpringDamper::new(load, arm, Vec3::Z)
            .with_stiffness(stiffness)
            .with_damping(0.6 * (stiffness * LOAD * ARM * ARM).sqrt())
            .with_rest_angle(DOWN + moment / stiffness),
    );
    let mut contexts = lab.app.world_mut().query::<&mut RapierContextSimulation>();
    for mut context in contexts.iter_mut(lab.app.world_mut()) {
        context.integration_parameters.num_internal_pgs_iterations = sweeps;
    }
    lab.run(20.0);
    [
        lab.velocity(load).x.abs(),
        -lab.readout(spring).spring_force / moment,
    ]
}

#[test]
fn a_braked_wheel_on_a_sprung_arm_stands_still_with_sixteen_sweeps() {
    for sweeps in [1, 4, 16] {
        let [speed, moment] = stand(sweeps);
        println!("{sweeps} sweeps: {speed:.4} m/s, moment × {moment:.4}");
        if sweeps == 16 {
            assert!(speed < 2e-3, "{speed} m/s");
            assert!((moment - 1.0).abs() < 5e-3, "{moment}");
        }
    }
}
