//! Does a snapshot whose numbers someone has changed neither panic, nor hang, nor bring NaN into the engine?
//!
//! `cargo test --features serialize --test forged`

// Of what the tests of physics share, this one needs a part.
#![allow(dead_code)]

#[path = "../physics/compat.rs"]
mod compat;
#[path = "../physics/dice.rs"]
mod dice;
#[path = "../physics/snapshot/film.rs"]
mod film;
#[path = "../physics/harness.rs"]
mod harness;
#[path = "../physics/snapshot/held.rs"]
mod held;
#[path = "../physics/snapshot/scenes.rs"]
mod scenes;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use dice::some;
use film::*;
use scenes::*;
use std::collections::BTreeSet;
use std::ops::Range;

/// What takes the place of a number with a point, and of one without.
const FLOATS: [&str; 10] = [
    "NaN", "inf", "-inf", "1e300", "-1e300", "3e38", "1e30", "-1.0", "0.0", "1e9",
];
const INTEGERS: [&str; 8] = [
    "0",
    "1",
    "200",
    "255",
    "65535",
    "4294967294",
    "4294967295",
    "18446744073709551615",
];

/// A number in a text.
struct Number<'a> {
    at: Range<usize>,
    /// Name of its field.
    field: &'a str,
    is_float: bool,
}

fn numbers(text: &str) -> Vec<Number<'_>> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || "_-+.".contains(c);
    let (mut found, mut field, mut at) = (Vec::new(), "", 0);
    while let Some(start) = text[at..].find(is_part).map(|start| at + start) {
        let rest = &text[start..];
        at = start + rest.find(|c: char| !is_part(c)).unwrap_or(rest.len());
        let word = &text[start..at];
        if text[at..].starts_with(':') {
            field = word;
        } else if word.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
            found.push(Number {
                at: start..at,
                field,
                is_float: word.contains(['.', 'e', 'i']),
            });
        }
    }
    found
}

/// The text with other numbers in all fields of a name.
fn forged(text: &str, (field, is_float): (&str, bool), by: &str) -> String {
    let (mut out, mut at) = (String::new(), 0);
    let numbers = numbers(text).into_iter();
    for number in numbers.filter(|n| n.field == field && n.is_float == is_float) {
        out += &text[at..number.at.start];
        out += by;
        at = number.at.end;
    }
    out + &text[at..]
}

fn moves_soundly(film: &mut Film) -> bool {
    let world = film.lab.app.world_mut();
    let mut forces = world.query::<&ExternalForce>();
    let is_finite = |f: &ExternalForce| f.force.is_finite() && f.torque.is_finite();
    let mut readouts = world.query::<&SpringReadout>();
    let is_sound = |seen: &SpringReadout| seen.force().is_finite() && seen.work.is_finite();
    if !forces.iter(world).all(is_finite) || !readouts.iter(world).all(is_sound) {
        return false;
    }
    let mut velocities = film.lab.app.world_mut().query::<&Velocity>();
    let mut velocities = velocities.iter(film.lab.app.world());
    film.is_sound() && velocities.all(|v| v.linear.is_finite() && v.angular.is_finite())
}

#[test]
fn forged_numbers_neither_panic_nor_hang_nor_reach_the_engine_as_nan() {
    for name in [
        "car, plain",
        "torsion, tolerance",
        "lattice, tolerance",
        "ropes, plain",
        "hinges, extrapolation",
        "moved ends, plain",
    ] {
        let mut film = after(name, 60);
        let then = Both::take(&film);
        let text = ron::to_string(&then.springs).expect("it has a text");
        let fields = numbers(&text).into_iter().map(|n| (n.field, n.is_float));
        let fields: BTreeSet<_> = fields.collect();
        let mut fitted = 0;
        for field in some(fields) {
            for by in if field.1 { &FLOATS[..] } else { &INTEGERS[..] } {
                // A failing test shows the last of these.
                println!("{name}: {} = {by}", field.0);
                let Ok(springs) = ron::from_str::<CoiloverSnapshot>(&forged(&text, field, by))
                else {
                    continue;
                };
                let world = film.lab.app.world_mut();
                then.engine.restore(world).expect("Rapier's side fits");
                fitted += usize::from(springs.restore(world).is_ok());
                film.run(6);
                assert!(moves_soundly(&mut film));
            }
        }
        assert!(fitted > 20, "{name}: only {fitted} fitted");
        then.restore(&mut film);
    }
}

#[test]
fn one_that_says_that_the_engine_stays_does_not_touch_what_its_handles_name() {
    let mut film = after("car, plain", 60);
    let then = Both::take(&film);
    let text = ron::to_string(&then.springs).expect("it has a text");
    assert!(text.contains("engine_stays:false"), "{text}");
    // Its handles are then those of the game's bodies and joints.
    let text = text.replace("engine_stays:false", "engine_stays:true");
    let text = forged(
        &forged(&text, ("index", false), "0"),
        ("generation", false),
        "0",
    );
    let springs: CoiloverSnapshot = ron::from_str(&text).expect("it is a snapshot");
    let bodies = |film: &mut Film| {
        let world = film.lab.app.world_mut();
        let mut sets = world.query::<&RapierRigidBodySet>();
        let set = sets.single(world).expect("one context");
        let games = set.bodies.iter().filter(|(_, body)| body.user_data != 0);
        games.count()
    };
    let before = bodies(&mut film);
    assert_eq!(springs.restore(film.lab.app.world_mut()), Ok(()));
    film.run(30);
    assert_eq!(bodies(&mut film), before);
    assert!(moves_soundly(&mut film));
}
