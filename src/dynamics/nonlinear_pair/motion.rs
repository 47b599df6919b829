//! How a tolerance and extrapolation step a lone element with a force law.

use super::NonlinearPair;
use crate::dynamics::arc::HALVED;
use crate::dynamics::tolerance::{Least, Steppable, VELOCITY_COUNTS};

impl Steppable for NonlinearPair<'_> {
    fn save(&mut self, slot: usize) {
        self.saved[slot] = self.state;
    }

    fn load(&mut self, slot: usize) {
        self.state = self.saved[slot];
    }

    /// Returns one, because a micro-step takes finer steps itself where it needs them.
    fn least(&mut self, _: f64, _: u32) -> Least {
        Least {
            count: 1,
            suffice: true,
        }
    }

    fn run(&mut self, time: f64, count: u32) {
        self.time = time;
        let step = time / f64::from(count);
        self.note_side();
        self.kicked = true;
        let resolved = self.is_resolved_in_reach(step);
        for _ in 0..count {
            self.microstep(step, resolved);
        }
    }

    fn distance(&self, slot: usize) -> f64 {
        let (a, b) = (&self.state, &self.saved[slot]);
        (a.d - b.d).length() + VELOCITY_COUNTS * (a.v - b.v).length()
    }

    fn travelled(&self, slot: usize) -> f64 {
        self.distance(slot)
    }

    fn extrapolate(&mut self, slot: usize) {
        // Only for a constant stiffness are kicks exact along the line.
        let exact = self.kicked && self.law.is_linear_in_parts();
        let times = if exact { HALVED } else { 4.0 };
        self.state.extrapolate(&self.saved[slot], times);
    }

    /// Whether the motion is smooth, as extrapolation requires.
    fn is_resolved(&mut self, step: f64) -> bool {
        let Some(line) = self.pair.line(&self.state) else {
            return false;
        };
        let to = (self.state.d + step * self.state.v).length();
        let turned = step * step * line.lateral_square;
        self.is_resolved_in_reach(step)
            && self
                .smooth_damping([line.length, to], line.axial, step)
                .is_some()
            && turned < line.length * line.length
    }
}
