//! Loads rest where they were spawned, by `HoldPose` or by a tuned sag.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Greatest distance of a body from its place within three seconds, m.
pub(super) fn strays(lab: &mut Lab, body: Entity) -> f32 {
    let start = lab.position(body);
    let mut most = 0.0_f32;
    for _ in 0..lab.ticks(3.0) {
        lab.tick();
        most = most.max(lab.position(body).distance(start));
    }
    most
}

/// A hook, and 1 m below it a ball of 2 kg. What can touch something is tuned once more after the first step.
pub(super) fn hook_and_ball() -> (Lab, [Entity; 2]) {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let ball = lab.spawn((
        RigidBody::Dynamic,
        Collider::ball(0.2),
        ColliderMassProperties::Mass(2.0),
        Transform::from_xyz(0.0, 4.0, 0.0),
        Velocity::default(),
    ));
    (lab, [hook, ball])
}

fn fault_of(lab: &Lab, element: Entity) -> SpringFault {
    lab.get::<SpringFault>(element).clone()
}

#[test]
fn a_hanging_load_holds_its_pose_from_the_first_step() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = SpringDamper::new(hook, body).with_stiffness(100.0);
    let element = lab.spawn((element, HoldPose::new()));
    let moved = strays(&mut lab, body);
    assert!(moved < 1e-4, "{moved}");
    let preload = lab.get::<Preload>(element).0;
    assert!((preload - 3.0 * GRAVITY as f32).abs() < 1e-3, "{preload}");
    assert!(lab.app.world().get::<HoldPose>(element).is_none());
    assert_eq!(lab.get::<SpringDamper>(element).rest_length, Some(1.0));
}

#[test]
fn a_spring_that_is_stretched_already_is_preloaded_by_what_is_missing() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = Spring::new(hook, body)
        .with_stiffness(100.0)
        .with_rest_length(0.8);
    let law = SpringLaw::polynomial(100.0, 0.0, 500.0);
    let element = lab.spawn((element, law, HoldPose::new()));
    let moved = strays(&mut lab, body);
    assert!(moved < 1e-4, "{moved}");
    let wanted = 3.0 * GRAVITY as f32 - (20.0 + 500.0 * 0.008);
    let preload = lab.get::<Preload>(element).0;
    assert!((preload - wanted).abs() < 1e-3, "{preload}");
}

#[test]
fn four_springs_share_a_tray_and_hold_it_level() {
    let mut lab = Lab::new();
    let tray = lab.body(8.0, Vec3::ZERO);
    for (x, z) in [(1.0, 0.5), (1.0, -0.5), (-1.0, 0.5), (-1.0, -0.5)] {
        // Slanted outward, so that each tension is more than its share of the weight.
        let hook = lab.point(Vec3::new(1.5 * x, 2.0, z));
        lab.spawn((
            SpringDamper::new(hook, tray)
                .with_stiffness(400.0)
                .with_damping(20.0),
            Anchors::new(Vec3::ZERO, Vec3::new(x, 0.0, z)),
            HoldPose::share(0.25),
        ));
    }
    let moved = strays(&mut lab, tray);
    assert!(moved < 1e-4, "{moved}");
}

/// A load of 300 kg, guided vertically, half a metre over a wheel of 20 kg on the ground. Returns `[load, wheel]`.
fn chassis_over_wheel(lab: &mut Lab) -> [Entity; 2] {
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    let guided = LockedAxes::ROTATION_LOCKED
        | LockedAxes::TRANSLATION_LOCKED_X
        | LockedAxes::TRANSLATION_LOCKED_Z;
    let load = lab.spawn((body(300.0, Vec3::Y * 0.8), guided));
    let wheel = lab.spawn((
        RigidBody::Dynamic,
        Transform::from_xyz(0.0, 0.3, 0.0),
        Collider::ball(0.3),
        ColliderMassProperties::Mass(20.0),
    ));
    [load, wheel]
}

