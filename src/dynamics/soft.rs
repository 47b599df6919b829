//! An element as a soft constraint: what an engine's solver is given where contacts or joints hold a body.
//!
//! A force that is worked out before the engine knows of contacts and joints is explicit to them. So an element on a
//! held body is solved by the engine itself, together with what holds it. In every solver substep h it acts with
//!
//! ```text
//! F = force + stiffness·(s − at) + damping·ṡ
//! ```
//!
//! where s is the length at the start of the substep and ṡ its rate at the end. That is the symplectic Euler rule for
//! the spring, which keeps energy while ω h < 2, and implicit damping, which only takes it. A force law is made linear
//! anew for every step, in [`super::pieces`], so that its mean force does the work of its energy; what is left over is paid in
//! the next one.

use super::law::Elastic;
use super::tolerance::{Method, Outcome};

/// ω h of the stiffest mode that substeps aim at: a quarter of what the symplectic rule stands.
/// Pinned by `ground::nets` and `ground::bridge`.
const RESOLVED: f64 = 0.5;

/// ω h above which damping is added, and up to which it grows to that of the implicit rule: the last resort where even
/// the most substeps do not resolve a mode. Pinned by `ground::nets`.
const UNRESOLVED: [f64; 2] = [1.5, 2.0];

/// ω h that substeps aim at for elements without damping of their own, so that they keep their energy too; and the most substeps that this
/// is worth. Pinned by `ground::hinge`.
const KEPT: f64 = 0.05;
const WORTH: u32 = 32;

/// ω h above which velocities at the end of a step are so far from the positions there, half a substep, that energy would
/// seem to be won by turns, up to where damping makes up for it; and that damping, as a share of that of the implicit rule.
/// Pinned by `ground::hinge`.
const STAGGERED: [f64; 2] = [0.05, 0.1];
const SETTLING: f64 = 0.25;

/// Least damping, as a share of h·stiffness. The engine divides by the damping, so it must not be zero; a damping ratio
/// of ω h / 4000 costs an undamped door 0.1 % of its amplitude in eight seconds. Pinned by `joints::door`.
const LEAST: f64 = 5e-4;

/// A force that is linear in a length and its rate, over one step. For a torsion element angles stand for lengths and
/// moments for forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tangent {
    /// Tension at the length `at` and at rest, N.
    pub force: f64,
    /// m.
    pub at: f64,
    /// N/m.
    pub stiffness: f64,
    /// N s/m, not negative.
    pub damping: f64,
}

impl Tangent {
    /// Whether substeps of so long would damp it more than it does by itself, where they do not resolve it finely.
    pub(crate) fn is_undamped(&self, substep: f64) -> bool {
        self.damping < SETTLING * substep * self.stiffness
    }

    /// That share of it.
    pub(crate) fn times(self, share: f64) -> Self {
        Self {
            force: share * self.force,
            at: self.at,
            stiffness: share * self.stiffness,
            damping: share * self.damping,
        }
    }

    /// Of a linear element.
    pub(crate) const fn linear(stiffness: f64, damping: f64, rest_length: f64) -> Self {
        Self {
            force: 0.0,
            at: rest_length,
            stiffness,
            damping,
        }
    }

    /// Of a force on its way between two lengths: a chord that does the work of its energy.
    pub(super) fn chord(force: impl Fn(f64) -> Elastic, [from, to]: [f64; 2]) -> Self {
        let [first, last] = [from, to].map(&force);
        let middle = 0.5 * (from + to);
        let way = to - from;
        let size = from.abs() + to.abs();
        Self {
            force: if way.abs() > 1e-7 * size {
                (last.energy - first.energy) / way
            } else {
                force(middle).force
            },
            at: middle,
            stiffness: if way.abs() > 1e-6 * size {
                (last.force - first.force) / way
            } else {
                first.stiffness
            },
            damping: 0.0,
        }
    }

    /// Tension without damping.
    pub(crate) fn elastic(&self, length: f64) -> f64 {
        self.force + self.stiffness * (length - self.at)
    }

    /// Its integral between two lengths, J: what the bodies lose to it.
    pub(crate) fn work(&self, [from, to]: [f64; 2]) -> f64 {
        (to - from) * self.elastic(0.5 * (from + to))
    }
}

