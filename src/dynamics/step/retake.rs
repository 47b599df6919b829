//! Repeats a step that gained energy with finer micro-steps, before the method that only loses energy is used.
//!
//! Where lines turn far within a step, the coupled step is accurate only to its order, however stiff the springs are. An
//! example is a falling bridge of a thousand planks. Finer micro-steps resolve the turning. They are kept for a while,
//! because lines that turned too far once do so again.

use super::Component;
use crate::dynamics::bound::Bound;
use crate::dynamics::energy::Energy;
use crate::dynamics::tolerance::{Accuracy, Outcome, Steppable};

/// Factor by which each repetition increases the number of micro-steps. Pinned by
/// `retake::tests::a_step_that_gained_energy_becomes_only_as_fine_as_it_must`.
const FINER: u32 = 4;

/// Greatest number of micro-steps of a repeated step if the budget is less. They hardly make the step of a stiff network
/// slower, because the linear system is easier to solve for a shorter micro-step. Pinned by
/// `stiff_by_default::a_long_bridge_falls_as_it_should`.
const MOST: u32 = 16;

/// Time for which [`FINER`] micro-steps are kept, or none are tried again if all gained energy, s. More micro-steps are kept for
/// a shorter time, in which they cost as much. Pinned by
/// `retake::tests::finer_microsteps_are_kept_for_a_while_and_then_become_coarser_step_by_step`.
const STAYS: f64 = 0.5;

/// Whether a network gained energy recently, and the number of micro-steps that avoided it.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Caution {
    /// Time for which that number still holds, s.
    left: f64,
    /// Number of micro-steps that gained no energy; 0 if every number that was tried gained some.
    microsteps: u32,
}

impl Caution {
    /// Begins to keep so many micro-steps.
    fn of(microsteps: u32) -> Self {
        Self {
            left: STAYS * f64::from(FINER) / f64::from(microsteps.max(FINER)),
            microsteps,
        }
    }

    /// Advances the memory by a step of `time` seconds. Returns the accuracy of that step.
    pub(super) fn pass(&mut self, time: f64, accuracy: Accuracy) -> Accuracy {
        if self.left.is_nan() || self.left <= 0.0 {
            if self.microsteps <= FINER {
                return accuracy;
            }
            *self = Self::of(self.microsteps / FINER);
        }
        self.left = self.left.min(STAYS) - time;
        Accuracy {
            microsteps: accuracy.microsteps.max(self.microsteps),
            ..accuracy
        }
    }
}

impl Component {
    /// Repeats a network's step with finer and finer micro-steps. Returns the energy at its end if it gained none. Does
    /// nothing if there is no budget for more micro-steps (`resolve` is 0).
    pub(super) fn retake(
        &mut self,
        time: f64,
        accuracy: Accuracy,
        outcome: &mut Outcome,
        bound: &mut Bound,
    ) -> Option<Energy> {
        let caution = self.memory.caution;
        let is_tried = caution.left > 0.0 && caution.microsteps == 0;
        if is_tried || accuracy.resolve == 0 || self.is_alone() {
            return None;
        }
        let most = accuracy.resolve.max(MOST);
        let mut taken = outcome.microsteps.max(1);
        loop {
            let (count, _) = accuracy.cap(FINER.saturating_mul(taken).min(most));
            if count <= taken {
                return None;
            }
            self.load(0);
            self.run(time, count);
            self.hold_back(time);
            outcome.microsteps += count;
            taken = count;
            let kept = bound.hold(&self.elements, &mut self.bodies, time);
            self.memory.caution = Caution::of(if kept.is_some() { count } else { 0 });
            if kept.is_some() {
                return kept;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::{point, row};
    use bevy::math::DVec3;

    #[test]
    fn finer_microsteps_are_kept_for_a_while_and_then_become_coarser_step_by_step() {
        let mut caution = Caution::of(16);
        let mut step = || caution.pass(1.0 / 60.0, Accuracy::exactly(1)).microsteps;
        let taken: Vec<u32> = (0..60).map(|_| step()).collect();
        assert!(taken.is_sorted_by(|a, b| a >= b), "{taken:?}");
        for (count, [least, most]) in [(16, [5, 15]), (4, [20, 45]), (1, [1, 35])] {
            let steps = taken.iter().filter(|taken| **taken == count).count();
            assert!((least..=most).contains(&steps), "{count}: {taken:?}");
        }
    }

    /// Micro-steps that four masses in a row on three stiff springs take in ten seconds of a wild flight.
    fn microsteps(stiffness: f64, speed: f64) -> u32 {
        let mut bodies: Vec<_> = (0..4)
            .map(|at| point(1.0, DVec3::X * f64::from(at), DVec3::NEG_Y * 9.81))
            .collect();
        bodies[0].velocity = DVec3::Y * speed;
        bodies[2].velocity = DVec3::NEG_Y * speed;
        bodies[3].velocity = DVec3::Z * speed;
        let mut row = row(bodies, stiffness);
        let accuracy = Accuracy {
            resolve: 8,
            ..Accuracy::exactly(1)
        };
        (0..600)
            .map(|_| row.advance(1.0 / 60.0, accuracy).microsteps)
            .sum()
    }

    #[test]
    fn a_step_that_gained_energy_becomes_only_as_fine_as_it_must() {
        for (stiffness, speed, most) in [(1e4, 30.0, 1700), (1e5, 10.0, 1250)] {
            let taken = microsteps(stiffness, speed);
            assert!(taken < most, "{stiffness} N/m at {speed} m/s: {taken}");
        }
    }
}
