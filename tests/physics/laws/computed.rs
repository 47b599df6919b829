//! Are the numbers that are computed for the first step right, whatever stands beside them and happens before it?

use super::hold::{hook_and_ball, strays};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

#[test]
fn a_load_that_is_put_elsewhere_before_the_first_step_is_held_there() {
    for sag in [false, true] {
        let mut lab = Lab::new();
        lab.set_stepping(false);
        let hook = lab.point(Vec3::Y * 5.0);
        let load = lab.body(3.0, Vec3::Y * 4.0);
        let pair = SpringDamper::new(hook, load);
        let element = if sag {
            lab.spawn((pair, SpringTuning::sag(0.12, 0.3)))
        } else {
            let pair = pair.with_stiffness(100.0).with_rest_length(1.0);
            lab.spawn((pair, HoldPose::new()))
        };
        lab.run(0.1);
        lab.get_mut::<Transform>(load).translation.y = 3.5;
        lab.run(0.1);
        lab.set_stepping(true);
        let moved = strays(&mut lab, load);
        assert!(moved < 1e-3, "sag {sag}: {moved}");
        let world = lab.app.world();
        assert!(world.get::<HoldPose>(element).is_none());
        assert!(world.get::<SpringTuning>(element).is_none());
    }
}

#[test]
fn a_pose_is_held_beside_a_tuning() {
    let (mut lab, [hook, ball]) = hook_and_ball();
    let pair = SpringDamper::new(hook, ball).with_rest_length(0.9);
    let both = (SpringTuning::frequency(2.0, 0.3), HoldPose::new());
    let element = lab.spawn((pair, both));
    let moved = strays(&mut lab, ball);
    assert!(moved < 1e-3, "{moved}");
    let world = lab.app.world();
    assert!(world.get::<HoldPose>(element).is_none());
    assert!(world.get::<SpringTuning>(element).is_none());
}

#[test]
fn a_tuning_that_is_taken_away_after_the_first_step_leaves_no_pose_behind() {
    let (mut lab, [hook, ball]) = hook_and_ball();
    let pair = SpringDamper::new(hook, ball);
    let element = lab.spawn((pair, SpringTuning::frequency(2.0, 0.3)));
    lab.tick();
    let mut entity = lab.app.world_mut().entity_mut(element);
    assert!(entity.take::<SpringTuning>().is_some(), "not final yet");
    lab.tick();
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert(HoldPose::new());
    lab.run(0.1);
    assert!(lab.app.world().get::<HoldPose>(element).is_none());
}

#[test]
fn a_sag_beside_a_preload_leaves_the_body_where_it_was_spawned() {
    for preload in [10.0, -10.0, 60.0] {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::Y * 5.0);
        let load = lab.body(3.0, Vec3::Y * 4.0);
        let tuning = SpringTuning::sag(0.12, 0.3);
        let element = lab.spawn((SpringDamper::new(hook, load), tuning, Preload(preload)));
        let moved = strays(&mut lab, load);
        assert!(moved < 1e-4, "{preload} N: {moved}");
        let pair = lab.get::<SpringDamper>(element);
        let k = 3.0 * 9.81 / 0.12;
        assert!((pair.stiffness - k).abs() < 1e-2, "{pair:?}");
        let rest = 1.0 - (3.0 * 9.81 - preload) / k;
        let off = pair.rest_length.map_or(1.0, |length| length - rest);
        assert!(off.abs() < 1e-5, "{preload} N: {pair:?}");
    }
}

#[test]
fn the_pose_of_a_wound_torsion_spring_counts_its_turns() {
    let mut lab = Lab::weightless();
    let wall = lab.spawn((RigidBody::Fixed, Transform::default()));
    // So heavy that the spring hardly slows it.
    let wheel = lab.spawn(brick(1.0, Vec3::splat(1e3), Vec3::ZERO));
    let hinge = RevoluteJointBuilder::new(Vec3::Z);
    let mut entity = lab.app.world_mut().entity_mut(wheel);
    entity.insert(ImpulseJoint::new(wall, hinge));
    let spring = TorsionSpring::new(wall, wheel, Vec3::Z)
        .with_stiffness(1.0)
        .with_rest_angle(0.0);
    let spring = lab.spawn(spring);
    lab.get_mut::<Velocity>(wheel).angular = Vec3::Z * 8.0;
    lab.run(1.0);
    let angle = lab.readout(spring).length;
    assert!(angle > TAU + 0.5, "{angle}");
    let mut entity = lab.app.world_mut().entity_mut(spring);
    entity.insert(HoldPose::new());
    lab.tick();
    // Nothing loads it, so the preload takes the whole moment away.
    let preload = lab.get::<Preload>(spring).0;
    assert!((preload + angle).abs() < 0.02, "{preload} N m, {angle} rad");
}

#[test]
fn a_pose_beside_a_law_that_gives_nan_waits_for_a_better_one() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let load = lab.body(3.0, Vec3::Y * 4.0);
    let nan = CustomSpringLaw::new(|_: f64| f64::NAN);
    let element = lab.spawn((Spring::new(hook, load), nan, HoldPose::new()));
    lab.run(0.1);
    assert_eq!(lab.get::<SpringFault>(element).field, "ForceLaw");
    assert!(lab.app.world().get::<Preload>(element).is_none());
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert(CustomSpringLaw::new(|x: f64| 100.0 * x));
    lab.get_mut::<Velocity>(load).linear = Vec3::ZERO;
    let moved = strays(&mut lab, load);
    assert!(moved < 1e-3, "{moved}");
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    assert!(lab.get::<Preload>(element).0.is_finite());
}

#[test]
fn a_stiff_spring_that_is_stretched_far_is_preloaded_as_well_as_f32_can() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let load = lab.body(0.515, Vec3::Y * 4.0);
    let pair = SpringDamper::new(hook, load)
        .with_stiffness(1e6)
        .with_damping(500.0)
        .with_rest_length(0.5);
    let element = lab.spawn((pair, HoldPose::new()));
    lab.run(0.5);
    let fault = lab.app.world().get::<SpringFault>(element);
    assert_eq!(fault, None);
    let preload = f64::from(lab.get::<Preload>(element).0);
    let off = preload + 5e5 - 0.515 * GRAVITY;
    assert!(off.abs() < 0.03, "{off} N");
    let moved = lab.position(load).distance(Vec3::Y * 4.0);
    assert!(moved < 1e-4, "{moved} m");
}
