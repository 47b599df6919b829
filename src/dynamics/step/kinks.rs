//! Where a law of a network kinks: a rope goes taut, a stop is hit.
//!
//! The linearised kick takes the steeper side for the whole of its step, and so eats most of a blow that lasts a
//! step or two. Around a bend a network therefore takes micro-steps that resolve the steeper side, and for a while its
//! kicks keep the energy of laws that bend (`Network::keep_energy`).

use super::Component;
use crate::dynamics::element::Element;
use crate::dynamics::resolution::predicted_travel;
use std::f64::consts::PI;

/// ω h of micro-steps around a bend, the most of them in a step for that, and ω h above which they are none the better.
const FINE: f64 = 0.5;
const MOST: f64 = 20.0;
const COARSE: f64 = 1.0;

/// Elements up to which a network takes micro-steps for kinks: where there are more, one blow is a small share of all,
/// and one or the other kinks in every step.
const FEW: usize = 64;

/// Share of the stiffness that has to change at a bend, for anything to be lost there.
const SHARP: f64 = 0.1;

/// For how long after a blow kicks keep the energy of kinked laws, s: energy of kicked motion sways a little, and to
/// go to and fro between the two would heap that up.
const KEPT: f64 = 0.5;

/// What is still to be done about kinks.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Kinks {
    /// For how long steps have to be fine, s.
    fine: f64,
    /// For how long kicks have to keep energy, s.
    kept: f64,
}

impl Kinks {
    pub(super) fn are_near(self) -> bool {
        self.fine > 0.0
    }

    pub(super) fn keep_energy(self) -> bool {
        self.kept > 0.0
    }
}

impl Component {
    /// Micro-steps that kinks ask for in a step, where (ω h)² of the stiffest mode ahead is `z`.
    pub(super) fn steps_at_bends(&mut self, z: f64, time: f64) -> u32 {
        let phase = z.sqrt();
        let kinks =
            phase <= MOST * COARSE && self.elements.iter().any(|e| self.meets_bend(e, time));
        let Kinks { fine, kept } = &mut self.memory.kinks;
        if kinks {
            // A blow lasts half a period of the steeper side, on which nothing kinks.
            *fine = (time * (1.5 + PI / phase)).min(KEPT);
            *kept = KEPT;
        } else {
            *fine = (*fine - time).max(0.0);
            *kept = (*kept - time).max(0.0);
        }
        if *fine > 0.0 && self.elements.len() <= FEW {
            (phase / FINE).ceil().clamp(1.0, MOST) as u32
        } else {
            1
        }
    }

    fn meets_bend(&self, element: &Element, time: f64) -> bool {
        let Some(law) = element.law.as_ref().filter(|law| law.is_bent()) else {
            return false;
        };
        let Some(line) = element.line(&self.bodies) else {
            return false;
        };
        let rest = element.rest_length;
        let here = (
            law.part(line.length, rest),
            element.elastic(line.length).stiffness,
        );
        let predicted_travel = predicted_travel(&line.motion(element, &self.bodies, 0.0), time);
        // Also behind: it may have begun there, or been put there.
        predicted_travel
            .into_iter()
            .chain([-predicted_travel[0]])
            .any(|way| {
                let there = element.elastic(line.length + way).stiffness;
                law.part(line.length + way, rest) != here.0
                    && (there - here.1).abs() > SHARP * there.max(here.1)
            })
    }
}
