//! Springs along a fixed axis instead of along the line between their ends.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn along_an_axis_of_the_world_nothing_is_felt_across_it() {
    // As in the tutorial: the spring acts vertically only, while the body drifts sideways.
    let mut lab = Lab::new();
    let plane = lab.point(Vec3::ZERO);
    let body = lab.moving(
        body(1.0, Vec3::new(0.3, 2.0, 0.0)),
        Velocity::linear(Vec3::X * 1.5),
    );
    let spring = Spring::new(plane, body)
        .with_stiffness(40.0)
        .with_rest_length(2.0);
    lab.spawn((spring, SpringAxis::World(Vec3::Y * 7.0)));
    let omega = 40.0_f64.sqrt();
    let (mut worst, mut across) = (0.0_f64, 0.0_f64);
    for i in 1..=lab.ticks(10.0) {
        lab.tick();
        let t = i as f64 * lab.dt();
        let at = lab.position(body).as_dvec3();
        let y = 2.0 - GRAVITY / 40.0 * (1.0 - (omega * t).cos());
        worst = worst.max((at.y - y).abs());
        across = across.max((at.x - 0.3 - 1.5 * t).abs());
    }
    println!("along y only: within {worst:.1e} m over 10 s, across it within {across:.1e} m of 15");
    // The error across the axis is the engine's rounding at 15 m from the origin.
    assert!(worst < 1e-4 && across < 2e-3, "{worst} {across}");
}

#[test]
fn along_an_axis_of_body_a_both_momenta_stay() {
    let mut lab = Lab::weightless();
    let a = lab.moving(
        brick(2.0, Vec3::new(0.3, 0.4, 0.5), Vec3::ZERO),
        Velocity::angular(Vec3::new(0.1, 0.2, 0.5)),
    );
    let b = lab.moving(
        brick(1.0, Vec3::splat(0.1), Vec3::new(1.4, 0.3, 0.0)),
        Velocity::linear(Vec3::new(0.2, 0.1, 0.3)),
    );
    let spring = Spring::new(a, b).with_stiffness(30.0).with_rest_length(1.0);
    let element = lab.spawn((spring, SpringAxis::BodyA(Vec3::X)));
    let parts = [
        (a, 2.0_f32, Vec3::new(0.3, 0.4, 0.5)),
        (b, 1.0, Vec3::splat(0.1)),
    ];
    let sums = |lab: &Lab| {
        let mut sums = (Vec3::ZERO, Vec3::ZERO, lab.readout(element).stored_energy);
        for (body, mass, inertia) in parts {
            let (at, velocity) = (lab.get::<Transform>(body), lab.get::<Velocity>(body));
            let local = at.rotation.inverse() * velocity.angular;
            let spin = at.rotation * (inertia * local);
            sums.0 += mass * velocity.linear;
            sums.1 += spin + at.translation.cross(mass * velocity.linear);
            sums.2 +=
                0.5 * mass * velocity.linear.length_squared() + 0.5 * (inertia * local).dot(local);
        }
        sums
    };
    lab.tick();
    let first = sums(&lab);
    let mut worst = [0.0_f32; 3];
    for _ in 0..lab.ticks(5.0) {
        lab.tick();
        let now = sums(&lab);
        worst[0] = worst[0].max(now.0.distance(first.0));
        worst[1] = worst[1].max(now.1.distance(first.1));
        worst[2] = worst[2].max((now.2 / first.2 - 1.0).abs());
    }
    println!(
        "along an axis of body A, 5 s: linear momentum within {:.1e}, angular within {:.1e}, energy within {:.1e}",
        worst[0], worst[1], worst[2]
    );
    assert!(
        worst[0] < 1e-4 && worst[1] < 2e-3 && worst[2] < 2e-2,
        "{worst:?}"
    );
}
