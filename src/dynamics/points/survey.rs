//! Measures the energy of a network of points for its [bound](crate::dynamics::bound).

use super::{Point, Points, Wire};
use crate::dynamics::energy::Energy;
use crate::threads::{PIECE, share};
use bevy::math::DVec3;

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
        self.energy.place += other.energy.place;
        self.rounding += other.rounding;
        self.power += other.power;
    }

    #[inline(always)]
    fn add_body(&mut self, point: &Point) {
        let mass = point.inverse_mass.recip();
        let motion = 0.5 * mass * point.velocity.length_squared();
        self.energy.motion += motion;
        self.energy.place -= mass * point.acceleration.dot(point.position);
        self.rounding += 2.0 * UNIT * motion;
    }

    #[inline(always)]
    fn add_wire(&mut self, wire: &Wire, ends: [&Point; 2]) {
        let Some(line) = wire.line(ends) else {
            // Stored energy at zero length.
            self.energy.stored += 0.5 * wire.stiffness * wire.rest_length.powi(2);
            return;
        };
        let stretch = line.length.abs() - wire.rest_length;
        self.energy.stored += 0.5 * wire.stiffness * stretch * stretch;
        // Rounding in four substeps at two ends.
        let reach = ends[0].position.abs().max(ends[1].position.abs());
        let off = 8.0 * UNIT * reach.max_element();
        let force = wire.stiffness * (line.length - wire.rest_length);
        self.rounding += off * (force.abs() + wire.stiffness * off);
        for end in ends {
            if end.inverse_mass == 0.0 && end.velocity != DVec3::ZERO {
                let rate = (ends[1].velocity - ends[0].velocity).dot(line.direction);
                self.power += wire.tension(line.length, rate).abs() * end.velocity.length();
            }
        }
    }
}

impl Points {
    pub(in crate::dynamics) fn survey(&mut self) -> Survey {
        let (points, bodies) = (&self.points, &self.points[..self.bodies]);
        let (of_bodies, of_wires) = (
            bodies.len().div_ceil(PIECE),
            self.wires.len().div_ceil(PIECE),
        );
        self.surveys.clear();
        self.surveys.resize(of_bodies + of_wires, Survey::default());
        let (of_bodies, of_wires) = self.surveys.split_at_mut(of_bodies);
        share(
            of_bodies.iter_mut().zip(bodies.chunks(PIECE)),
            |(survey, bodies)| bodies.iter().for_each(|body| survey.add_body(body)),
        );
        share(
            of_wires.iter_mut().zip(self.wires.chunks(PIECE)),
            |(survey, wires)| {
                for wire in wires {
                    survey.add_wire(wire, wire.of(points));
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
