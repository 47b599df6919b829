//! Makes a kick conserve the energy of laws with kinks.
//!
//! The mean force over the step must do the work of the law's energy (D. Greenspan and R. LaBudde, 1974):
//!
//! ```text
//! f = (U(l₁) − U(l₀)) / (l₁ − l₀)
//! ```
//!
//! where l₀ and l₁ are the lengths at the start and the end of the step. l₁ depends on the force. So the result of the
//! linear solve is corrected several times, with the same matrix.

use super::{Network, Row};
use crate::dynamics::body::Body;
use crate::dynamics::conjugate::LAST;
use crate::dynamics::element::Element;
use bevy::math::DVec3;

/// Greatest number of corrections. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const ROUNDS: usize = 6;
/// Force error at which corrections end, as a share of the greatest force. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const RIGHT: f64 = 1e-7;
/// (ω h)² up to which corrections surely converge. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const CONVERGES: f64 = 1.0;

impl Network {
    pub(super) fn keep_energy(
        &mut self,
        elements: &[Element],
        bodies: &[Body],
        step: f64,
        budget: u32,
    ) {
        for _ in 0..ROUNDS {
            let (mut greatest, mut wrong) = (0.0_f64, 0.0_f64);
            for (row, strut) in self.rows.iter_mut().zip(&self.system.struts) {
                let element = &elements[row.element];
                let gained = strut.relative(&self.acceleration);
                let Some(mean) = row.mean_force(element, gained, step) else {
                    continue;
                };
                // The solve itself adds an elastic force for this acceleration, which the mean force already contains.
                let slope = strut.along - row.damping;
                let now = mean - slope * gained.dot(row.line.direction);
                greatest = greatest.max(mean.abs());
                wrong = wrong.max((now - row.elastic).abs());
                row.load += (now - row.elastic) * row.line.direction;
                row.elastic = now;
                row.centripetal_gain = row.damping;
            }
            if wrong <= RIGHT * greatest {
                return;
            }
            self.solve(bodies, LAST, budget);
        }
    }
}

impl Row {
    /// Force that does the work of the law's energy for a relative acceleration of the ends, N. None if the law has no kink,
    /// or if corrections may not converge.
    fn mean_force(&self, element: &Element, gained: DVec3, step: f64) -> Option<f64> {
        let law = element.law.as_ref().filter(|law| law.is_bent())?;
        let [from, to] = self.lengths(gained, step);
        let stiffest = law.stiffest([from, to], element.rest_length);
        if stiffest * self.line.inverse_mass * step * step > CONVERGES {
            return None;
        }
        Some(law.mean_force([from, to], element.rest_length))
    }

    /// Lengths at the start and the end of the step for a relative acceleration of the ends, m.
    fn lengths(&self, gained: DVec3, step: f64) -> [f64; 2] {
        let Self { line, before, .. } = self;
        let arms = step * step / 8.0 * before.arms;
        if line.guided {
            // The direction of a twist between tilted ends is no unit vector, so no rate along it is the rate of the twist.
            let after = before.axial + step * gained.dot(line.direction);
            return [-before.axial, after].map(|rate| line.length + 0.5 * step * rate + arms);
        }
        let before = before.axial * line.direction + before.lateral;
        let displaced = |by: DVec3| {
            let apart = line.length * line.direction + by;
            apart.length().copysign(line.length) + arms
        };
        [
            displaced(-0.5 * step * before),
            displaced(0.5 * step * (before + step * gained)),
        ]
    }
}
