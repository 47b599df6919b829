//! Invalid laws and companions: each is reported once, and its element is inert.

use crate::harness::*;
use crate::messages::Log;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Runs an element with a companion, and a valid neighbour. Returns the element's fault and its number of log messages.
fn spoilt(companion: impl Bundle) -> (Option<SpringFault>, usize) {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    let other = lab.body(1.0, Vec3::Y * 1.3);
    let pair = |body| {
        SpringDamper::new(hook, body)
            .with_stiffness(40.0)
            .with_damping(1.0)
            .with_rest_length(1.0)
    };
    let element = lab.spawn((pair(body), companion));
    lab.spawn(pair(other));
    let log = Log::capture();
    lab.run(0.5);
    let naming = format!("{element}: ");
    let said = log.take().iter().filter(|m| m.starts_with(&naming)).count();
    assert!(lab.velocity(other).length() > 0.01, "the neighbour swings");
    assert!(lab.position(body).is_finite() && lab.velocity(body).is_finite());
    let fault = lab.app.world().get::<SpringFault>(element).cloned();
    if fault.is_some() {
        assert!(lab.velocity(body).length() < 1e-6, "it is inert");
    }
    (fault, said)
}

fn check(companion: impl Bundle, field: &str, reason: &str) {
    let (fault, said) = spoilt(companion);
    let fault = fault.unwrap_or_else(|| panic!("{field}: nothing was said"));
    assert_eq!(fault.field, field, "{fault}");
    assert!(fault.reason.contains(reason), "{fault}");
    assert_eq!(said, 1, "{field}");
}

#[test]
fn tables_that_are_none() {
    let table = |points: &[(f32, f32)]| SpringLaw::table(points.iter().copied());
    check(table(&[]), "SpringLaw::Table", "fewer than two");
    check(table(&[(0.0, 1.0)]), "SpringLaw::Table", "fewer than two");
    check(
        table(&[(0.0, 0.0), (1.0, f32::NAN)]),
        "SpringLaw::Table",
        "not finite",
    );
    check(
        table(&[(0.0, 0.0), (0.0, 1.0)]),
        "SpringLaw::Table",
        "rise strictly",
    );
    check(
        table(&[(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)]),
        "SpringLaw::Table",
        "falls",
    );
    check(
        DampingLaw::table([(-1.0, -1.0), (1.0, 2.0)]),
        "DampingLaw::Table",
        "at rest",
    );
}

/// Asserts the fault of an element with a companion that has nothing to act on.
fn out_of_place<B: Bundle>(element: impl FnOnce(Entity, Entity) -> B, field: &str, reason: &str) {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y);
    let weight = lab.body(1.0, Vec3::ZERO);
    let element = lab.spawn(element(hook, weight));
    lab.run(0.5);
    let fault = lab.get::<SpringFault>(element).clone();
    assert_eq!(fault.field, field, "{fault}");
    assert!(fault.reason.contains(reason), "{fault}");
    let fallen = 0.5 * GRAVITY * 0.25 + f64::from(lab.position(weight).y);
    assert!(fallen.abs() < 0.05, "it is inert");
}

