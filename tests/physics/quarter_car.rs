//! Does a spring act correctly on a wheel that stands on the ground?

use crate::fit::exact;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const CHASSIS: f32 = 250.0;
const WHEEL: f32 = 20.0;
const RADIUS: f32 = 0.3;
const REST: f32 = 0.5;

struct Car {
    lab: Lab,
    chassis: Entity,
    wheel: Entity,
    element: Entity,
}

/// A chassis above a wheel above the ground. Both move only vertically.
fn car(mut lab: Lab, stiffness: f32, damping: f32, wheel_height: f32, length: f32) -> Car {
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    let upright = LockedAxes::TRANSLATION_LOCKED_X
        | LockedAxes::TRANSLATION_LOCKED_Z
        | LockedAxes::ROTATION_LOCKED;
    let wheel = lab.spawn((
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(WHEEL),
        Transform::from_xyz(0.0, wheel_height, 0.0),
        Velocity::default(),
        Sleeping::default(),
        // A wheel at 8 m/s would be a hand's breadth deep in the ground before Rapier detects the contact. Pushing
        // it out against the spring would do work.
        SoftCcd { prediction: 0.3 },
        upright,
    ));
    let chassis = lab.spawn((body(CHASSIS, Vec3::Y * (wheel_height + length)), upright));
    let element = lab.spawn(
        SpringDamper::new(wheel, chassis)
            .with_stiffness(stiffness)
            .with_damping(damping)
            .with_rest_length(REST),
    );
    Car {
        lab,
        chassis,
        wheel,
        element,
    }
}

/// Rapier's contact with the ground is itself a spring (60 Hz). For the comparison with a fixed base, it has to be
/// hard.
fn hard_ground() -> Lab {
    let mut lab = Lab::new();
    let mut contexts = lab.app.world_mut().query::<&mut RapierContextSimulation>();
    let mut context = contexts
        .single_mut(lab.app.world_mut())
        .expect("one context");
    context
        .integration_parameters
        .static_contact_softness
        .natural_frequency = 1000.0;
    lab
}

#[test]
fn sag_and_motion_are_those_of_the_chassis_on_a_fixed_base() {
    for (k, c, bar) in [
        (30e3, 2e3, 0.02),
        (30e3, 0.0, 0.02),
        (200e3, 100.0, 0.10),
        (1e6, 0.0, 0.10),
        (30e3, 20e3, 0.10),
    ] {
        let sag = f64::from(CHASSIS) * GRAVITY / f64::from(k);
        let mut car = car(hard_ground(), k, c, RADIUS, REST - 0.5 * sag as f32);
        let omega = (f64::from(k) / f64::from(CHASSIS)).sqrt();
        let zeta = f64::from(c) / (2.0 * omega * f64::from(CHASSIS));
        let level = f64::from(RADIUS + REST) - sag;
        let start = f64::from(car.lab.position(car.chassis).y) - level;
        let (mut worst, mut when) = (0.0_f64, 0);
        for i in 1..=300 {
            car.lab.tick();
            let t = f64::from(i) * f64::from(DT);
            let y = f64::from(car.lab.position(car.chassis).y) - level;
            let error = (y - exact(omega, zeta, start, 0.0, t)).abs() / sag;
            if error > worst {
                (worst, when) = (error, i);
            }
        }
        println!(
            "quarter car, k {k} c {c}: sag {:.2} mm, largest error {worst:.4} of it (tick {when}, bar {bar})",
            1e3 * sag
        );
        assert!(
            worst <= bar,
            "k {k} c {c}: {worst} of the sag at tick {when}"
        );
        if zeta > 0.01 {
            car.lab.run(60.0);
            let left = f64::from(REST - car.lab.readout(car.element).length) / sag - 1.0;
            assert!(left.abs() <= 5e-3, "k {k} c {c}: {left:e} of the sag left");
        }
    }
}

/// Drops the car from `height`, m. Returns the energy at the start and at the end of each flight, J, and the
/// height of the first peak, m.
fn bounces(damping: f32, dt: f32, height: f32) -> (Vec<f64>, f64) {
    let engine = Engine { dt, ..default() };
    let mut car = car(
        Lab::with(CoiloverPlugin::default(), engine),
        60e3,
        damping,
        RADIUS + height,
        REST,
    );
    let energy = |car: &Car| {
        let lab = &car.lab;
        let of = |body: Entity, mass: f32| {
            let (y, v) = (f64::from(lab.position(body).y), lab.velocity(body));
            f64::from(mass) * (GRAVITY * y + 0.5 * f64::from(v.length_squared()))
        };
        of(car.chassis, CHASSIS)
            + of(car.wheel, WHEEL)
            + f64::from(lab.readout(car.element).stored_energy)
    };
    car.lab.tick();
    let (mut tops, mut first) = (vec![energy(&car)], 0.0);
    let (mut landed, mut highest) = (false, 0.0_f64);
    for _ in 0..car.lab.ticks(12.0) {
        car.lab.tick();
        let y = f64::from(car.lab.position(car.chassis).y);
        if car.lab.position(car.wheel).y < RADIUS + 0.01 {
            if landed && highest > 1.0 {
                // A flight is over: record its peak and its energy.
                if first == 0.0 {
                    first = highest;
                }
                tops.push(energy(&car));
            }
            (landed, highest) = (true, 0.0);
        } else if landed {
            highest = highest.max(y);
        }
    }
    (tops, first)
}

#[test]
fn a_wheel_that_lands_and_bounces_gains_nothing() {
    for c in [0.0, 300.0] {
        let (tops, coarse) = bounces(c, DT, 1.0);
        let (_, fine) = bounces(c, 1.0 / 240.0, 1.0);
        println!(
            "dropped from 1 m, c {c}: energies {tops:.0?} J, first peak {coarse:.3} m, at 1/240 s {fine:.3} m"
        );
        assert!(
            (coarse / fine - 1.0).abs() < 0.05,
            "c {c}: {coarse} and {fine} m"
        );
    }
    // Where the ground is hit within a step depends on the height.
    let mut worst = 0.0_f64;
    for i in -20..20 {
        let height = 1.0 + 0.0057 * i as f32;
        let (tops, _) = bounces(0.0, DT, height);
        assert!(tops.len() > 2);
        for pair in tops.windows(2) {
            worst = worst.max(pair[1] / pair[0]);
            assert!(pair[1] <= pair[0] * 1.001, "from {height} m: {pair:?} J");
        }
    }
    println!("of 40 heights, the bounce that lost least kept {worst:.4} of its energy");
}

#[test]
fn it_sleeps_standing_and_wakes_when_pushed() {
    let mut car = car(Lab::new(), 30e3, 3e3, RADIUS, REST);
    car.lab.run(8.0);
    assert!(car.lab.velocity(car.chassis).length() < 1e-3);
    assert!(car.lab.is_sleeping(car.wheel));
    car.lab.spawn_force(car.chassis, Vec3::Y * -2000.0);
    let before = car.lab.position(car.chassis).y;
    car.lab.run(0.3);
    assert!(before - car.lab.position(car.chassis).y > 0.02);
}
