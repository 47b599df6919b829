//! Chooses the number of micro-steps: a fixed count, or as many as a tolerance requires.
//!
//! The error of n plain micro-steps is C₂/n². Extrapolation from m and 2m micro-steps has the error C₄/m⁴ and takes 3m
//! kicks. Now and then a probe takes the step with m, 2m and 4m micro-steps, which gives both constants. Between probes,
//! the cheaper plan that keeps the tolerance is used. The probe itself keeps its most exact result. Motions of higher order
//! need no extrapolation: their error is C₃/n³ or C₄/n⁴.

mod plan;

use super::excited::Excited;
use plan::{Plan, cheapest, error_of, take};

/// Accuracy that is asked of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accuracy {
    pub microsteps: u32,
    /// Greatest number of micro-steps to follow a motion that needs more than `microsteps`; 0 for no such budget. Even
    /// then a network takes a few more to resolve a stiff mode.
    pub resolve: u32,
    pub extrapolate: bool,
    /// Position error that may be added, m per simulated second. If it is set, it determines the number of micro-steps
    /// instead of the fields above.
    pub tolerance: Option<f64>,
    pub max_microsteps: u32,
    /// Greatest number of iterations in one solve of a large network.
    pub max_iterations: u32,
}

impl Accuracy {
    /// `microsteps` micro-steps without a budget for more, for tests.
    #[cfg(test)]
    pub(crate) fn exactly(microsteps: u32) -> Self {
        Self {
            microsteps,
            resolve: 0,
            extrapolate: false,
            tolerance: None,
            max_microsteps: crate::settings::MAX_MICROSTEPS,
            max_iterations: crate::settings::MAX_ITERATIONS,
        }
    }

    /// Returns `asked` or the cap, whichever is less, and whether the cap was less.
    pub(super) fn cap(&self, asked: u32) -> (u32, bool) {
        let count = asked.min(self.most());
        (count, count < asked)
    }

    fn most(&self) -> u32 {
        self.max_microsteps.max(1)
    }

    /// The accuracy for networks that have `elements` elements together and share the budget `resolve`.
    pub(crate) fn shared(self, elements: usize) -> Self {
        let share = self.resolve / u32::try_from(elements.max(1)).unwrap_or(u32::MAX);
        Self {
            resolve: share.max(self.resolve.min(1)),
            ..self
        }
    }

    /// Factor by which an engine must solve held components more finely than by default.
    pub(crate) fn fineness(&self) -> u32 {
        let more = if self.extrapolate { 2 } else { 1 };
        self.cap(self.microsteps.max(1)).0.saturating_mul(more)
    }

    /// The number of micro-steps of every step, if no tolerance chooses it. Extrapolation takes twice as many besides.
    pub(crate) fn fixed(&self) -> Option<u32> {
        self.tolerance
            .is_none()
            .then(|| self.cap(self.microsteps.max(1)).0)
    }
}

/// How a component was solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Method {
    #[default]
    None,
    ClosedForm,
    Direct,
    Iterative,
    Engine,
}

/// Cost and accuracy of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    pub method: Method,
    /// Number of kicks.
    pub microsteps: u32,
    /// Estimated position error that the step added, m.
    pub error: Option<f64>,
    /// Whether a cap kept the step from being as fine or as exact as asked.
    pub capped: bool,
    /// Whether the stiffest motion should have been resolved but needs more micro-steps than allowed.
    pub unresolved: bool,
}

impl Outcome {
    /// Outcome of a fixed number of micro-steps.
    pub(crate) fn fixed(accuracy: &Accuracy) -> Self {
        let (count, capped) = accuracy.cap(accuracy.microsteps.max(1));
        Self {
            microsteps: if accuracy.extrapolate {
                3 * count
            } else {
                count
            },
            capped,
            ..Self::default()
        }
    }
}

/// Number of micro-steps that a motion needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Least {
    pub count: u32,
    /// Whether they resolve the motion.
    pub suffice: bool,
}

