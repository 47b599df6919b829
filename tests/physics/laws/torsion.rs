//! Torsion springs and dampers.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::TAU;

const INERTIA: f32 = 0.2;
/// Rest angle, rad. It is so small that even at ω·dt = 2 the wheel stays far from the engine's cap of 45° a step.
const REST: f64 = 0.1;

/// A wheel that turns freely about z, and the wall for its spring. Returns wall and wheel.
fn wheel(lab: &mut Lab, spin: f32) -> (Entity, Entity) {
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    let wheel = lab.moving(
        brick(1.0, Vec3::splat(INERTIA), Vec3::X),
        Velocity::angular(Vec3::Z * spin),
    );
    (wall, wheel)
}

#[test]
fn period_and_decay_are_exact_at_any_stiffness_that_the_step_resolves() {
    for (step, zeta) in [(0.02, 0.0), (0.3, 0.0), (1.0, 0.1), (2.0, 0.0), (0.3, 0.3)] {
        let mut lab = Lab::weightless();
        let (wall, wheel) = wheel(&mut lab, 0.0);
        let omega = step * 60.0;
        let k = f64::from(INERTIA) * omega * omega;
        let c = 2.0 * zeta * f64::from(INERTIA) * omega;
        let element = lab.spawn(
            TorsionSpringDamper::new(wall, wheel, Vec3::Z)
                .with_stiffness(k as f32)
                .with_damping(c as f32)
                .with_rest_angle(REST as f32),
        );
        let (gamma, mut worst) = (zeta * omega, 0.0_f64);
        let turn = (omega * omega - gamma * gamma).sqrt();
        for i in 1..=lab.ticks((40.0 / omega).min(20.0)) {
            lab.tick();
            let t = i as f64 * lab.dt();
            let swing = (turn * t).cos() + gamma / turn * (turn * t).sin();
            let wanted = REST - REST * (-gamma * t).exp() * swing;
            worst = worst.max((f64::from(lab.readout(element).length) - wanted).abs());
        }
        println!("torsion, ω·dt {step} ζ {zeta}: angle within {worst:.1e} of {REST} rad");
        assert!(worst < 2e-5, "{worst}");
    }
}

#[test]
fn three_turns_are_wound_up_and_let_go() {
    let mut lab = Lab::weightless();
    let (wall, wheel) = wheel(&mut lab, 0.0);
    let turns = 3.0 * TAU;
    let element = lab.spawn(
        TorsionSpring::new(wall, wheel, Vec3::Z)
            .with_stiffness(0.8)
            .with_rest_angle(turns as f32),
    );
    // ω = 2 rad/s: the angle swings from 0 through 3 turns to 6 turns and back.
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    for i in 1..=lab.ticks(20.0) {
        lab.tick();
        let t = i as f64 * lab.dt();
        let angle = f64::from(lab.readout(element).length);
        worst = worst.max((angle - turns * (1.0 - (2.0 * t).cos())).abs());
        most = most.max(angle);
    }
    println!(
        "three turns: unwinds to {:.3} turns, angle within {worst:.1e} rad over 20 s",
        most / TAU
    );
    assert!(most > 1.99 * turns && worst < 0.02, "{most} {worst}");
    // The torque counts all turns, not just the angle within one turn.
    let seen = lab.readout(element);
    let moment = 0.8 * (seen.length - turns as f32);
    assert!((seen.spring_force - moment).abs() < 1e-4);
}

#[test]
fn turns_that_are_wound_up_stay_while_the_anchors_change() {
    let turns = 3.0 * TAU as f32;
    for is_hinged in [false, true] {
        let [plain, changed] = [false, true].map(|changes| {
            let mut lab = Lab::weightless();
            let (wall, wheel) = wheel(&mut lab, 0.0);
            if is_hinged {
                let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor1(Vec3::X);
                let hinge = ImpulseJoint::new(wall, hinge);
                lab.app.world_mut().entity_mut(wheel).insert(hinge);
            }
            let spring = TorsionSpring::new(wall, wheel, Vec3::Z).with_stiffness(0.8);
            let element = lab.spawn(spring.with_rest_angle(turns));
            // By theory, it is wound by four and a quarter turns then.
            lab.run(1.0);
            if changes {
                let anchors = Anchors::new(Vec3::Y * 0.1, Vec3::X * 0.2);
                lab.app.world_mut().entity_mut(element).insert(anchors);
            }
            lab.run(0.1);
            f64::from(lab.readout(element).length)
        });
        assert!(plain > 4.0 * TAU, "{plain} rad");
        let off = (changed - plain).abs();
        assert!(off < 0.02, "hinged {is_hinged}: {changed}, not {plain} rad");
    }
}