/// How finely a component is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fineness {
    /// Solver substeps of the engine's step.
    pub substeps: u32,
    /// A mode is not resolved even so.
    pub capped: bool,
}

impl Fineness {
    /// For a step of `time` seconds, a stiffest mode of at most `omega` rad/s, and one of at most `undamped` of those
    /// elements that no damper slows.
    pub(crate) fn of(omega: f64, undamped: f64, time: f64, least: u32, most: u32) -> Self {
        // In few sizes, so that a little more stiffness does not have everything set up anew.
        let wanted = |phase: f64, most: u32| {
            let wanted = phase.ceil().min(f64::from(most));
            (wanted as u32).next_multiple_of(8).min(most)
        };
        let resolved = wanted(omega * time / RESOLVED, most);
        let kept = wanted(undamped * time / KEPT, WORTH);
        let substeps = resolved.max(kept).max(least).min(most.max(1));
        Self {
            substeps,
            capped: omega * time > UNRESOLVED[0] * f64::from(substeps),
        }
    }
}

impl Fineness {
    /// What is told of a step in so many substeps.
    pub(crate) fn outcome(&self, substeps: u32) -> Outcome {
        Outcome {
            method: Method::Engine,
            microsteps: substeps,
            capped: self.capped,
            unresolved: self.capped,
            ..Outcome::default()
        }
    }
}

/// The damping with which an element is to act in substeps of so long. `omega` is that of the stiffest mode that it takes
/// part in, rad/s, and `lively` the same where contacts hold what they press on.
pub(crate) fn damping(tangent: &Tangent, [omega, lively]: [f64; 2], substep: f64) -> f64 {
    let ramp =
        |omega: f64, [from, to]: [f64; 2]| ((omega * substep - from) / (to - from)).clamp(0.0, 1.0);
    let share = ramp(omega, UNRESOLVED)
        .max(SETTLING * ramp(lively, STAGGERED))
        .max(LEAST);
    tangent
        .damping
        .max(share * substep * tangent.stiffness.abs())
}

#[cfg(test)]
mod tests {
    use super::super::law::{DragLaw, Law, Recipe, SpringForce, Stop};
    use super::*;

    fn cubic() -> Law {
        let force = [0.0, 0.0, 50.0];
        Law::new(Recipe {
            spring: SpringForce::Polynomial {
                pull: force,
                push: force,
            },
            drag: DragLaw::Sided {
                bump: 2.0,
                rebound: 6.0,
            },
            preload: 0.0,
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            most: f64::INFINITY,
            travel: [f64::NEG_INFINITY, f64::INFINITY],
            stop: Stop::default(),
        })
    }

    #[test]
    fn a_chord_does_the_work_of_the_laws_energy() {
        let law = cubic();
        for [from, to] in [[1.0, 1.4], [0.7, 1.2], [1.3, 1.3], [1.0, 1.0 + 1e-9]] {
            let tangent = Tangent::chord(|length| law.elastic(length, 1.0), [from, to]);
            let stored = [from, to].map(|length| law.elastic(length, 1.0).energy);
            let missed = tangent.work([from, to]) - (stored[1] - stored[0]);
            assert!(missed.abs() < 1e-12, "{from} to {to}: {missed}");
        }
    }

    #[test]
    fn substeps_resolve_the_stiffest_mode_or_say_that_they_cannot() {
        let time = 1.0 / 60.0;
        assert_eq!(Fineness::of(10.0, 10.0, time, 16, 64).substeps, 16);
        let fine = Fineness::of(900.0, 0.0, time, 16, 64);
        assert!(900.0 * time / f64::from(fine.substeps) <= RESOLVED && !fine.capped);
        let stiff = Fineness::of(1e5, 0.0, time, 16, 64);
        assert_eq!((stiff.substeps, stiff.capped), (64, true));
        assert_eq!(Fineness::of(90.0, 90.0, time, 16, 64).substeps, 32);
        assert_eq!(Fineness::of(90.0, 90.0, time, 16, 20).substeps, 20);
        let tangent = Tangent::linear(100.0, 0.0, 1.0);
        let h = time / 64.0;
        assert!(damping(&tangent, [1e5, 0.0], h) >= h * 100.0);
        assert!(damping(&tangent, [10.0; 2], h) <= 1e-3 * h * 100.0);
    }
}
