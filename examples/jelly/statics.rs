//! Where the points of a jelly must rest that stands on some of them: least energy, found by going down its slope.

use super::lattice::{MASS, links};
use bevy::math::DVec3;

const GRAVITY: f64 = 9.81;
/// Of a step down the slope, m²/J; and what a step keeps of the one before.
const STEP: f64 = 1e-4;
const KEEP: f64 = 0.98;
const STEPS: usize = 6000;

/// From these places, of which some stay, to those of least energy.
pub fn rest(mut places: Vec<DVec3>, stays: &[bool]) -> Vec<DVec3> {
    let links = links();
    let mut moves = vec![DVec3::ZERO; places.len()];
    for _ in 0..STEPS {
        let mut forces = vec![DVec3::NEG_Y * f64::from(MASS) * GRAVITY; places.len()];
        for ([a, b], stiffness, length) in &links {
            let along = places[*b] - places[*a];
            let force = f64::from(*stiffness) * (along.length() - f64::from(*length));
            let force = force * along.normalize_or_zero();
            forces[*a] += force;
            forces[*b] -= force;
        }
        for (i, force) in forces.into_iter().enumerate() {
            if !stays[i] {
                moves[i] = KEEP * moves[i] + STEP * force;
                places[i] += moves[i];
            }
        }
    }
    places
}