/// A motion that can be repeated over a step from saved states.
pub(crate) trait Steppable {
    /// Saves the state in one of three slots.
    fn save(&mut self, slot: usize);
    /// Restores the state from a slot.
    fn load(&mut self, slot: usize);
    /// Micro-steps that resolve the motion, if they are at most `most`; otherwise those that it needs in any case.
    fn least(&mut self, time: f64, most: u32) -> Least;
    /// Advances by `time` seconds in `count` micro-steps.
    fn run(&mut self, time: f64, count: u32);
    /// Distance to the state in a slot, m. Velocity differences count over a time; see [`velocity_counts`].
    fn distance(&self, slot: usize) -> f64;
    /// Distance that bodies have moved relative to each other since the state in a slot, m. Changes of velocity count as
    /// in [`Self::distance`].
    fn travelled(&self, slot: usize) -> f64;
    /// Removes the leading error by the difference from the state in a slot, which was reached with half as many micro-steps.
    /// A third of it is added where the error is of second order, with only even powers of the step.
    fn extrapolate(&mut self, slot: usize);
    /// Power of the number of micro-steps with which the error of plain ones falls: 2, 3 or 4.
    fn order(&self) -> i32 {
        2
    }
    /// Whether a micro-step of `step` seconds resolves the motion, so that extrapolation converges.
    fn is_resolved(&mut self, step: f64) -> bool;
}

/// Time over which a velocity error becomes a position error, s. Pinned by
/// `tolerance::the_error_of_the_first_second_is_near_the_tolerance`.
pub(crate) const VELOCITY_COUNTS: f64 = 0.15;

/// Time over which velocity errors become position errors where springs reverse them, s. `motion` is the sum of mass ·
/// error², and `stiffened` is the sum of stiffness · (relative error along the element)². Rayleigh's quotient of the two
/// is ω². An error counts no longer than 1/ω, because it reverses within a period.
pub(crate) fn velocity_counts(motion: f64, stiffened: f64) -> f64 {
    // Without errors the quotient is NaN, which `min` ignores. The sum of no terms is −0, hence `abs`.
    let omega = (stiffened / motion).abs().sqrt();
    VELOCITY_COUNTS.min(omega.recip())
}

/// Number of steps between probes while the fewest micro-steps are enough. Pinned by
/// `tolerance::tests::the_tolerance_is_kept_with_few_kicks`.
const CALM: u32 = 24;
/// Greatest number of steps between probes otherwise. Pinned by `tolerance::tests::a_motion_that_becomes_wild_is_probed_sooner`.
const BUSY: u32 = 8;

/// Growth of the error between two probes above which the next probe comes sooner. Pinned by
/// `tolerance::tests::a_motion_that_becomes_wild_is_probed_sooner`.
const GROWTH: f64 = 2.0;

/// Error of the fewest micro-steps below which a motion counts as calm, as a share of the tolerance, and number of probes in a row after
/// which it is believed. Pinned by `tolerance::tests::the_tolerance_is_kept_with_few_kicks`.
const CALM_ERROR: f64 = 0.25;
const CALM_PROBES: u32 = 2;

/// Memory of a motion's errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Controller {
    /// Error constants in steps of length `step`, m/s: of plain micro-steps, and of extrapolation where it converges and these
    /// are of second order.
    known: Option<(f64, Option<f64>)>,
    /// Length of the step to which `known` applies, s.
    step: f64,
    /// Number of steps until the next probe.
    age: u32,
    /// Number of probes in a row for which the fewest micro-steps were enough.
    calm: u32,
    /// Number of steps from the last probe to the next.
    span: u32,
    excited: Excited,
}

impl Controller {
    /// Advances a motion by one step.
    pub(crate) fn drive(
        &mut self,
        motion: &mut impl Steppable,
        time: f64,
        accuracy: Accuracy,
    ) -> Outcome {
        let Some(tolerance) = accuracy.tolerance else {
            return self.fixed(motion, time, accuracy);
        };
        let most = accuracy.most();
        // The budget is 0 here, because the error decides how fine the steps must be.
        let (least, cut) = accuracy.cap(motion.least(time, 0).count);
        let order = motion.order();
        self.scale_to(time, order);
        let mut outcome = match self.known.filter(|_| self.age > 0) {
            Some(known) => {
                // A forged number must not put the next probe off for ever.
                self.age = (self.age - 1).min(CALM);
                let (plan, capped) = cheapest(known, order, tolerance, [least, most]);
                // The motion may have changed since the probe.
                let plan = plan.sound(motion, time);
                Outcome {
                    microsteps: take(motion, time, plan),
                    error: Some(time * error_of(known, order, plan)),
                    capped,
                    ..Outcome::default()
                }
            }
            None => self.probe(motion, time, tolerance, [least, most]),
        };
        outcome.capped |= cut;
        outcome
    }

