//! A step that wins energy is taken again in finer micro-steps, before it is taken in the way that only loses energy.
//!
//! Where lines turn far within a step, the coupled step is right only to its order, however stiff the springs; a bridge of
//! a thousand planks that falls is an example. Finer micro-steps follow it. They stay for a while: what turned too far once
//! does so again.

use super::Component;
use crate::dynamics::bound::Bound;
use crate::dynamics::energy::Energy;
use crate::dynamics::tolerance::{Accuracy, Motion, Outcome};

/// Times as many micro-steps as those that have won energy.
const FINER: u32 = 4;

/// Most of them where the budget is for fewer. A step of a stiff network takes hardly longer for that: its linear system
/// is the easier to solve the shorter a micro-step is. Pinned by `stiff_by_default::a_long_bridge_falls_as_it_should`.
const MOST: u32 = 16;

/// For how long they stay, or are not tried again where they won energy too, s.
const STAYS: f64 = 0.5;

/// Whether a network has won energy of late, and what was done about it.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Caution {
    /// s.
    left: f64,
    /// Micro-steps that did not win any; 0 where there were none such.
    microsteps: u32,
}

impl Caution {
    /// Goes on by a step, and says how finely it is to be taken.
    pub(super) fn pass(&mut self, time: f64, accuracy: Accuracy) -> Accuracy {
        if self.left <= 0.0 {
            return accuracy;
        }
        self.left -= time;
        Accuracy {
            microsteps: accuracy.microsteps.max(self.microsteps),
            ..accuracy
        }
    }
}

impl Component {
    /// Takes a network's step again, finer and finer; returns what energy there is then, if that won nothing. Where as many micro-steps are taken as
    /// are asked, it is left as it is.
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
            self.memory.caution = Caution {
                left: STAYS,
                microsteps: if kept.is_some() { count } else { 0 },
            };
            if kept.is_some() {
                return kept;
            }
        }
    }
}
