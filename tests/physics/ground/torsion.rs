//! A torsion element on a body that hangs on a ball joint and also spins about other axes.

use super::stand::*;
use crate::dice::span;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Greatest energy over the first, of a limb of 2 kg on a ball joint 0.5 m above its centre.
fn limb(plugin: CoiloverPlugin, phase: f32, zeta: f32, weight: bool, inertia: Vec3) -> f64 {
    let engine = if weight {
        Engine::default()
    } else {
        Engine::weightless()
    };
    let mut lab = Lab::with(plugin, engine);
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    let spin = Vec3::new(3.0, 5.0, 1.0);
    let at = Vec3::NEG_Y * 0.5;
    let (mass, omega) = (2.0, phase / DT);
    let limb = lab.moving(
        brick(mass, inertia, at),
        Velocity {
            linear: spin.cross(at),
            angular: spin,
        },
    );
    let joint = SphericalJointBuilder::new().local_anchor2(Vec3::Y * 0.5);
    lab.app
        .world_mut()
        .entity_mut(limb)
        .insert(ImpulseJoint::new(wall, joint));
    let element = lab.spawn(
        TorsionSpringDamper::new(wall, limb, Vec3::Y)
            .with_stiffness(inertia.y * omega * omega)
            .with_damping(2.0 * zeta * inertia.y * omega)
            .with_rest_angle(0.0),
    );
    let energy = |lab: &Lab| {
        let v = lab.get::<Velocity>(limb);
        let local = lab.get::<Transform>(limb).rotation.inverse() * v.angular;
        let motion = mass * v.linear.length_squared() + (inertia * local).dot(local);
        let height = if weight {
            lab.position(limb).y + 0.5
        } else {
            0.0
        };
        let stored = lab.readout(element).stored_energy;
        f64::from(0.5 * motion + mass * GRAVITY as f32 * height + stored)
    };
    let first = energy(&lab);
    let mut most = 0.0_f64;
    for _ in 0..lab.ticks(span(20.0)) {
        lab.tick();
        most = most.max(energy(&lab));
    }
    most / first
}

#[test]
fn a_limb_on_a_ball_joint_wins_nothing_however_it_spins() {
    let mut worst = 0.0_f64;
    for (name, way) in ways() {
        for (weight, inertia) in [
            (true, Vec3::splat(0.12)),
            (false, Vec3::splat(0.12)),
            (true, Vec3::new(0.2, 0.05, 0.17)),
            (false, Vec3::new(0.2, 0.05, 0.17)),
        ] {
            for zeta in [0.0, 0.2] {
                let most =
                    [0.1, 0.3, 1.0, 2.0, 3.0].map(|phase| limb(way, phase, zeta, weight, inertia));
                println!(
                    "limb, {name} micro-steps, weight {weight}, inertia {inertia}, ζ {zeta}: E × {most:.3?}"
                );
                worst = most.into_iter().fold(worst, f64::max);
            }
        }
    }
    assert!(worst < 1.02, "{worst}");
}

#[test]
fn a_door_whose_law_had_no_value_for_a_while_swings_again_with_a_sound_one() {
    let mut lab = Lab::weightless();
    let frame = lab.spawn((RigidBody::Fixed, Transform::default()));
    let hinge = RevoluteJointBuilder::new(Vec3::Y).local_anchor2(Vec3::NEG_X * 0.5);
    let door = lab.spawn((
        brick(10.0, Vec3::splat(1.0), Vec3::X * 0.5),
        ImpulseJoint::new(frame, hinge),
    ));
    *lab.get_mut::<Velocity>(door) = Velocity {
        linear: Vec3::NEG_Z,
        angular: Vec3::Y * 2.0,
    };
    // Without a value beyond 0.3 rad.
    let law = CustomSpringLaw::new(|x: f64| if x.abs() > 0.3 { f64::NAN } else { 20.0 * x });
    let element = lab.spawn((
        TorsionSpringDamper::new(frame, door, Vec3::Y)
            .with_stiffness(20.0)
            .with_damping(0.5)
            .with_rest_angle(0.0),
        law,
    ));
    lab.run(0.5);
    assert!(lab.app.world().get::<SpringFault>(element).is_some());
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<CustomSpringLaw>();
    let mut least = f32::INFINITY;
    for _ in 0..lab.ticks(4.0) {
        lab.tick();
        least = least.min(lab.readout(element).length);
    }
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    let angle = lab.get::<Transform>(door).rotation.to_scaled_axis().y;
    let told = lab.readout(element).length;
    assert!((angle - told).abs() < 1e-3, "{told}, not {angle}");
    assert!(least < -0.1, "it swings back: {least} rad");
}