#[test]
fn a_chassis_over_a_wheel_on_the_ground_stands_at_the_height_it_was_given() {
    let mut lab = Lab::new();
    let [load, wheel] = chassis_over_wheel(&mut lab);
    let pair = SpringDamper::new(load, wheel)
        .with_stiffness(40e3)
        .with_damping(3e3);
    let element = lab.spawn((pair, HoldPose::of_a()));
    let moved = strays(&mut lab, load);
    assert!(moved < 2e-3, "{moved}; without it, 74 mm");
    let preload = lab.get::<Preload>(element).0;
    assert!(
        (preload / (-300.0 * GRAVITY as f32) - 1.0).abs() < 1e-4,
        "{preload}"
    );
}

/// A brick on a post, with a hinge about Z at its end. With `is_link` the hinge is a multibody joint.
fn arm(lab: &mut Lab, post: Entity, mass: f32, inertia: Vec3, at: Vec3, is_link: bool) -> Entity {
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(-at);
    let arm = lab.spawn(brick(mass, inertia, at));
    let mut entity = lab.app.world_mut().entity_mut(arm);
    if is_link {
        entity.insert(MultibodyJoint::new(post, TypedJoint::from(hinge)));
    } else {
        entity.insert(ImpulseJoint::new(post, hinge));
    }
    arm
}

/// A level arm of 0.8 kg on a hinge, and an element from 5 cm along it up to a post. Returns the arm.
fn lamp(lab: &mut Lab, is_link: bool, companion: impl Bundle) -> Entity {
    let post = lab.spawn((RigidBody::Fixed, Transform::default()));
    let inertia = Vec3::new(1e-4, 0.02, 0.02);
    let arm = arm(lab, post, 0.8, inertia, Vec3::X * 0.275, is_link);
    lab.spawn((
        SpringDamper::new(post, arm)
            .with_stiffness(1200.0)
            .with_damping(100.0),
        Anchors::new(Vec3::new(0.05, 0.2, 0.0), Vec3::X * (0.05 - 0.275)),
        companion,
    ));
    arm
}

#[test]
fn the_arm_of_a_lamp_on_a_hinge_holds_its_pose() {
    for (is_link, sag) in [(false, false), (false, true), (true, false), (true, true)] {
        let mut lab = Lab::new();
        let arm = if sag {
            lamp(&mut lab, is_link, SpringTuning::sag(0.02, 0.3))
        } else {
            lamp(&mut lab, is_link, HoldPose::new())
        };
        let moved = strays(&mut lab, arm);
        assert!(moved < 2e-3, "multibody {is_link}, sag {sag}: {moved}");
    }
}

#[test]
fn a_torsion_bar_holds_its_arm() {
    for is_link in [false, true] {
        let mut lab = Lab::new();
        let post = lab.spawn((RigidBody::Fixed, Transform::default()));
        let arm = arm(
            &mut lab,
            post,
            2.0,
            Vec3::splat(0.05),
            Vec3::X * 0.5,
            is_link,
        );
        let bar = TorsionSpringDamper::new(post, arm, Vec3::Z)
            .with_stiffness(50.0)
            .with_damping(2.0);
        let element = lab.spawn((bar, HoldPose::new()));
        let moved = strays(&mut lab, arm);
        assert!(moved < 2e-3, "multibody {is_link}: {moved}");
        let preload = lab.get::<Preload>(element).0;
        let wanted = 2.0 * GRAVITY as f32 * 0.5;
        let off = (preload.abs() / wanted - 1.0).abs();
        assert!(off < 1e-3, "multibody {is_link}: {preload}");
    }
}

