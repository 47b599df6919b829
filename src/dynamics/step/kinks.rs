//! Refines the steps of a network near kinks of its laws, as where a rope becomes taut or a stop is hit.
//!
//! The linearised kick uses the steeper slope for its whole step, and so removes most of the energy of an impact that
//! lasts a step or two. Near a kink a network therefore takes micro-steps that resolve the steeper slope. For a while its
//! kicks also conserve the energy of kinked laws (`Network::keep_energy`).

use super::Component;
use crate::dynamics::element::Element;
use crate::dynamics::resolution::predicted_travel;
use std::f64::consts::PI;

/// ω h of micro-steps near a kink. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const FINE: f64 = 0.5;
/// Greatest number of micro-steps in a step near a kink. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const MOST: f64 = 20.0;
/// ω h above which micro-steps near a kink bring no improvement. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const COARSE: f64 = 1.0;

/// Greatest number of elements of a network that takes micro-steps for kinks. With more elements, one impact is a small
/// share of the energy, and some element is at a kink in every step. Pinned by
/// `kinks::tests::a_rope_of_few_pieces_takes_microsteps_as_it_becomes_taut_and_a_net_of_many_none`.
const FEW: usize = 64;

/// Relative change of stiffness at a kink above which energy would be lost there. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const SHARP: f64 = 0.1;

/// Time after an impact for which kicks conserve the energy of kinked laws, s. The energy of ordinary kicks oscillates a
/// little, and frequent changes between both kinds of kick would accumulate that. Pinned by
/// `laws::blows::a_ball_between_two_springs_with_stops_keeps_its_energy_and_goes_as_on_one`.
const KEPT: f64 = 0.5;

/// How long steps near kinks still need special treatment.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Kinks {
    /// Time for which steps must still be fine, s.
    fine: f64,
    /// Time for which kicks must still conserve energy, s.
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
    /// Number of micro-steps that kinks require in a step of `time` seconds. `z` is (ω h)² of the stiffest mode ahead.
    pub(super) fn steps_at_bends(&mut self, z: f64, time: f64) -> u32 {
        let phase = z.sqrt();
        let kinks =
            phase <= MOST * COARSE && self.elements.iter().any(|e| self.meets_bend(e, time));
        let Kinks { fine, kept } = &mut self.memory.kinks;
        if kinks {
            // An impact lasts half a period of the steeper slope. That part of the law has no kink, so none is found
            // meanwhile.
            *fine = (time * (1.5 + PI / phase)).min(KEPT);
            *kept = KEPT;
        } else {
            *fine = ((*fine).min(KEPT) - time).max(0.0);
            *kept = ((*kept).min(KEPT) - time).max(0.0);
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
        // Look backwards as well, because the motion may have begun just behind a kink, or a body may have been put
        // there.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::law::Law;
    use crate::dynamics::law::tests::recipe;
    use crate::dynamics::tests::{point, row};
    use bevy::math::DVec3;
    use std::sync::Arc;

    /// A slack rope of `count` pieces of 1 m and 1 kN/m, of which the first is pulled taut at 1 m/s.
    fn rope(count: usize) -> Component {
        let law = Arc::new(Law::new(recipe([1e3, 0.0, 0.0], [0.0; 3])));
        let mut bodies: Vec<_> = (0..=count)
            .map(|at| point(1.0, DVec3::X * 0.999 * at as f64, DVec3::ZERO))
            .collect();
        bodies[0].velocity = DVec3::NEG_X;
        let mut rope = row(bodies, 1e3);
        for piece in &mut rope.elements {
            piece.law = Some(law.clone());
        }
        rope
    }

    #[test]
    fn a_rope_of_few_pieces_takes_microsteps_as_it_becomes_taut_and_a_net_of_many_none() {
        let (omega, time) = (2000_f64.sqrt(), 1.0 / 60.0);
        for (count, is_fine) in [(1, true), (30, true), (300, false)] {
            let steps = rope(count).steps_at_bends((omega * time).powi(2), time);
            assert_eq!(steps > 1, is_fine, "{count} pieces: {steps} micro-steps");
        }
    }
}
