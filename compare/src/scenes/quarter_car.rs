//! Scene: a chassis on a spring above a wheel that stands on the ground.

use super::oscillator::free;
use super::{GRAVITY, Scene};
use crate::problem::{Body, Kind, Link, Problem, Truth};
use bevy::math::{DVec3, Vec3};

const CHASSIS: f32 = 250.0;
const WHEEL: f32 = 20.0;
const RADIUS: f32 = 0.3;
const REST: f32 = 0.5;
const STIFFNESS: f32 = 30e3;
const DAMPING: f32 = 2e3;

pub const SCENE: Scene = Scene {
    name: "quarter-car",
    title: "Quarter car on the ground",
    note: "250 kg on 30 kN/m and 2 kN s/m above a wheel of 20 kg, a ball on a hard plane, released half its sag \
           (82 mm) too high; the chassis over 3 s against the formula for a wheel that stands still. Rapier's \
           contacts with the ground are set to 1 kHz, Avian's are its default.",
    make: quarter_car,
    few: false,
};

fn quarter_car() -> Problem {
    let (mass, k, c) = (f64::from(CHASSIS), f64::from(STIFFNESS), f64::from(DAMPING));
    let sag = mass * f64::from(GRAVITY) / k;
    let height = RADIUS + REST - 0.5 * sag as f32;
    let level = f64::from(RADIUS) + f64::from(REST) - sag;
    let start = f64::from(height) - level;
    let omega = (k / mass).sqrt();
    let zeta = c / (2.0 * mass * omega);
    let wheel = Kind::Wheel {
        mass: WHEEL,
        radius: RADIUS,
    };
    Problem {
        gravity: Vec3::NEG_Y * GRAVITY,
        bodies: vec![
            Body::new(wheel, Vec3::Y * RADIUS),
            Body::new(Kind::Upright { mass: CHASSIS }, Vec3::Y * height),
        ],
        links: vec![Link::new(0, 1, STIFFNESS, DAMPING, REST)],
        ground: true,
        seconds: 3.0,
        size: 0.1,
        energy: None,
        truth: Truth::formula(1, move |t| {
            DVec3::Y * (level + free(omega, zeta, start, 0.0, t))
        }),
    }
}
