//! Tests of visible figures (frequency, damping ratio, sag) that a user types and undoes.

use super::person::Person;
use bevy::prelude::*;

#[test]
fn a_frequency_is_typed_and_the_stiffness_follows() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.enter("1.00658 Hz", "2,5");
    let expected = 2.0 * (std::f32::consts::TAU * 2.5).powi(2);
    let stiffness = person.lamp().stiffness;
    assert!((stiffness / expected - 1.0).abs() < 1e-4, "{stiffness} N/m");
    // The input is one edit, not one for each letter.
    person.click("Undo");
    person.run(2);
    assert_eq!(person.lamp().stiffness, 80.0);
}

#[test]
fn a_damping_ratio_is_typed_and_the_damping_follows() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    // 1.5/(2 √(80 · 2)).
    person.enter("0.0592927", "1");
    let lamp = person.lamp();
    let critical = 2.0 * (80.0_f32 * 2.0).sqrt();
    assert!((lamp.damping / critical - 1.0).abs() < 1e-4, "{lamp:?}");
    assert_eq!((lamp.stiffness, lamp.rest_length), (80.0, Some(1.0)));
    person.click("Undo");
    person.run(2);
    assert_eq!(person.lamp().damping, 1.5);
}

#[test]
fn a_sag_is_typed_and_the_load_stays_where_it_rests() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let body = person.lamp().body_b;
    let height = |person: &mut Person| {
        person.run(1_800);
        let frame = person.app.world().get::<Transform>(body);
        frame.expect("a body").translation.y
    };
    let before = height(&mut person);
    // 2 · 9.81/80.
    person.enter("0.24525 m", "0.1");
    let lamp = person.lamp();
    assert!((lamp.stiffness - 196.2).abs() < 0.01, "{lamp:?}");
    let rest = lamp.rest_length.expect("a rest length");
    assert!((rest - 1.14525).abs() < 1e-4, "{rest} m");
    // The lamp does not start to swing.
    person.run(20);
    let frame = person.app.world().get::<Transform>(body);
    let at_once = frame.expect("a body").translation.y;
    assert!(
        (at_once - before).abs() < 1e-3,
        "{at_once} after {before} m"
    );
    let after = height(&mut person);
    assert!((after - before).abs() < 1e-3, "{after} after {before} m");
    // Stiffness and rest length are changed by one edit.
    person.click("Undo");
    person.run(2);
    let lamp = person.lamp();
    assert_eq!((lamp.stiffness, lamp.rest_length), (80.0, Some(1.0)));
}
