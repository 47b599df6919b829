//! Turns an element into a soft constraint of an engine's solver, for elements on bodies that contacts or joints hold.
//!
//! A force that is computed before the engine's step cannot react to contacts and joints. So the engine itself solves an
//! element on a held body, together with the contacts and joints. In every solver substep h the element acts with
//!
//! ```text
//! F = force + stiffness·(s − at) + damping·ṡ
//! ```
//!
//! where s is the length at the start of the substep and ṡ its rate at the end. This is the symplectic Euler rule for the
//! spring, which conserves energy while ω h < 2, and implicit damping, which only removes energy. [`super::pieces`] makes
//! a force law linear anew for every step, so that its mean force does the work of its energy. A remaining energy error
//! is corrected in the next step.

use super::law::Elastic;
use super::thresholds::SHORT;
use super::tolerance::{Method, Outcome};

/// ω h that the number of substeps aims at for the stiffest mode: a quarter of the stability limit of the symplectic
/// rule. Pinned by `ground::nets` and `ground::bridge`.
const RESOLVED: f64 = 0.5;

/// ω h above which damping is added, and ω h at which it reaches that of the implicit Euler rule. This is the last resort
/// if even the greatest number of substeps does not resolve a mode. Pinned by `ground::nets`.
const UNRESOLVED: [f64; 2] = [1.5, 2.0];

/// ω h that the number of substeps aims at for elements without enough damping of their own, so that they conserve
/// energy. Pinned by `ground::hinge`.
const KEPT: f64 = 0.05;
/// Greatest number of substeps that are taken to reach [`KEPT`]. Pinned by `ground::hinge`.
const WORTH: u32 = 32;

/// ω h above which damping is added, and ω h at which it reaches [`SETTLING`]. Velocities at the end of a step are half a
/// substep off from the positions there. Above this ω h, the energy of such a state would seem to rise and fall. Pinned
/// by `ground::hinge`.
const STAGGERED: [f64; 2] = [0.05, 0.1];
/// Greatest damping that is added for [`STAGGERED`], as a share of that of the implicit Euler rule. Pinned by
/// `ground::hinge`.
const SETTLING: f64 = 0.25;

/// Least damping, as a share of h·stiffness. The engine divides by the damping, so it must not be zero. The resulting
/// damping ratio of ω h / 4000 costs an undamped door 0.1 % of its amplitude in eight seconds. Pinned by
/// `joints::a_door_on_its_hinge_swings_as_a_spring_in_tension_makes_it`.
const LEAST: f64 = 5e-4;

/// A force over one step that is linear in a length and its rate. For a torsion element, angles take the place of
/// lengths, and torques take the place of forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tangent {
    /// Tension at the length `at` without damping, N.
    pub force: f64,
    /// Reference length, m.
    pub at: f64,
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N s/m; not negative.
    pub damping: f64,
}

impl Tangent {
    /// Whether its damping is less than what [`SETTLING`] adds in substeps of `substep` seconds.
    pub(crate) fn is_undamped(&self, substep: f64) -> bool {
        self.damping < SETTLING * substep * self.stiffness
    }

    /// The force multiplied by `share`.
    pub(crate) fn times(self, share: f64) -> Self {
        Self {
            force: share * self.force,
            at: self.at,
            stiffness: share * self.stiffness,
            damping: share * self.damping,
        }
    }

    /// The force of a linear element.
    pub(crate) const fn linear(stiffness: f64, damping: f64, rest_length: f64) -> Self {
        Self {
            force: 0.0,
            at: rest_length,
            stiffness,
            damping,
        }
    }

    /// Linearises a force between two lengths as a chord. Its work between them equals the change of the force's energy.
    pub(super) fn chord(force: impl Fn(f64) -> Elastic, [from, to]: [f64; 2]) -> Self {
        let [first, last] = [from, to].map(&force);
        let middle = 0.5 * (from + to);
        let way = to - from;
        let size = from.abs() + to.abs();
        Self {
            force: if way.abs() > SHORT * size {
                (last.energy - first.energy) / way
            } else {
                force(middle).force
            },
            at: middle,
            stiffness: if way.abs() > 10.0 * SHORT * size {
                (last.force - first.force) / way
            } else {
                first.stiffness
            },
            damping: 0.0,
        }
    }

    /// Tension without damping at a length, N.
    pub(crate) fn elastic(&self, length: f64) -> f64 {
        self.force + self.stiffness * (length - self.at)
    }

    /// Integral of the tension without damping between two lengths, J: the energy that the bodies lose.
    pub(crate) fn work(&self, [from, to]: [f64; 2]) -> f64 {
        (to - from) * self.elastic(0.5 * (from + to))
    }
}

/// How finely an engine must solve a component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fineness {
    /// Number of solver substeps in the time of the step.
    pub substeps: u32,
    /// Whether a mode is not resolved even with these substeps.
    pub capped: bool,
}

impl Fineness {
    /// Chooses the substeps of a step of `time` seconds, from `least` to `most`. `omega` is an upper bound on the
    /// stiffest mode, and `undamped` that on the stiffest mode of elements without enough damping, rad/s.
    pub(crate) fn of(omega: f64, undamped: f64, time: f64, least: u32, most: u32) -> Self {
        // Multiples of 8, so that a little more stiffness does not require a new set-up of all joints.
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
    /// Outcome that is reported for a step in `substeps` substeps.
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

/// Rises from 0 to 1 between two numbers.
pub(crate) fn ramp(number: f64, [from, to]: [f64; 2]) -> f64 {
    ((number - from) / (to - from)).clamp(0.0, 1.0)
}

/// Damping with which an element must act in substeps of `substep` seconds, N s/m. `omega` is an upper bound on the
/// stiffest mode in which the element takes part, and `lively` that bound if bodies under contact pressure do not move,
/// rad/s.
pub(crate) fn damping(tangent: &Tangent, [omega, lively]: [f64; 2], substep: f64) -> f64 {
    let share = ramp(omega * substep, UNRESOLVED)
        .max(SETTLING * ramp(lively * substep, STAGGERED))
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
