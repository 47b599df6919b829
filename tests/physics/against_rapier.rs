//! How accurate are the two springs that Rapier itself offers, for the soft elastic pendulum?

use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const K: f32 = 50.0;

/// Largest position error over 10 s, m.
fn worst(mut lab: Lab, weight: Entity, mut each_tick: impl FnMut(&mut Lab)) -> f64 {
    let rows = reference(include_str!("../data/pendulum_k50.csv"));
    let mut worst = 0.0_f64;
    for row in rows.iter().step_by(4).skip(1) {
        each_tick(&mut lab);
        lab.tick();
        let wanted = DVec3::new(row[1], row[2], 0.0);
        worst = worst.max(lab.position(weight).as_dvec3().distance(wanted));
    }
    worst
}

fn joint() -> f64 {
    let mut lab = Lab::new();
    let pivot = lab.spawn((RigidBody::Fixed, Transform::default()));
    let weight = lab.body(1.0, Vec3::X);
    let joint = SpringJointBuilder::new(1.0, K, 0.0);
    lab.app
        .world_mut()
        .entity_mut(weight)
        .insert(ImpulseJoint::new(pivot, joint));
    worst(lab, weight, |_| {})
}

/// The force of the spring, set once per step.
fn force() -> f64 {
    let mut lab = Lab::new();
    let weight = lab.body(1.0, Vec3::X);
    lab.spawn_force(weight, Vec3::ZERO);
    worst(lab, weight, |lab| {
        let x = lab.position(weight);
        let tension = K * (x.length() - 1.0);
        lab.get_mut::<ExternalForce>(weight).force = -tension * x.normalize();
    })
}

fn ours() -> f64 {
    let mut lab = Lab::new();
    let pivot = lab.point(Vec3::ZERO);
    let weight = lab.body(1.0, Vec3::X);
    lab.spawn(
        Spring::new(pivot, weight)
            .with_stiffness(K)
            .with_rest_length(1.0),
    );
    worst(lab, weight, |_| {})
}

#[test]
fn the_soft_pendulum_is_hundreds_of_times_closer_to_the_truth() {
    let (ours, joint, force) = (ours(), joint(), force());
    println!(
        "soft elastic pendulum, 10 s at 1/60 s: ours {ours:.5} m, SpringJoint {joint:.3} m, force once per step {force:.3} m"
    );
    assert!(joint > 300.0 * ours && force > 1000.0 * ours);
}