#[test]
fn a_pose_that_cannot_be_held_is_a_fault_that_says_why() {
    let faulty = |spawn: &dyn Fn(&mut Lab, Entity, Entity) -> Entity, level: bool| {
        let mut lab = Lab::new();
        let a = lab.body(1.0, Vec3::Y);
        let b = lab.body(
            1.0,
            if level {
                Vec3::new(1.0, 1.0, 0.0)
            } else {
                Vec3::ZERO
            },
        );
        let element = spawn(&mut lab, a, b);
        lab.run(0.1);
        fault_of(&lab, element)
    };
    let both = faulty(
        &|lab, a, b| lab.spawn((Spring::new(a, b), HoldPose::new())),
        false,
    );
    assert_eq!(both.field, "HoldPose");
    assert!(both.reason.contains("HoldPose::of_a()"), "{both}");
    let level = faulty(
        &|lab, a, b| lab.spawn((Spring::new(a, b), HoldPose::of_b())),
        true,
    );
    assert!(level.reason.contains("level"), "{level}");
    let rope = faulty(
        &|lab, a, b| lab.spawn((Spring::new(a, b), SpringAction::Pull, HoldPose::of_a())),
        false,
    );
    assert!(rope.reason.contains("SpringAction"), "{rope}");
    let weak = faulty(
        &|lab, a, b| lab.spawn((Spring::new(a, b), MaxForce(5.0), HoldPose::of_b())),
        false,
    );
    assert!(weak.reason.contains("MaxForce"), "{weak}");
    let damper = faulty(
        &|lab, a, b| lab.spawn((Damper::new(a, b), HoldPose::of_b())),
        false,
    );
    assert!(damper.reason.contains("damper"), "{damper}");
    let share = faulty(
        &|lab, a, b| lab.spawn((Spring::new(a, b), HoldPose::of_b().with_share(0.0))),
        false,
    );
    assert_eq!(share.field, "HoldPose::share");
    let still = faulty(
        &|lab, a, b| {
            lab.app.world_mut().entity_mut(a).insert(RigidBody::Fixed);
            lab.spawn((Spring::new(a, b), HoldPose::of_a()))
        },
        false,
    );
    assert!(still.reason.contains("cannot move"), "{still}");
}

#[test]
fn a_sag_without_a_rest_length_leaves_the_body_where_it_was_spawned() {
    for (height, rest) in [(4.0, 0.88), (6.0, 1.12)] {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::Y * 5.0);
        // The load hangs below the hook, or stands on top of it like a guided piston.
        let load = lab.spawn((
            body(3.0, Vec3::Y * height),
            LockedAxes::TRANSLATION_LOCKED_X | LockedAxes::TRANSLATION_LOCKED_Z,
        ));
        let element = lab.spawn((SpringDamper::new(hook, load), SpringTuning::sag(0.12, 0.3)));
        let moved = strays(&mut lab, load);
        assert!(moved < 1e-4, "{moved}");
        let pair = lab.get::<SpringDamper>(element);
        assert!(
            (pair.rest_length.unwrap_or(0.0) - rest).abs() < 1e-5,
            "{pair:?}"
        );
        assert!(
            (pair.stiffness - 3.0 * 9.81 / 0.12).abs() < 1e-2,
            "{pair:?}"
        );
    }
}

#[test]
fn a_sag_of_a_ball_that_can_touch_is_held_as_well() {
    let (mut lab, [hook, ball]) = hook_and_ball();
    let element = lab.spawn((SpringDamper::new(hook, ball), SpringTuning::sag(0.2, 0.3)));
    let moved = strays(&mut lab, ball);
    assert!(moved < 1e-4, "{moved}");
    let rest = lab.get::<SpringDamper>(element).rest_length;
    assert!((rest.unwrap_or(0.0) - 0.8).abs() < 1e-4, "{rest:?}");
    assert!(lab.app.world().get::<SpringTuning>(element).is_none());
}

