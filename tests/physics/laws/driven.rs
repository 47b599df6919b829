//! Torsion elements and springs under a user's torque, with a holder that the game turns, or on a fast spinning body.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::{FRAC_PI_4, TAU};

const INERTIA: f64 = 0.2;
const STIFFNESS: f64 = 0.8;
/// Natural angular frequency, rad/s.
const OMEGA: f64 = 2.0;

/// A wheel about z on a torsion spring, whose other end is a hub of the given body kind. Returns hub, wheel and element.
fn wheel(lab: &mut Lab, holder: RigidBody, damping: f32) -> [Entity; 3] {
    let hub = lab.spawn((holder, Transform::default()));
    let wheel = lab.spawn(brick(1.0, Vec3::splat(INERTIA as f32), Vec3::X));
    let element = lab.spawn(
        TorsionSpringDamper::new(hub, wheel, Vec3::Z)
            .with_stiffness(STIFFNESS as f32)
            .with_damping(damping)
            .with_rest_angle(0.0),
    );
    [hub, wheel, element]
}

fn torque(torque: Vec3) -> ExternalForce {
    ExternalForce {
        torque,
        ..default()
    }
}

#[test]
fn a_constant_torque_winds_a_torsion_spring() {
    let mut lab = Lab::weightless();
    let [_, wheel, element] = wheel(&mut lab, RigidBody::Fixed, 0.0);
    lab.app
        .world_mut()
        .entity_mut(wheel)
        .insert(torque(Vec3::Z * 0.1));
    let mut worst = 0.0_f64;
    for i in 1..=lab.ticks(20.0) {
        lab.tick();
        let wanted = 0.1 / STIFFNESS * (1.0 - (OMEGA * i as f64 * lab.dt()).cos());
        worst = worst.max((f64::from(lab.readout(element).length) - wanted).abs());
    }
    println!("torsion spring under a torque: angle within {worst:.1e} of 0.25 rad");
    assert!(worst < 5e-4, "{worst}");
}

#[test]
fn the_heat_of_a_damper_against_a_torque_is_the_work_that_is_missing() {
    let mut lab = Lab::weightless();
    let [_, wheel, element] = wheel(&mut lab, RigidBody::Fixed, 0.1);
    lab.app
        .world_mut()
        .entity_mut(wheel)
        .insert(torque(Vec3::Z * 0.4));
    for _ in 0..lab.ticks(6.0) {
        lab.tick();
        let seen = lab.readout(element);
        let spin = lab.get::<Velocity>(wheel).angular.z;
        let motion = 0.5 * INERTIA as f32 * spin * spin;
        let heat = 0.4 * seen.length - motion - seen.stored_energy;
        let off = (seen.dissipated_energy - heat).abs();
        assert!(off < 1e-3, "{} of {heat} J", seen.dissipated_energy);
    }
    let heat = lab.readout(element).dissipated_energy;
    assert!(heat > 0.05, "{heat}");
}

#[test]
fn a_torque_spins_up_a_body_on_springs_held_off_its_centre() {
    // The springs are soft enough to let the body rotate: one alone, and two in a network.
    for count in [1, 2] {
        let mut lab = Lab::weightless();
        let body = lab.spawn(brick(1.0, Vec3::splat(INERTIA as f32), Vec3::ZERO));
        for side in [1.0, -1.0].into_iter().take(count) {
            let hook = lab.point(Vec3::X * 3.0 * side);
            lab.spawn((
                Spring::new(hook, body)
                    .with_stiffness(1e-3)
                    .with_rest_length(3.0),
                Anchors::new(Vec3::ZERO, Vec3::Y * 0.1),
            ));
        }
        lab.app
            .world_mut()
            .entity_mut(body)
            .insert(torque(Vec3::Z * 0.5));
        lab.run(4.0);
        let spin = f64::from(lab.get::<Velocity>(body).angular.z);
        let wanted = 0.5 / INERTIA * 4.0;
        println!("{count} soft springs: spun up to {spin:.3} of {wanted} rad/s");
        assert!((spin / wanted - 1.0).abs() < 0.01, "{count}: {spin}");
    }
}

