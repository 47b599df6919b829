//! Measures the energy of a network of points for its [bound](crate::dynamics::bound).

use super::{Line, Points, State, Wire};
use crate::dynamics::energy::{Energy, ROUNDINGS};
use crate::threads::{PIECE, share_pieces};
use bevy::math::DVec3;
use std::ops::Range;

/// Relative rounding error of the engine's f32.
const UNIT: f64 = f32::EPSILON as f64;

/// What the energy bound needs to know about a network.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::dynamics) struct Survey {
    pub energy: Energy,
    /// Energy that rounding a step's positions and velocities to f32 can add, J.
    pub rounding: f64,
    /// Greatest power of the ends with prescribed motion, W.
    pub power: f64,
}

impl Survey {
    fn add(&mut self, other: &Self) {
        self.energy.motion += other.energy.motion;
        self.energy.stored += other.energy.stored;
        self.energy.potential += other.energy.potential;
        self.rounding += other.rounding;
        self.power += other.power;
    }

    /// Adds the bodies in a range of indices.
    fn add_bodies(&mut self, points: &State, range: Range<usize>) {
        let moving = points.positions[range.clone()].iter();
        let moving = moving.zip(&points.velocities[range.clone()]);
        let pulled = points.accelerations[range.clone()].iter();
        let pulled = pulled.zip(&points.inverse_masses[range]);
        for ((position, velocity), (acceleration, inverse_mass)) in moving.zip(pulled) {
            let mass = inverse_mass.recip();
            let motion = 0.5 * mass * velocity.length_squared();
            self.energy.motion += motion;
            self.energy.potential -= mass * acceleration.dot(*position);
            self.rounding += 2.0 * UNIT * motion;
        }
    }

    #[inline(always)]
    fn add_wire(&mut self, wire: &Wire, points: &State) {
        let Some(line) = wire.line(points) else {
            // Stored energy at zero length.
            self.energy.stored += 0.5 * wire.stiffness * wire.rest_length.powi(2);
            return;
        };
        let stretch = line.length.abs() - wire.rest_length;
        self.energy.stored += 0.5 * wire.stiffness * stretch * stretch;
        let [a, b] = wire.of(&points.positions);
        let off = ROUNDINGS * UNIT * a.abs().max(b.abs()).max_element();
        let force = wire.stiffness * (line.length - wire.rest_length);
        self.rounding += off * (force.abs() + wire.stiffness * off);
        let [a, b] = wire.ends;
        if points.is_led(a) || points.is_led(b) {
            self.add_power(wire, &line, points);
        }
    }

    #[cold]
    fn add_power(&mut self, wire: &Wire, line: &Line, points: &State) {
        let [a, b] = wire.of(&points.velocities);
        let tension = wire.tension(line.length, (b - a).dot(line.direction));
        for led in wire.ends.into_iter().filter_map(|end| points.led(end)) {
            if led != DVec3::ZERO {
                self.power += tension.abs() * led.length();
            }
        }
    }
}

impl Points {
    pub(in crate::dynamics) fn survey(&mut self) -> Survey {
        let points = &self.points;
        let bodies = points.bodies.div_ceil(PIECE);
        let pieces = bodies + self.wires.len().div_ceil(PIECE);
        self.surveys.clear();
        self.surveys.resize(pieces, Survey::default());
        let (of_bodies, of_wires) = self.surveys.split_at_mut(bodies);
        share_pieces(of_bodies.iter_mut().enumerate(), |(piece, survey)| {
            let first = piece * PIECE;
            survey.add_bodies(points, first..points.bodies.min(first + PIECE));
        });
        share_pieces(
            of_wires.iter_mut().zip(self.wires.chunks(PIECE)),
            |(survey, wires)| {
                for wire in wires {
                    survey.add_wire(wire, points);
                }
            },
        );
        let mut all = Survey::default();
        for survey in &self.surveys {
            all.add(survey);
        }
        all
    }
}