#[test]
fn companions_of_an_element_that_has_nothing_for_them() {
    const NO_SPRING: &str = "stands on a damper without a spring";
    let damper = |a, b| Damper::new(a, b).with_damping(5.0);
    let table = || SpringLaw::table([(-1.0, -50.0), (1.0, 50.0)]);
    out_of_place(|a, b| (damper(a, b), table()), "SpringLaw", NO_SPRING);
    let linear = SpringLaw::Linear;
    out_of_place(|a, b| (damper(a, b), linear), "SpringLaw", NO_SPRING);
    let tuning = SpringTuning::frequency(1.0, 0.5);
    out_of_place(|a, b| (damper(a, b), tuning), "SpringTuning", NO_SPRING);
    let twist = |a, b| TorsionDamper::new(a, b, Vec3::X).with_damping(5.0);
    let own = || CustomSpringLaw::new(|x| 10.0 * x);
    out_of_place(|a, b| (twist(a, b), own()), "CustomSpringLaw", NO_SPRING);
    const NO_DAMPER: &str = "stands on a spring without a damper";
    let spring = |a, b| Spring::new(a, b).with_stiffness(50.0);
    let sided = DampingLaw::sided(5.0, 5.0);
    out_of_place(|a, b| (spring(a, b), sided), "DampingLaw", NO_DAMPER);
    let linear = DampingLaw::Linear;
    out_of_place(|a, b| (spring(a, b), linear), "DampingLaw", NO_DAMPER);
    let own = CustomDampingLaw::new(|v| 5.0 * v);
    out_of_place(|a, b| (spring(a, b), own), "CustomDampingLaw", NO_DAMPER);
}

#[test]
fn a_tuned_spring_without_a_damper_turns_nothing_into_heat() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y * 2.0);
    let weight = lab.body(1.0, Vec3::ZERO);
    let spring = Spring::new(hook, weight).with_rest_length(1.0);
    let element = lab.spawn((spring, SpringTuning::frequency(1.0, 0.5)));
    lab.run(1.0);
    assert_eq!(lab.readout(element).dissipated_energy, 0.0);
}

#[test]
fn numbers_out_of_range() {
    check(
        SpringLaw::polynomial(1.0, -2.0, 0.0),
        "Polynomial::quadratic",
        "negative",
    );
    check(
        DampingLaw::sided(1.0, f32::INFINITY),
        "DampingLaw::Sided::rebound",
        "infinite",
    );
    check(
        SpringTravel::new(0.5, 0.4, 100.0),
        "SpringTravel::max_length",
        "above min_length",
    );
    check(
        SpringTravel::new(-0.5, 2.0, 100.0),
        "SpringTravel::min_length",
        "negative",
    );
    check(
        SpringTravel::new(0.5, 2.0, -1.0),
        "SpringTravel::stop_stiffness",
        "negative",
    );
    check(MaxForce(0.0), "MaxForce", "above zero");
    check(MaxForce(f32::NAN), "MaxForce", "above zero");
    check(Preload(f32::NAN), "Preload", "NaN");
    check(SpringAxis::World(Vec3::ZERO), "SpringAxis::World", "zero");
    check(SpringAxis::BodyA(Vec3::X), "SpringDamper::body_a", "frame");
    check(Breakable::at_force(f32::NAN), "Breakable::force", "NaN");
    check(Breakable::at_length(f32::NAN), "Breakable::length", "NaN");
    check(Breakable::at_force(-1.0), "Breakable::force", "negative");
    let below = Breakable::at_length(f32::NEG_INFINITY);
    check(below, "Breakable::length", "negative");
    check(
        SpringTuning::frequency(-1.0, 0.1),
        "SpringTuning",
        "negative",
    );
}

#[test]
fn a_function_of_ones_own_that_gives_nan() {
    check(CustomSpringLaw::new(|_| f64::NAN), "ForceLaw", "NaN");
    check(
        CustomDampingLaw::new(|v| 5.0 + v),
        "CustomDampingLaw",
        "at rest",
    );
    // The law is finite at the start and NaN where the body goes. The state stays finite, and the fault is reported there.
    let (fault, said) = spoilt(CustomSpringLaw::new(|x: f64| {
        if x < 0.2 { f64::NAN } else { 100.0 * x }
    }));
    assert_eq!(said, 1, "{fault:?}");
}