#[test]
fn a_sag_of_a_chassis_over_a_wheel_is_found_once_the_wheel_stands() {
    let mut lab = Lab::new();
    let [load, wheel] = chassis_over_wheel(&mut lab);
    lab.spawn((SpringDamper::new(load, wheel), SpringTuning::sag(0.1, 0.3)));
    // The load falls for one step, which is 3 mm, and comes to rest where it began.
    let moved = strays(&mut lab, load);
    assert!(moved < 0.02, "{moved}");
    let off = lab.position(load).y - 0.8;
    assert!(off.abs() < 5e-3, "{off}");
}

#[test]
fn a_pose_is_found_anew_after_a_reset() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = SpringDamper::new(hook, body).with_stiffness(100.0);
    let element = lab.spawn((element, HoldPose::new()));
    lab.run(0.5);
    lab.get_mut::<Transform>(body).translation.y = 3.5;
    lab.app
        .world_mut()
        .entity_mut(element)
        .insert(HoldPose::new());
    let moved = strays(&mut lab, body);
    assert!(moved < 1e-3, "{moved}");
    // The spring is longer by half a metre and bears 50 N of the weight.
    let preload = lab.get::<Preload>(element).0;
    assert!(
        (preload - (3.0 * GRAVITY as f32 - 50.0)).abs() < 0.01,
        "{preload}"
    );
    // A new rest length is captured as the first one was.
    lab.get_mut::<Transform>(body).translation.y = 4.0;
    lab.get_mut::<SpringDamper>(element).rest_length = None;
    lab.app
        .world_mut()
        .entity_mut(element)
        .insert(HoldPose::new());
    let moved = strays(&mut lab, body);
    assert!(moved < 1e-3, "{moved}");
    let pair = lab.get::<SpringDamper>(element);
    assert_eq!(pair.rest_length, Some(1.0));
}

#[test]
fn a_sag_longer_than_the_element_is_a_fault() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.9);
    let element = lab.spawn((SpringDamper::new(hook, body), SpringTuning::sag(0.2, 0.3)));
    lab.run(0.1);
    let fault = fault_of(&lab, element);
    assert_eq!(fault.field, "SpringTuning");
    assert!(fault.reason.contains("longer"), "{fault}");
}

#[test]
fn the_spring_force_holds_preload_and_stops_and_a_slack_rope_has_none() {
    let mut lab = Lab::weightless();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::X));
    let spring = |rest| {
        Spring::new(a, b)
            .with_stiffness(100.0)
            .with_rest_length(rest)
    };
    let preloaded = lab.spawn((spring(0.9), Preload(5.0)));
    let stopped = lab.spawn((
        spring(1.0),
        Preload(5.0),
        SpringTravel::new(1.1, 2.0, 1000.0),
    ));
    // A preload of 5 N equals 5 cm of stretch: the rope goes slack 5 cm below its rest length.
    let taut = lab.spawn((spring(1.04), Preload(5.0), SpringAction::Pull));
    let slack = lab.spawn((spring(1.06), Preload(5.0), SpringAction::Pull));
    lab.run(0.1);
    let force = |e: Entity| lab.readout(e).spring_force;
    assert!((force(preloaded) - 15.0).abs() < 1e-3);
    assert!((force(stopped) - (5.0 - 100.0)).abs() < 1e-2);
    assert!((force(taut) - 1.0).abs() < 1e-3);
    assert_eq!(force(slack), 0.0);
}

#[test]
fn a_pose_that_could_not_be_held_is_found_once_that_is_mended() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::Y);
    let body = lab.body(1.0, Vec3::ZERO);
    let pose = HoldPose::new().with_share(-1.0);
    let element = lab.spawn((Spring::new(hook, body), pose));
    lab.run(0.1);
    assert_eq!(fault_of(&lab, element).field, "HoldPose::share");
    lab.get_mut::<HoldPose>(element).share = 1.0;
    lab.run(0.1);
    let world = lab.app.world();
    assert!(world.get::<SpringFault>(element).is_none());
    assert!(world.get::<HoldPose>(element).is_none());
    assert_eq!(lab.get::<Preload>(element).0, 0.0);
}
