//! Tuning by natural frequency, by sag and by the dimensions of a coil.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

#[test]
fn a_frequency_becomes_stiffness_and_damping_once_and_stays() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let body = lab.body(3.0, Vec3::Y * 4.0);
    let element = lab.spawn((
        SpringDamper::new(hook, body).with_rest_length(1.0),
        SpringTuning::frequency(2.0, 0.25),
    ));
    lab.tick();
    let pair = *lab.get::<SpringDamper>(element);
    let omega = TAU * 2.0;
    assert!(
        (pair.stiffness - 3.0 * omega * omega).abs() < 1e-2,
        "{pair:?}"
    );
    assert!(
        (pair.damping - 2.0 * 0.25 * 3.0 * omega).abs() < 1e-3,
        "{pair:?}"
    );
    assert!(lab.app.world().get::<SpringTuning>(element).is_none());
    // The readout shows the tuning from the first step on.
    assert!((lab.readout(element).omega_dt - omega * DT).abs() < 1e-4);
    // A later change of mass does not change the tuned stiffness.
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert(AdditionalMassProperties::Mass(30.0));
    lab.run(1.0);
    assert_eq!(*lab.get::<SpringDamper>(element), pair);
}

/// Length of a spring of 1 m after the given time (s), tuned to sag by 12 cm under a load of 3 kg.
fn sagged(load: impl Bundle, seconds: f64) -> f32 {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let load = lab.spawn((body(3.0, Vec3::Y * 4.0), load));
    let element = lab.spawn((
        SpringDamper::new(hook, load).with_rest_length(1.0),
        SpringTuning::sag(0.12, 1.0),
    ));
    lab.run(seconds);
    lab.readout(element).length
}

#[test]
fn a_sag_is_the_sag() {
    let length = sagged((), 4.0);
    assert!((length - 1.12).abs() < 1e-4, "{length}");
}

#[test]
fn two_free_bodies_are_tuned_by_their_effective_mass() {
    let mut lab = Lab::weightless();
    let a = lab.body(2.0, Vec3::ZERO);
    let b = lab.body(6.0, Vec3::X);
    let element = lab.spawn((Spring::new(a, b), SpringTuning::frequency(1.0, 0.0)));
    lab.tick();
    let stiffness = lab.get::<Spring>(element).stiffness;
    assert!((stiffness - 1.5 * TAU * TAU).abs() < 1e-3, "{stiffness}");
}

#[test]
fn wire_and_coil_give_the_stiffness_of_the_handbook() {
    // 12 mm wire, 100 mm coil, 6 turns of steel.
    let stiffness = bevy_coilover::wire_stiffness(0.012, 0.1, 6.0, 79.3e9);
    assert!((stiffness - 34_257.6).abs() < 1.0, "{stiffness}");
}

/// The level arm of a lamp on a hinge, 0.4 m and 0.3 kg with 0.5 kg at its end. Its element goes
/// from 5 cm along the arm up to a post.
fn lamp(element: impl FnOnce(Entity, Entity) -> SpringDamper) -> (Lab, Entity, Entity) {
    let mut lab = Lab::new();
    let post = lab.spawn((RigidBody::Fixed, Transform::default()));
    let (mass, middle) = (0.8, (0.3 * 0.2 + 0.5 * 0.4) / 0.8);
    let about_the_hinge = 0.3 * 0.4 * 0.4 / 3.0 + 0.5 * 0.4 * 0.4;
    let own = about_the_hinge - mass * middle * middle;
    let arm = lab.spawn((
        brick(mass, Vec3::new(1e-4, own, own), Vec3::X * middle),
        ImpulseJoint::new(
            post,
            RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * middle),
        ),
    ));
    let element = element(post, arm);
    let anchors = Anchors::new(Vec3::new(0.05, 0.2, 0.0), Vec3::X * (0.05 - middle));
    let element = lab.spawn((element, anchors));
    (lab, arm, element)
}

/// Effective mass of the arm at the spring, from its inertia about the hinge, kg.
const LAMP: f32 = (0.3 * 0.4 * 0.4 / 3.0 + 0.5 * 0.4 * 0.4) / (0.05 * 0.05);

#[test]
fn on_a_hinge_the_effective_mass_is_what_the_hinge_leaves() {
    let (mut lab, _, element) = lamp(|post, arm| {
        SpringDamper::new(post, arm)
            .with_stiffness(1200.0)
            .with_rest_length(0.2)
    });
    lab.tick();
    let readout = lab.readout(element);
    assert!(
        (readout.effective_mass / LAMP - 1.0).abs() < 1e-3,
        "{readout:?}"
    );
    let omega_dt = (1200.0 / LAMP).sqrt() * DT;
    assert!(
        (readout.omega_dt / omega_dt - 1.0).abs() < 1e-3,
        "{readout:?}"
    );
}