    /// Converts the error constants to steps of another length. They grow with the power of the length with which the
    /// errors fall with the number of micro-steps.
    fn scale_to(&mut self, time: f64, order: i32) {
        let ratio = time / std::mem::replace(&mut self.step, time);
        if let Some((plain, fine)) = self.known.as_mut().filter(|_| ratio != 1.0) {
            *plain *= ratio.powi(order);
            if let Some(fine) = fine {
                *fine *= ratio.powi(4);
            }
        }
    }

    /// Takes the step with up to three numbers of micro-steps, and computes the error constants from the differences.
    fn probe(
        &mut self,
        motion: &mut impl Steppable,
        time: f64,
        tolerance: f64,
        [least, most]: [u32; 2],
    ) -> Outcome {
        let (before, order) = (self.known, motion.order());
        let plan = before.map(|known| cheapest(known, order, tolerance, [least, most]).0);
        let m = match plan {
            None => least,
            Some(Plan::Plain(n)) => (n / 4).max(least),
            Some(Plan::Extrapolated(m)) => (m / 2).max(least),
        };
        motion.save(0);
        motion.run(time, m);
        motion.save(1);
        motion.load(0);
        motion.run(time, 2 * m);
        let mut kicks = 3 * m;
        let count = f64::from(m);
        let times = 2_f64.powi(order);
        let apart = times / (times - 1.0) * motion.distance(1);
        let plain = apart * count.powi(order) / time;
        // Extrapolation takes at least 3·`least` kicks. Its error is not measured where as many plain micro-steps are
        // enough.
        let cheap = plain <= tolerance * f64::from(3 * least).powi(2);
        if cheap || order > 2 || !motion.is_resolved(time / count) {
            self.known = Some((plain, None));
        } else {
            motion.save(2);
            motion.extrapolate(1);
            motion.save(1);
            motion.load(0);
            motion.run(time, 4 * m);
            kicks += 4 * m;
            motion.extrapolate(2);
            let fine = 16.0 / 15.0 * motion.distance(1) * count.powi(4) / time;
            self.known = Some((plain, Some(fine)));
        }
        let known = self.known.unwrap_or_default();
        let (plan, capped) = cheapest(known, order, tolerance, [least, most]);
        let calm =
            plan == Plan::Plain(least) && error_of(known, order, plan) < CALM_ERROR * tolerance;
        let grows = known.0 > GROWTH * before.map_or(0.0, |known| known.0);
        self.put_off(grows, calm);
        let taken = match known.1 {
            Some(_) => Plan::Extrapolated(2 * m),
            None => Plan::Plain(2 * m),
        };
        let mut error = error_of(known, order, taken);
        if error > tolerance && taken != plan {
            // Even the most exact result of the probe is not good enough.
            motion.load(0);
            kicks += take(motion, time, plan);
            error = error_of(known, order, plan);
        }
        Outcome {
            microsteps: kicks,
            error: Some(time * error),
            capped: capped && error > tolerance,
            ..Outcome::default()
        }
    }

    /// Sets when the next probe comes: sooner if the error grows.
    fn put_off(&mut self, grows: bool, calm: bool) {
        self.span = if grows {
            (self.span / 2).max(1)
        } else {
            self.span.saturating_mul(2).min(BUSY)
        };
        self.calm = if calm { self.calm.saturating_add(1) } else { 0 };
        self.age = if self.calm > CALM_PROBES {
            CALM
        } else {
            self.span
        };
    }

    /// Takes as many micro-steps as asked, or more to follow the motion.
    fn fixed(&mut self, motion: &mut impl Steppable, time: f64, accuracy: Accuracy) -> Outcome {
        let asked = accuracy.microsteps.max(1);
        let least = motion.least(time, accuracy.resolve);
        let (count, capped) = accuracy.cap(asked.max(least.count));
        let microsteps = if accuracy.extrapolate {
            let plan = Plan::Extrapolated(count).sound(motion, time);
            take(motion, time, plan)
        } else {
            self.excited.run(motion, time, [asked.min(count), count])
        };
        Outcome {
            microsteps,
            capped,
            unresolved: accuracy.resolve > 0 && !least.suffice,
            ..Outcome::default()
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
