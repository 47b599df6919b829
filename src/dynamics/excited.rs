//! Takes the micro-steps that follow a stiff mode only while the mode is excited.
//!
//! The stiffness of a component determines how many micro-steps follow its fastest mode. To see whether that mode moves, the
//! step is taken with few micro-steps and with twice as many. If both end in the same state, the stiff modes are at rest.
//! (No mode escapes this test: one kick of the midpoint rule advances a mode of phase x by 2·atan(x/2), and two kicks
//! advance it by 4·atan(x/4). These angles are never equal.)

use super::tolerance::Steppable;
use bevy::math::DVec3;

/// Difference of the two end states up to which stiff modes count as at rest, m per simulated second. Pinned by
/// `stiff_by_default`, and by the map of mass ratios that `compare` draws.
const UNNOTICED: f64 = 1e-4;

/// Difference of the two end states up to which stiff modes count as at rest, as a share of the relative motion of bodies.
/// It is the error of a mode that the micro-steps barely follow ([`super::resolution`]). Pinned by
/// `stiff_by_default::a_stiff_mode_costs_nothing_until_it_is_struck`.
const SMALL: f64 = 2e-3;

/// Least number of micro-steps for which an attempt with fewer pays. Pinned by
/// `excited::tests::a_few_kicks_are_taken_without_an_attempt`.
const WORTH: u32 = 8;

/// Share of the allowed difference below which the next attempt begins with half as many micro-steps. The error then
/// grows by a factor of four. The margin beyond that prevents frequent changes of the number. Pinned by
/// `excited::tests::a_mode_is_followed_with_as_few_kicks_as_show_that_it_is_at_rest`.
const FAR_BELOW: f64 = 0.1;

/// Greatest number of steps between attempts that fail. Each of these takes up to seven eighths of the kicks of a step in vain.
/// Once in 17 steps, this is about a twentieth of all kicks. Pinned by
/// `excited::tests::a_struck_mode_costs_a_twentieth_more_than_all_kicks_and_its_rest_is_seen_soon`.
const LONGEST_WAIT: u8 = 16;

/// Memory of how finely a motion had to be followed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Excited {
    /// Number of micro-steps with which the next attempt begins.
    first: u16,
    /// Number of steps until the next attempt.
    wait: u8,
    /// Number of steps from the last attempt to the next; 0 if the last attempt succeeded.
    span: u8,
}

impl Excited {
    /// Takes a step in `all` micro-steps, or in fewer (at least `least`) that end in the same state. Returns the number of
    /// kicks that this took.
    pub(super) fn run(
        &mut self,
        motion: &mut impl Steppable,
        time: f64,
        [least, all]: [u32; 2],
    ) -> u32 {
        if all < WORTH.max(least.saturating_mul(4)) {
            motion.run(time, all);
            return all;
        }
        if self.wait > 0 {
            self.wait -= 1;
            motion.run(time, all);
            return all;
        }
        let mut count = u32::from(self.first).max(least).min(all);
        let mut kicks = count;
        motion.save(0);
        motion.run(time, count);
        // Beyond a quarter, all micro-steps at once cost no more.
        while count.saturating_mul(4) <= all {
            motion.save(1);
            motion.load(0);
            motion.run(time, 2 * count);
            kicks += 2 * count;
            let apart = motion.distance(1);
            let allowed = (UNNOTICED * time).max(SMALL * motion.travelled(0));
            if apart <= allowed {
                let calm = apart <= FAR_BELOW * allowed;
                let first = if calm { count / 2 } else { count };
                self.first = u16::try_from(first).unwrap_or(u16::MAX);
                self.span = 0;
                return kicks;
            }
            count *= 2;
        }
        // The next attempt compares an eighth with a quarter, and if these differ, a quarter with a half. If the mode has come to
        // rest, the first comparison shows that at little cost.
        self.first = u16::try_from(all / 8).unwrap_or(u16::MAX);
        self.span = self.span.saturating_mul(2).clamp(1, LONGEST_WAIT);
        self.wait = self.span;
        motion.load(0);
        motion.run(time, all);
        kicks + all
    }
}

/// Half the diagonal of the box around all displacements, m; zero if all displacements are equal.
pub(super) fn spread(displacements: impl Iterator<Item = DVec3>) -> f64 {
    let (least, most) = displacements.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), d| {
        (a.min(d), b.max(d))
    });
    if least.is_finite() {
        0.5 * (most - least).length()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tolerance::tests::{Model, STEP};

    /// A motion that ends off by `error`/count² m/s, where a step of [`STEP`] is taken in so many micro-steps.
    fn mode(error: f64) -> Model {
        Model::new((error, 0.0))
    }

    fn struck() -> Model {
        mode(1e3)
    }

    /// Kicks of a step in `all` micro-steps or fewer. Two end states count as equal up to 0.1 mm/s.
    fn kicks(excited: &mut Excited, mode: &mut Model, all: u32) -> u32 {
        excited.run(mode, STEP, [1, all])
    }

    #[test]
    fn a_struck_mode_costs_a_twentieth_more_than_all_kicks_and_its_rest_is_seen_soon() {
        let (mut excited, mut struck) = (Excited::default(), struck());
        let sum: u32 = (0..340).map(|_| kicks(&mut excited, &mut struck, 32)).sum();
        assert!((340 * 32..340 * 35).contains(&sum), "{sum}");
        let mut calm = mode(0.0);
        let until = (0..340).position(|_| kicks(&mut excited, &mut calm, 32) < 32);
        assert!(until.is_some_and(|steps| steps <= 17), "{until:?}");
    }

    #[test]
    fn a_mode_is_followed_with_as_few_kicks_as_show_that_it_is_at_rest() {
        // The end states of four and eight micro-steps differ by a half of what is allowed, and then by a twentieth: there those
        // of two and four differ by a fifth.
        for (error, each) in [(1.0667e-3, 4 + 8), (1.0667e-4, 2 + 4)] {
            let (mut excited, mut mode) = (Excited::default(), mode(error));
            kicks(&mut excited, &mut struck(), 32);
            // One step without an attempt, and as many as it takes to settle.
            let first: Vec<u32> = (0..4).map(|_| kicks(&mut excited, &mut mode, 32)).collect();
            for _ in 0..10 {
                let now = kicks(&mut excited, &mut mode, 32);
                assert_eq!(now, each, "{error} after {first:?}");
            }
        }
    }

    #[test]
    fn a_few_kicks_are_taken_without_an_attempt() {
        for all in [4, 7] {
            assert_eq!(kicks(&mut Excited::default(), &mut struck(), all), all);
        }
        // With eight, rest is seen with one and two.
        assert_eq!(kicks(&mut Excited::default(), &mut mode(0.0), 8), 1 + 2);
    }
}