#[test]
fn a_function_that_gives_nan_where_a_network_takes_it_is_told_and_lets_go() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let [near, far] = [1.0, 2.0].map(|x| lab.body(1.0, Vec3::X * x));
    lab.get_mut::<Velocity>(far).linear = Vec3::X * 3.0;
    let spring = |a, b| {
        Spring::new(a, b)
            .with_stiffness(100.0)
            .with_rest_length(1.0)
    };
    let good = lab.spawn(spring(hook, near));
    let law = CustomSpringLaw::new(|x: f64| if x > 0.2 { f64::NAN } else { 10.0 * x });
    let bad = lab.spawn((spring(near, far), law));
    lab.run(0.5);
    let fault = lab.get::<SpringFault>(bad);
    assert_eq!(fault.field, "ForceLaw", "{fault}");
    assert!(lab.app.world().get::<SpringFault>(good).is_none());
    // Up to a stretch of 0.2 m, in 0.067 s, the spring takes 0.067 m/s from the far body and gives them to the near one. Then the
    // far one flies on at 2.93 m/s.
    let gone = lab.position(far).x - 2.0;
    assert!((1.4..1.5).contains(&gone), "{gone} m");
    // The near one swings on with 2.2 mJ.
    let stored = lab.readout(good).stored_energy;
    let energy = stored + 0.5 * lab.velocity(near).length_squared();
    assert!((1e-3..4e-3).contains(&energy), "{energy} J");
}

#[test]
fn a_function_that_gives_nan_between_two_points_is_told_until_it_gives_numbers() {
    let mut lab = Lab::weightless();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::X));
    let law = CustomSpringLaw::new(|x: f64| if x > 0.2 { f64::NAN } else { 10.0 * x });
    let element = lab.spawn((Spring::new(a, b).with_rest_length(1.0), law));
    for (x, is_told) in [(1.0, false), (2.0, true), (1.1, false)] {
        lab.get_mut::<Transform>(b).translation.x = x;
        lab.run(0.1);
        let fault = lab.app.world().get::<SpringFault>(element);
        assert_eq!(fault.is_some(), is_told, "at {x} m: {fault:?}");
        assert!(fault.is_none_or(|fault| fault.field == "ForceLaw"));
    }
    let force = lab.readout(element).spring_force;
    assert!((force - 1.0).abs() < 1e-4, "{force} N");
}

#[test]
fn two_laws_at_once() {
    check(
        (SpringLaw::Cubic, CustomSpringLaw::new(|x: f64| x)),
        "SpringLaw",
        "together",
    );
}

#[test]
fn a_law_that_is_mended_or_taken_away_acts_again() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.3);
    let spring = Spring::new(hook, body)
        .with_stiffness(40.0)
        .with_rest_length(1.0);
    let element = lab.spawn((spring, SpringLaw::table([])));
    lab.run(0.2);
    assert!(lab.velocity(body).length() < 1e-6);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<SpringLaw>();
    lab.run(0.2);
    assert!(lab.velocity(body).length() > 0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
}

#[test]
fn a_rest_length_that_is_taken_beside_a_fault_is_the_one_in_the_component() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.moving(body(1.0, Vec3::X * 1.3), Velocity::linear(Vec3::X * 9.0));
    // Without a value at the speed of the first steps.
    let law = CustomDampingLaw::new(|v: f64| if v.abs() > 5.0 { f64::NAN } else { v });
    let element = lab.spawn((SpringDamper::new(hook, body).with_stiffness(40.0), law));
    lab.tick();
    assert!(lab.app.world().get::<SpringFault>(element).is_some());
    assert_eq!(lab.get::<SpringDamper>(element).rest_length, Some(1.3));
    lab.get_mut::<Velocity>(body).linear = Vec3::ZERO;
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    // Another element makes the crate read all of them anew.
    let other = lab.body(1.0, Vec3::Y);
    lab.spawn(Spring::new(hook, other));
    lab.run(0.05);
    let (now, readout) = (lab.position(body).x, lab.readout(element));
    assert!(
        (readout.spring_force - 40.0 * (now - 1.3)).abs() < 1e-3,
        "{readout:?}"
    );
    assert!(lab.velocity(body).x < -0.1, "it pulls");
}
