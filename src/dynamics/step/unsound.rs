//! Leaves out of a step those elements whose custom law gives NaN or infinity at a length that the step reaches. Otherwise the
//! step would have no result, and the whole network would stand still.

use super::Component;
use crate::dynamics::body::Body;
use crate::dynamics::energy::Energy;
use crate::dynamics::tolerance::Steppable;

/// Parts of a micro-step of motion ahead at which a law is looked at. A kick uses the law at the length that it meets, and
/// up to the end of its micro-step. Pinned by `laws::bad`.
const PROBED: [f64; 3] = [0.0, 0.5, 1.0];

impl Component {
    /// Whether the energy at the end of the step is a number.
    pub(super) fn has_energy(&self) -> bool {
        let energy = Energy::of(&self.elements, &self.bodies);
        energy.sum().is_finite()
    }

    /// Takes the step again in `count` micro-steps, without the elements whose law gives no number on the way. Returns whether
    /// there are such elements.
    pub(super) fn leave_out_unsound(&mut self, time: f64, count: u32) -> bool {
        let found = self.find_unsound(time / f64::from(count), count);
        self.load(0);
        // Iterations that start from NaN would never converge.
        self.forget_solutions();
        if found.is_empty() {
            return false;
        }
        for elements in [&mut self.elements, &mut self.memory.saved[0].elements] {
            for index in &found {
                let element = &mut elements[*index];
                element.law = None;
                (element.stiffness, element.damping) = (0.0, 0.0);
            }
        }
        self.unsound.extend(found);
        self.run(time, count);
        self.hold_back(time);
        true
    }

    /// Goes through the step until some laws give no number. Returns the indices of their elements.
    fn find_unsound(&mut self, step: f64, count: u32) -> Vec<usize> {
        self.load(0);
        self.forget_solutions();
        self.aim(step);
        for _ in 0..count {
            self.drift(step / 2.0);
            let found = self.unsound_now(step);
            if !found.is_empty() {
                return found;
            }
            self.kick_network(step);
            self.drift(step / 2.0);
            self.aim(step);
        }
        self.unsound_now(step)
    }

    /// Indices of the elements whose law gives no number in the present state or [`PROBED`] ahead of it.
    fn unsound_now(&self, step: f64) -> Vec<usize> {
        if !self.bodies.iter().all(Body::is_finite) {
            return Vec::new();
        }
        let elements = self.elements.iter().enumerate();
        let unsound = elements.filter(|(_, element)| {
            element.law.is_some()
                && element.line(&self.bodies).is_some_and(|line| {
                    let rate = line.motion(element, &self.bodies, step).axial;
                    let mut lengths = PROBED.iter().map(|part| line.length + part * step * rate);
                    lengths.any(|length| !element.is_sound(length, rate))
                })
        });
        unsound.map(|(index, _)| index).collect()
    }
}
