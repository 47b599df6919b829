//! The shape of the jelly at rest on some of its points: minimum energy, by gradient descent.

use super::lattice::{MASS, links};
use bevy::math::DVec3;

const GRAVITY: f64 = 9.81;
/// Step of the gradient descent, m²/J.
const STEP: f64 = 1e-4;
/// Share of the last step that the next one keeps (momentum).
const KEEP: f64 = 0.98;
const STEPS: usize = 6000;

/// Returns the positions of minimum energy, starting from `places`. Points with `stays` do not move.
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
