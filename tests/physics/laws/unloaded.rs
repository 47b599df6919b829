//! When no element can hold a load, or hardly any load is there to be held.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// An arm of 2 kg that hangs from a hinge at `hinge`, a point of the post at `post`. Its centre of mass is 1 m below the hinge and
/// `aside` metres beside that. A torsion spring about the hinge is tuned to sag by 0.1 rad.
fn hung(post: Vec3, hinge: Vec3, aside: f32) -> (Lab, Entity) {
    let mut lab = Lab::new();
    let center = hinge + aside * Vec3::X;
    let arm = lab.spawn((
        RigidBody::Dynamic,
        Transform::from_translation(post + Vec3::NEG_Y),
        AdditionalMassProperties::MassProperties(MassProperties {
            local_center_of_mass: center,
            mass: 2.0,
            principal_inertia: Vec3::splat(0.05),
            ..default()
        }),
        Velocity::default(),
    ));
    let post = lab.spawn((RigidBody::Fixed, Transform::from_translation(post)));
    let joint = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(hinge)
        .local_anchor2(hinge + Vec3::Y);
    lab.app
        .world_mut()
        .entity_mut(arm)
        .insert(ImpulseJoint::new(post, joint));
    let spring = TorsionSpring::new(post, arm, Vec3::Z);
    let element = lab.spawn((spring, SpringTuning::sag(0.1, 0.3)));
    lab.run(0.05);
    (lab, element)
}

#[test]
fn an_arm_that_hangs_a_twentieth_of_a_millimetre_off_the_vertical_is_a_load() {
    // 5e-5 of what would load it if it were level.
    let aside = 5e-5;
    let (lab, element) = hung(Vec3::ZERO, Vec3::ZERO, aside);
    let fault = lab.app.world().get::<SpringFault>(element);
    assert!(fault.is_none(), "{fault:?}");
    let stiffness = lab.get::<TorsionSpring>(element).stiffness;
    let wanted = 2.0 * GRAVITY as f32 * aside / 0.1;
    assert!((stiffness / wanted - 1.0).abs() < 0.01, "{stiffness}");
}

#[test]
fn an_arm_that_hangs_straight_down_is_not_loaded_by_the_rounding_of_its_hinge() {
    // 100 m away, the engine rounds the place of the hinge by 3 µm, which is 3e-6 of what would load a level arm.
    let (lab, element) = hung(Vec3::X * 100.0, Vec3::X * 0.3, 0.0);
    let fault = lab.get::<SpringFault>(element);
    assert_eq!(fault.field, "SpringTuning", "{fault}");
    assert!(fault.reason.contains("no weight"), "{fault}");
}

#[test]
fn an_element_that_would_need_ten_times_the_weight_is_level() {
    for (drop, is_level) in [(0.05, true), (0.2, false)] {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let load = lab.body(1.0, Vec3::new(1.0, -drop, 0.0));
        let element = lab.spawn((Spring::new(hook, load), HoldPose::new()));
        lab.run(0.05);
        let fault = lab.app.world().get::<SpringFault>(element);
        let told = fault.map(|fault| fault.reason.contains("level"));
        assert_eq!(told, is_level.then_some(true), "{drop} m: {fault:?}");
    }
}

#[test]
fn an_element_too_near_to_the_hinge_of_its_arm_does_not_hold_the_arm() {
    // Of the inverse mass of the free arm along the element, the hinge leaves 2.6e-4 at 1 cm and 2.3e-5 at 3 mm.
    for (lever, holds) in [(0.01, true), (0.003, false)] {
        let mut lab = Lab::new();
        let post = lab.spawn((RigidBody::Fixed, Transform::default()));
        let (mass, middle) = (0.8, 0.275);
        let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * middle);
        let arm = lab.spawn((
            brick(mass, Vec3::new(1e-4, 0.02, 0.02), Vec3::X * middle),
            ImpulseJoint::new(post, hinge),
        ));
        let anchors = Anchors::new(Vec3::new(lever, 0.2, 0.0), Vec3::X * (lever - middle));
        let spring = Spring::new(post, arm).with_stiffness(1e5);
        let element = lab.spawn((spring, anchors, HoldPose::new()));
        lab.run(0.05);
        let world = lab.app.world();
        let fault = world.get::<SpringFault>(element);
        let preload = world.get::<Preload>(element).map(|preload| preload.0);
        if holds {
            assert!(fault.is_none(), "{fault:?}");
            let wanted = mass * GRAVITY as f32 * middle / lever;
            let off = preload.unwrap_or(0.0) / wanted - 1.0;
            assert!(off.abs() < 0.01, "{preload:?} against {wanted}");
        } else {
            let reason = fault.map_or("", |fault| fault.reason.as_str());
            assert!(reason.contains("joints hold"), "{fault:?} {preload:?}");
        }
    }
}
