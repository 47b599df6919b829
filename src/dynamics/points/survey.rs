//! What a network of points has, for its [bound](crate::dynamics::bound).

use super::Points;
use crate::dynamics::energy::Energy;
use bevy::math::DVec3;

/// What the energy bound asks of a network.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::dynamics) struct Survey {
    pub energy: Energy,
    /// What rounding a step's positions and velocities to f32 can add to it, J.
    pub rounding: f64,
    /// Power of ends that something else moves, at most, W.
    pub power: f64,
}

impl Points {
    pub(in crate::dynamics) fn survey(&self) -> Survey {
        let unit = f64::from(f32::EPSILON);
        let mut survey = Survey::default();
        let energy = &mut survey.energy;
        for point in &self.points[..self.bodies] {
            let mass = point.inverse_mass.recip();
            let motion = 0.5 * mass * point.velocity.length_squared();
            energy.motion += motion;
            energy.place -= mass * point.acceleration.dot(point.position);
            survey.rounding += 2.0 * unit * motion;
        }
        for wire in &self.wires {
            let ends = wire.of(&self.points);
            let Some(line) = wire.line(ends) else {
                // As one of no length.
                energy.stored += 0.5 * wire.stiffness * wire.rest_length.powi(2);
                continue;
            };
            let stretch = line.length.abs() - wire.rest_length;
            energy.stored += 0.5 * wire.stiffness * stretch * stretch;
            // Four substeps, two ends.
            let reach = ends[0].position.abs().max(ends[1].position.abs());
            let off = 8.0 * unit * reach.max_element();
            let force = wire.stiffness * (line.length - wire.rest_length);
            survey.rounding += off * (force.abs() + wire.stiffness * off);
            for end in ends {
                if end.inverse_mass == 0.0 && end.velocity != DVec3::ZERO {
                    let rate = (ends[1].velocity - ends[0].velocity).dot(line.direction);
                    survey.power += wire.tension(line.length, rate).abs() * end.velocity.length();
                }
            }
        }
        survey
    }
}