#[test]
fn between_two_free_bodies_the_angular_momentum_stays() {
    let mut lab = Lab::weightless();
    let a = lab.spawn(brick(1.0, Vec3::new(0.1, 0.2, 0.3), Vec3::ZERO));
    let b = lab.moving(
        brick(2.0, Vec3::new(0.3, 0.25, 0.1), Vec3::X),
        Velocity::angular(Vec3::new(0.4, -0.2, 2.0)),
    );
    let element = lab.spawn(
        TorsionSpringDamper::new(a, b, Vec3::Z)
            .with_stiffness(5.0)
            .with_damping(0.0)
            .with_rest_angle(0.0),
    );
    let momentum = |lab: &Lab| {
        [(a, [0.1, 0.2, 0.3]), (b, [0.3, 0.25, 0.1])]
            .into_iter()
            .fold(Vec3::ZERO, |sum, (body, inertia)| {
                let rotation = lab.get::<Transform>(body).rotation;
                let local = rotation.inverse() * lab.get::<Velocity>(body).angular;
                sum + rotation * (Vec3::from(inertia) * local)
            })
    };
    let energy = |lab: &Lab| {
        let motion: f32 = [(a, [0.1, 0.2, 0.3]), (b, [0.3, 0.25, 0.1])]
            .into_iter()
            .map(|(body, inertia)| {
                let rotation = lab.get::<Transform>(body).rotation;
                let local = rotation.inverse() * lab.get::<Velocity>(body).angular;
                0.5 * (Vec3::from(inertia) * local).dot(local)
            })
            .sum();
        motion + lab.readout(element).stored_energy
    };
    let (first, stored) = (momentum(&lab), energy(&lab));
    let (mut worst, mut most, mut least) = (0.0_f32, 0.0_f32, f32::MAX);
    for _ in 0..lab.ticks(10.0) {
        lab.tick();
        worst = worst.max(momentum(&lab).distance(first) / first.length());
        most = most.max(energy(&lab) / stored);
        least = least.min(energy(&lab) / stored);
    }
    println!(
        "two tumbling bodies, 10 s: angular momentum within {worst:.1e}, energy {least:.4} to {most:.4}"
    );
    assert!(
        worst < 1e-3 && most < 1.05 && least > 0.8,
        "{worst} {least} {most}"
    );
}

#[test]
fn a_turning_shaft_drags_a_wheel_along() {
    let mut lab = Lab::weightless();
    let shaft = lab.spawn((
        RigidBody::KinematicVelocityBased,
        Transform::default(),
        Velocity::angular(Vec3::Z * 3.0),
    ));
    let wheel = lab.spawn(brick(1.0, Vec3::splat(INERTIA), Vec3::X));
    let element = lab.spawn(TorsionDamper::new(shaft, wheel, Vec3::Z).with_damping(0.4));
    lab.run(0.5);
    let spin = f64::from(lab.get::<Velocity>(wheel).angular.z);
    let wanted = 3.0 * (1.0 - (-0.4 / f64::from(INERTIA) * 0.5_f64).exp());
    println!("a shaft at 3 rad/s: the wheel has {spin:.5} rad/s, by theory {wanted:.5}");
    assert!((spin - wanted).abs() < 2e-3, "{spin} {wanted}");
    // The work of the shaft is kinetic energy and heat.
    let seen = lab.readout(element);
    let motion = 0.5 * f64::from(INERTIA) * spin * spin;
    let balance = f64::from(seen.work - seen.dissipated_energy) - motion;
    assert!(balance.abs() < 1e-3 * motion, "{balance} {seen:?}");
}

#[test]
fn a_wheel_that_is_blocked_between_two_springs_pulls_no_more_than_they_do() {
    let mut lab = Lab::weightless();
    let (wall, last) = wheel(&mut lab, 0.0);
    let first = lab.moving(
        brick(1.0, Vec3::splat(INERTIA), 2.0 * Vec3::X),
        Velocity::angular(Vec3::Z * 2.0),
    );
    let (near, far) = (3.0, 5.0);
    for (a, b, stiffness) in [(wall, last, near), (last, first, far)] {
        lab.spawn(
            TorsionSpringDamper::new(a, b, Vec3::Z)
                .with_stiffness(stiffness)
                .with_damping(0.3)
                .with_rest_angle(0.0),
        );
    }
    lab.run(0.3);
    let about_z = |lab: &Lab, body: Entity| {
        let turn = lab.get::<Transform>(body).rotation.to_scaled_axis();
        turn.z
    };
    let world = lab.app.world_mut();
    let blocked = (LockedAxes::ROTATION_LOCKED, Velocity::zero());
    world.entity_mut(first).insert(blocked);
    lab.run(10.0);
    let (held, led) = (about_z(&lab, first), about_z(&lab, last));
    assert!(held.abs() > 0.1, "turned by {held} rad");
    let statics = held * far / (near + far);
    assert!(
        (led - statics).abs() < 1e-3 * held.abs(),
        "{led} rad, not {statics}"
    );
}