#[test]
fn a_lamp_tuned_to_two_hertz_swings_twice_a_second() {
    let (mut lab, arm, element) =
        lamp(|post, arm| SpringDamper::new(post, arm).with_rest_length(0.195));
    let world = lab.app.world_mut();
    world
        .entity_mut(element)
        .insert(SpringTuning::frequency(2.0, 0.0));
    lab.tick();
    let k = lab.get::<SpringDamper>(element).stiffness;
    assert!(
        (k / (LAMP * (2.0 * TAU) * (2.0 * TAU)) - 1.0).abs() < 1e-3,
        "{k}"
    );
    assert!(lab.app.world().get::<SpringTuning>(element).is_none());
    // Counts the upward crossings of the mean height.
    let mut heights = Vec::new();
    for _ in 0..lab.ticks(4.0) {
        lab.tick();
        heights.push(lab.position(arm).y);
    }
    let mean = heights.iter().sum::<f32>() / heights.len() as f32;
    let up = heights.windows(2).filter(|h| h[0] < mean && h[1] >= mean);
    let times = up.count();
    assert!((7..=9).contains(&times), "{times} in four seconds");
}

#[test]
fn a_lamp_tuned_to_a_sag_sags_that_much() {
    let (mut lab, _, element) =
        lamp(|post, arm| SpringDamper::new(post, arm).with_rest_length(0.2));
    let sag = 0.002;
    let world = lab.app.world_mut();
    world
        .entity_mut(element)
        .insert(SpringTuning::sag(sag, 1.0));
    lab.tick();
    // The moment of the weights about the hinge, over the lever of the spring.
    let tension = 9.81 * (0.3 * 0.2 + 0.5 * 0.4) / 0.05;
    let k = lab.get::<SpringDamper>(element).stiffness;
    assert!((k * sag / tension - 1.0).abs() < 1e-3, "{k} N/m");
    lab.run(3.0);
    let sags = lab.readout(element).length - 0.2;
    assert!((sags / sag - 1.0).abs() < 0.03, "{sags} m");
}

#[test]
fn a_torsion_bar_tuned_to_a_sag_holds_its_arm_with_the_moment_of_its_weight() {
    let mut lab = Lab::new();
    let post = lab.spawn((RigidBody::Fixed, Transform::default()));
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor2(Vec3::NEG_X * 0.5);
    let arm = lab.spawn((
        brick(2.0, Vec3::splat(0.05), Vec3::X * 0.5),
        ImpulseJoint::new(post, hinge),
    ));
    let bar = TorsionSpringDamper::new(post, arm, Vec3::Z);
    let element = lab.spawn((bar, SpringTuning::sag(0.1, 0.3)));
    lab.run(2.0);
    let bar = lab.get::<TorsionSpringDamper>(element);
    let moment = 2.0 * 9.81 * 0.5;
    assert!((bar.stiffness * 0.1 / moment - 1.0).abs() < 1e-3, "{bar:?}");
    let rest = bar.rest_angle.expect("it was found");
    assert!((rest - 0.1).abs() < 1e-4, "{rest} rad");
    assert!(lab.position(arm).distance(Vec3::X * 0.5) < 2e-3);
}

#[test]
fn a_sag_where_no_weight_loads_the_element_is_a_fault() {
    let on_a_rail = |lab: &mut Lab| {
        let rail = lab.spawn((RigidBody::Fixed, Transform::default()));
        let joint = ImpulseJoint::new(rail, PrismaticJointBuilder::new(Vec3::X));
        let cart = lab.spawn((body(1.0, Vec3::X), joint));
        let tuning = SpringTuning::sag(0.1, 0.3);
        lab.spawn((SpringDamper::new(rail, cart), tuning))
    };
    let between_two = |lab: &mut Lab| {
        let [a, b] = [Vec3::ZERO, Vec3::X].map(|at| lab.body(1.0, at));
        let tuning = SpringTuning::sag(0.1, 0.3);
        lab.spawn((TorsionSpring::new(a, b, Vec3::X), tuning))
    };
    let cases: [&dyn Fn(&mut Lab) -> Entity; 2] = [&on_a_rail, &between_two];
    for spawn in cases {
        let mut lab = Lab::new();
        let element = spawn(&mut lab);
        lab.run(0.1);
        let fault = lab.get::<SpringFault>(element);
        assert_eq!(fault.field, "SpringTuning", "{fault}");
        assert!(fault.reason.contains("no weight"), "{fault}");
    }
}