#[test]
fn a_fixed_body_that_the_game_turns_winds_its_torsion_spring() {
    let mut lab = Lab::weightless();
    let [hub, wheel, _] = wheel(&mut lab, RigidBody::Fixed, 0.0);
    // The game turns the hub at 1 rad/s, tick by tick. The wheel follows as θ = t − sin(ωt)/ω.
    let mut worst = 0.0_f64;
    for i in 1..=lab.ticks(3.0) {
        let t = i as f64 * lab.dt();
        lab.get_mut::<Transform>(hub).rotation = Quat::from_rotation_z(t as f32);
        lab.tick();
        let now = f64::from(lab.get::<Velocity>(wheel).angular.z);
        worst = worst.max((now - (1.0 - (OMEGA * t).cos())).abs());
    }
    println!("wheel behind a turned holder: spin within {worst:.1e} of 2 rad/s");
    // The hub turns in steps of a tick, which lead by half a tick.
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn a_holder_that_begins_to_turn_wakes_what_hangs_on_its_middle() {
    for holder in [RigidBody::Fixed, RigidBody::KinematicPositionBased] {
        let mut lab = Lab::weightless();
        let [hub, wheel, _] = wheel(&mut lab, holder, 0.05);
        lab.run(5.0);
        assert!(lab.get::<Sleeping>(wheel).sleeping, "{holder:?}");
        for i in 1..=30 {
            lab.get_mut::<Transform>(hub).rotation = Quat::from_rotation_z(0.02 * i as f32);
            lab.tick();
        }
        let spin = lab.get::<Velocity>(wheel).angular.z;
        assert!(spin > 0.1, "{holder:?}: {spin}");
    }
}

#[test]
fn a_body_may_turn_more_than_half_a_turn_in_a_tick_of_many_substeps() {
    // 200 rad/s are 191° per tick. Eight engine steps allow 360°.
    let mut lab = Lab::with(
        CoiloverPlugin::default(),
        Engine {
            substeps: 8,
            ..Engine::weightless()
        },
    );
    let hook = lab.point(Vec3::X * 3.0);
    let top = lab.moving(
        brick(1.0, Vec3::splat(INERTIA as f32), Vec3::ZERO),
        Velocity::angular(Vec3::Z * 200.0),
    );
    lab.spawn((
        Spring::new(hook, top)
            .with_stiffness(1e-3)
            .with_rest_length(3.0),
        Anchors::new(Vec3::ZERO, Vec3::Y * 0.1),
    ));
    lab.run(1.0);
    let spin = lab.get::<Velocity>(top).angular.z;
    println!("spin of 200 rad/s after a second: {spin:.3}");
    assert!((spin - 200.0).abs() < 0.2, "{spin}");
}

#[test]
fn a_wound_wheel_that_the_engine_keeps_from_turning_so_fast_unwinds_its_way() {
    // The spring would turn the wheel round in a fiftieth of a second. The engine allows 45° a tick.
    for turns in [1.0, 5.0] {
        let plugin = CoiloverPlugin::default().with_microsteps(4);
        let mut lab = Lab::with(plugin, Engine::weightless());
        let hub = lab.spawn((RigidBody::Fixed, Transform::default()));
        let wheel = lab.spawn(brick(1.0, Vec3::splat(1e-4), Vec3::X));
        let element = lab.spawn(
            TorsionSpring::new(hub, wheel, Vec3::Z)
                .with_stiffness(1.0)
                .with_rest_angle((turns * TAU) as f32),
        );
        let mut before = 0.0;
        for tick in 1..=(8.0 * turns) as i32 - 1 {
            lab.tick();
            let now = f64::from(lab.readout(element).length);
            let turned = now - before;
            assert!(
                (turned - FRAC_PI_4).abs() < 0.02,
                "{turns} turns, tick {tick}: by {turned} to {now} rad"
            );
            before = now;
        }
    }
}