#[test]
fn a_rest_angle_is_taken_where_the_angle_has_a_meaning() {
    let mut lab = Lab::weightless();
    let (wall, wheel) = wheel(&mut lab, 0.0);
    // Tilted by half a turn across the axis of the spring.
    lab.get_mut::<Transform>(wheel).rotation = Quat::from_rotation_x(std::f32::consts::PI);
    let element = lab.spawn(TorsionSpring::new(wall, wheel, Vec3::Z).with_stiffness(1.0));
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_some());
    assert_eq!(lab.get::<TorsionSpring>(element).rest_angle, None);
    lab.get_mut::<Transform>(wheel).rotation = Quat::from_rotation_z(0.5);
    lab.run(0.1);
    let rest = lab.get::<TorsionSpring>(element).rest_angle;
    assert!(
        rest.is_some_and(|angle| (angle - 0.5).abs() < 1e-5),
        "{rest:?}"
    );
}

#[test]
fn a_friction_brake_stops_a_wheel_and_does_not_throw_it_back() {
    // 60 N m would change the spin by 5 rad/s in a tick.
    for (most, spin) in [(0.6, 3.0_f32), (60.0, 3.0), (60.0, 4.9), (6e3, 3.0)] {
        let mut lab = Lab::weightless();
        let (wall, wheel) = wheel(&mut lab, spin);
        let brake = TorsionDamper::new(wall, wheel, Vec3::Z).with_damping(1e4);
        let brake = lab.spawn((brake, MaxForce(most)));
        for tick in 1..=90 {
            lab.tick();
            let now = lab.get::<Velocity>(wheel).angular.z;
            let slipping = spin - most / INERTIA * DT * tick as f32;
            assert!(now > -0.05 * spin, "{most} N m: {now} rad/s in tick {tick}");
            if slipping > 0.3 {
                assert!((now - slipping).abs() < 0.02, "{most}: {now} {slipping}");
            }
        }
        let now = lab.get::<Velocity>(wheel).angular.z;
        let heat = lab.readout(brake).dissipated_energy;
        let motion = 0.5 * INERTIA * spin * spin;
        println!("a brake of {most} N m: {now:.1e} rad/s, {heat:.3} J of heat of {motion:.3} J");
        assert!(now.abs() < 0.01, "{most}: {now} rad/s");
        assert!((heat / motion - 1.0).abs() < 0.02, "{most}: {heat} J");
    }
}

#[test]
fn a_wheel_that_is_tilted_against_the_axis_bounces_off_its_stops_with_all_its_energy() {
    for tilt in [0.0_f32, 60.0, 90.0, 120.0] {
        let mut lab = Lab::weightless();
        let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
        let tilt = tilt.to_radians();
        let turned = Transform::from_xyz(1.0, 0.0, 0.0).with_rotation(Quat::from_rotation_x(tilt));
        // The twist of a tilted wheel follows a spin about this direction, here at 2 rad/s.
        let gradient = Vec3::new(0.0, -(0.5 * tilt).tan(), 1.0);
        let spin = 2.0 * gradient / gradient.length_squared();
        let wheel = lab.moving(
            brick(1.0, Vec3::splat(INERTIA), Vec3::X),
            Velocity::angular(spin),
        );
        lab.app.world_mut().entity_mut(wheel).insert(turned);
        let spring = TorsionSpring::new(wall, wheel, Vec3::Z)
            .with_stiffness(0.5)
            .with_rest_angle(0.0);
        let spring = lab.spawn((spring, SpringTravel::new(-0.5, 0.5, 2000.0)));
        let first = 0.5 * INERTIA * spin.length_squared();
        let (mut range, mut touched) = ([f32::MAX, 0.0_f32], 0);
        for _ in 0..lab.ticks(10.0) {
            lab.tick();
            let seen = lab.readout(spring);
            let motion = lab.get::<Velocity>(wheel).angular.length_squared();
            let energy = (0.5 * INERTIA * motion + seen.stored_energy) / first;
            range = [range[0].min(energy), range[1].max(energy)];
            touched += u32::from(seen.length.abs() > 0.5);
        }
        println!(
            "stops of a wheel tilted by {tilt:.2} rad: {:.4} to {:.4} of its energy in 10 s, {touched} ticks at a stop",
            range[0], range[1]
        );
        assert!(touched > 5, "{touched}");
        assert!(range[0] > 0.98 && range[1] < 1.02, "{tilt}: {range:?}");
    }
}
