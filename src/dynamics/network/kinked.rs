//! A kick that keeps the energy of laws that bend within the step.
//!
//! The mean force over the step is to do the work of the law's energy (D. Greenspan and R. LaBudde, 1974):
//!
//! ```text
//! f = (U(l₁) − U(l₀)) / (l₁ − l₀)
//! ```
//!
//! with the lengths at both ends of the step, of which the last depends on the force. What the linear solve has found
//! is put right by that, a few times; its matrix stays.

use super::{Network, Row};
use crate::dynamics::body::Body;
use crate::dynamics::element::Element;
use crate::dynamics::line::Line;
use bevy::math::DVec3;

/// Most rounds of putting right, the share of the greatest force below which nothing more is, and (ω h)² up to which
/// they surely converge.
const ROUNDS: usize = 6;
const RIGHT: f64 = 1e-7;
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
                // What the solve makes of the gain beyond damping is in the mean force.
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
            self.solve(bodies, budget);
        }
    }
}

impl Row {
    /// The force that does the work of the law's energy, for a relative acceleration of the ends; none where the law
    /// is not kinked.
    fn mean_force(&self, element: &Element, gained: DVec3, step: f64) -> Option<f64> {
        let law = element.law.as_ref().filter(|law| law.is_bent())?;
        let before = self.before.axial * self.line.direction + self.before.lateral;
        let arms = step * step / 8.0 * self.before.arms;
        let from = self.line.length_at(-0.5 * step * before) + arms;
        let to = self.line.length_at(0.5 * step * (before + step * gained)) + arms;
        let stiffest = law.stiffest([from, to], element.rest_length);
        if stiffest * self.line.inverse_mass * step * step > CONVERGES {
            return None;
        }
        Some(law.mean_force([from, to], element.rest_length))
    }
}

impl Line {
    /// Its length where end B is displaced against end A.
    fn length_at(&self, by: DVec3) -> f64 {
        if self.guided {
            self.length + by.dot(self.direction)
        } else {
            (self.length * self.direction + by)
                .length()
                .copysign(self.length)
        }
    }
}
