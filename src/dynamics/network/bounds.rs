//! Bounds on the stiffest and the most damped mode of a network, from sums over the elements of each body.

use super::Network;
use super::placement::braking;
use crate::dynamics::body::Body;
use crate::dynamics::element::Element;
use crate::dynamics::line::Line;
use crate::dynamics::resolution::predicted_travel;

impl Network {
    /// Returns bounds on (ω h)² of the stiffest mode and on 2γh of the most damped one.
    pub(crate) fn bounds(
        &mut self,
        elements: &[Element],
        bodies: &[Body],
        step: f64,
    ) -> (f64, f64) {
        self.begin_bounds(bodies.len());
        for element in elements {
            if let Some(line) = element.line(bodies) {
                // The bounds of a linear element do not depend on its speed.
                let (rate, predicted_travel) = match element.law {
                    Some(_) => {
                        let motion = line.motion(element, bodies, step);
                        (motion.axial, predicted_travel(&motion, step))
                    }
                    None => (0.0, [0.0; 2]),
                };
                let braking = braking(element, line.length, rate);
                self.add_bounds(element, &line, braking, &predicted_travel);
            }
        }
        self.end_bounds(step)
    }

    pub(super) fn bounds_of_rows(
        &mut self,
        elements: &[Element],
        bodies: usize,
        step: f64,
    ) -> (f64, f64) {
        self.begin_bounds(bodies);
        let mut rows = std::mem::take(&mut self.rows);
        for row in &mut rows {
            let (element, rate) = (&elements[row.element], row.before.axial);
            row.braking = braking(element, row.line.length, rate);
            self.add_bounds(element, &row.line, row.braking, &[step * rate]);
        }
        self.rows = rows;
        self.end_bounds(step)
    }

    fn begin_bounds(&mut self, bodies: usize) {
        for sums in [&mut self.stiffness, &mut self.damping] {
            sums.clear();
            sums.resize(bodies, 0.0);
        }
    }

    fn add_bounds(
        &mut self,
        element: &Element,
        line: &Line,
        damping: f64,
        predicted_travel: &[f64],
    ) {
        let ahead = |way: &f64| element.stiffness_ahead(line.length, *way);
        let stiffness = predicted_travel.iter().map(ahead).fold(0.0, f64::max);
        for (hold, share) in line.holds.iter().zip(shares(line.inverse_masses)) {
            if let Some(body) = hold.body {
                self.stiffness[body] += stiffness * share;
                self.damping[body] += damping * share;
            }
        }
    }

    fn end_bounds(&self, step: f64) -> (f64, f64) {
        let largest = |sums: &[f64]| sums.iter().copied().fold(0.0, f64::max);
        (
            step * step * largest(&self.stiffness),
            step * largest(&self.damping),
        )
    }
}

/// Shares of an element's stiffness and damping that count at its two ends, 1/kg.
#[inline(always)]
pub(in crate::dynamics) fn shares(inverse_masses: [f64; 2]) -> [f64; 2] {
    let w = inverse_masses.map(f64::sqrt);
    w.map(|own| own * (w[0] + w[1]))
}

/// Damping over mass of all other elements, at that end of a line where it is greater, 1/s. `damping` is that of all elements of
/// each body, and `own` the damping of the line's element (N s/m).
pub(super) fn of_others(damping: &[f64], line: &Line, own: f64) -> f64 {
    line.holds
        .iter()
        .zip(shares(line.inverse_masses))
        .filter_map(|(hold, share)| Some(damping[hold.body?] - own * share))
        .fold(0.0, f64::max)
}