/// The fault of a spring tuned to a sag between a hook and a load of 3 kg, whose weight is 29.4 N, `above` the hook by 1 m or
/// below it. The force is limited to `most`.
fn limited(above: bool, action: SpringAction, most: f32) -> Option<SpringFault> {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 5.0);
    let load = lab.body(3.0, Vec3::Y * if above { 6.0 } else { 4.0 });
    let pair = SpringDamper::new(hook, load);
    let element = lab.spawn((pair, SpringTuning::sag(0.1, 0.3), action, MaxForce(most)));
    lab.run(0.1);
    lab.app.world().get::<SpringFault>(element).cloned()
}

#[test]
fn a_sag_that_the_spring_is_not_allowed_to_carry_is_a_fault() {
    use SpringAction::{Both, Pull, Push};
    for (above, action, most) in [(false, Push, 1e3), (true, Pull, 1e3), (false, Both, 20.0)] {
        let fault = limited(above, action, most).expect("a fault");
        assert_eq!(fault.field, "SpringTuning");
        assert!(fault.reason.contains("does not allow"), "{fault}");
    }
    for (above, action, most) in [(false, Pull, 1e3), (true, Push, 1e3), (false, Both, 40.0)] {
        assert_eq!(limited(above, action, most), None, "{action:?}");
    }
}

#[test]
fn over_a_wheel_on_the_ground_it_is_the_load_that_swings() {
    for others in 0..3 {
        over_a_wheel(others);
    }
}

/// `others` springs spawn one by one after the tuned one, while the engine rests.
fn over_a_wheel(others: usize) {
    let mut lab = Lab::new();
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    let load = lab.spawn((
        body(300.0, Vec3::Y * 0.8),
        LockedAxes::ROTATION_LOCKED
            | LockedAxes::TRANSLATION_LOCKED_X
            | LockedAxes::TRANSLATION_LOCKED_Z,
    ));
    let wheel = lab.spawn((
        RigidBody::Dynamic,
        Transform::from_xyz(0.0, 0.3, 0.0),
        Collider::ball(0.3),
        ColliderMassProperties::Mass(20.0),
    ));
    let element = lab.spawn((
        SpringDamper::new(load, wheel).with_rest_length(0.5),
        SpringTuning::frequency(1.5, 0.3),
    ));
    lab.set_stepping(false);
    for at in (0..others).map(|other| 5.0 * (other + 1) as f32) {
        lab.tick();
        let (hook, other) = (lab.point(Vec3::X * at), lab.body(1.0, Vec3::X * (at + 1.0)));
        lab.spawn(Spring::new(hook, other).with_stiffness(1.0));
    }
    lab.tick();
    lab.set_stepping(true);
    lab.run(0.1);
    let k = lab.get::<SpringDamper>(element).stiffness;
    let wanted = 300.0 * (1.5 * TAU) * (1.5 * TAU);
    assert!((k / wanted - 1.0).abs() < 0.01, "{k} against {wanted}");
    assert!((lab.readout(element).effective_mass / 300.0 - 1.0).abs() < 0.01);
    assert!(lab.app.world().get::<SpringTuning>(element).is_none());
}

#[test]
fn a_sag_is_the_sag_under_another_gravity_scale_and_a_fault_without_gravity() {
    for scale in [0.3, 2.0] {
        let length = sagged(GravityScale(scale), 6.0);
        assert!((length - 1.12).abs() < 1e-4, "{scale}: {length}");
    }
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::Y);
    let load = lab.body(3.0, Vec3::ZERO);
    let element = lab.spawn((SpringDamper::new(hook, load), SpringTuning::sag(0.12, 1.0)));
    lab.run(0.1);
    let fault = lab.get::<SpringFault>(element);
    assert_eq!(fault.field, "SpringTuning");
    assert!(fault.reason.contains("no gravity"), "{fault}");
}

#[test]
fn a_spring_that_is_tuned_while_it_is_stretched_does_the_work_of_the_change() {
    let mut lab = Lab::weightless();
    let (hook, load) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::X * 1.1));
    let spring = SpringDamper::new(hook, load).with_stiffness(100.0);
    let spring = lab.spawn(spring.with_rest_length(1.0));
    lab.run(0.5);
    let before = lab.readout(spring);
    lab.app
        .world_mut()
        .entity_mut(spring)
        .insert(SpringTuning::frequency(20.0 / TAU, 0.0));
    let sum = |read: &SpringReadout, lab: &Lab| {
        let speed = lab.velocity(load).x;
        read.stored_energy + read.dissipated_energy - read.work + 0.5 * speed * speed
    };
    let first = sum(&before, &lab);
    lab.run(0.5);
    let after = lab.readout(spring);
    println!("{before:?} {after:?}");
    assert!((lab.get::<SpringDamper>(spring).stiffness - 400.0).abs() < 0.1);
    assert!(
        (sum(&after, &lab) - first).abs() < 0.01,
        "{first} {}",
        sum(&after, &lab)
    );
}
