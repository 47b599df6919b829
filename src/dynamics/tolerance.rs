//! How finely to step: a fixed count, or as finely as a tolerance asks.
//!
//! Plain micro-steps have an error C₂/n², the combination of m and 2m an error C₄/m⁴ for 3m kicks. Now and
//! then a step is taken with m, 2m and 4m, which tells both; between, the cheaper of the two that keeps the
//! tolerance is taken. The probing step itself keeps its most exact result.

use super::excited::Excited;

/// What is asked of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accuracy {
    pub microsteps: u32,
    /// Most micro-steps that are taken instead to follow a motion, where it needs more; 0 for as many as are asked.
    pub resolve: u32,
    pub extrapolate: bool,
    /// Error of position that may be added, m per simulated second; then the two above do not count.
    pub tolerance: Option<f64>,
    pub max_microsteps: u32,
    /// Most iterations of one solve of a large network.
    pub max_iterations: u32,
}

impl Accuracy {
    /// So many micro-steps and no more, as tests ask for them.
    #[cfg(test)]
    pub(crate) fn exactly(microsteps: u32) -> Self {
        Self {
            microsteps,
            resolve: 0,
            extrapolate: false,
            tolerance: None,
            max_microsteps: 256,
            max_iterations: 200,
        }
    }

    /// So many micro-steps, or as many as the cap lets, and whether it keeps a step from those.
    pub(super) fn cap(&self, asked: u32) -> (u32, bool) {
        let count = asked.min(self.most());
        (count, count < asked)
    }

    fn most(&self) -> u32 {
        self.max_microsteps.max(1)
    }

    /// For each of so many elements in networks, which share what may be taken to follow them.
    pub(crate) fn shared(self, elements: usize) -> Self {
        let share = self.resolve / u32::try_from(elements.max(1)).unwrap_or(u32::MAX);
        Self {
            resolve: share.max(self.resolve.min(1)),
            ..self
        }
    }

    /// How many times as finely as by default an engine is to solve what it solves itself.
    pub(crate) fn fineness(&self) -> u32 {
        let more = if self.extrapolate { 2 } else { 1 };
        self.cap(self.microsteps.max(1)).0.saturating_mul(more)
    }

    /// Micro-steps of every step alike, if that is all that is asked.
    pub(crate) fn plain(&self) -> Option<u32> {
        let plain = self.tolerance.is_none() && !self.extrapolate;
        plain.then(|| self.cap(self.microsteps.max(1)).0)
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

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    pub method: Method,
    /// Kicks made.
    pub microsteps: u32,
    /// Estimate of the error of position that the step added, m.
    pub error: Option<f64>,
    /// A cap kept the step from being as fine or as exact as was asked.
    pub capped: bool,
    /// Its stiffest motion was to be followed, and that would have taken more micro-steps than may be.
    pub unresolved: bool,
}

impl Outcome {
    /// Of plain micro-steps.
    pub(crate) fn plain(accuracy: &Accuracy) -> Self {
        let (microsteps, capped) = accuracy.cap(accuracy.microsteps.max(1));
        Self {
            microsteps,
            capped,
            ..Self::default()
        }
    }
}

/// Micro-steps that a motion needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Least {
    pub count: u32,
    /// They resolve it.
    pub suffice: bool,
}

/// A motion that can be run over the step again and again, from copies of its state.
pub(crate) trait Motion {
    /// Copies the state into a slot, of three.
    fn save(&mut self, slot: usize);
    /// Takes it back.
    fn load(&mut self, slot: usize);
    /// Micro-steps that resolve it, if they are not more than `most`; else those that it needs in any case.
    fn least(&mut self, time: f64, most: u32) -> Least;
    /// Runs over the step in so many micro-steps.
    fn run(&mut self, time: f64, count: u32);
    /// Distance to the state in a slot, m.
    fn distance(&self, slot: usize) -> f64;
    /// How far bodies have gone against each other since the state in a slot, m, and what they have gained in speed counted
    /// as in [`Self::distance`].
    fn travelled(&self, slot: usize) -> f64;
    /// Adds a third of the difference to the state in a slot: removes the leading error of one with half
    /// as many steps, since only even powers of the step occur.
    fn extrapolate(&mut self, slot: usize);
    /// Whether a micro-step of so long resolves the motion, so that extrapolation converges.
    fn is_resolved(&mut self, step: f64) -> bool;
}

/// Time over which a velocity that is wrong becomes a position that is wrong, s.
pub(crate) const VELOCITY_COUNTS: f64 = 0.15;

/// Time over which wrong velocities become wrong positions, s, where springs turn them back. `motion` is their kinetic
/// energy, J; `stiffened` is what springs take of it over the square of time, J/s². What swings back within a period counts
/// no longer than that, by Rayleigh's quotient of the two.
pub(crate) fn velocity_counts(motion: f64, stiffened: f64) -> f64 {
    // NaN where nothing is wrong; the sum of nothing is −0.
    let omega = (stiffened / motion).abs().sqrt();
    VELOCITY_COUNTS.min(omega.recip())
}

/// Steps from probe to probe, where little is needed and elsewhere.
const CALM: u32 = 24;
const BUSY: u32 = 8;

/// Growth of the error from probe to probe above which the next comes sooner.
const GROWTH: f64 = 2.0;

/// Memory of a motion's errors.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Controller {
    /// Error constants, m/s: plain, and of the combination where that is valid,
    known: Option<(f64, Option<f64>)>,
    /// in steps of so long, s.
    step: f64,
    /// Steps until the next probe.
    age: u32,
    /// Probes in a row that found little to do.
    calm: u32,
    /// Steps from the last probe to the next.
    span: u32,
    excited: Excited,
}

/// One way to take a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plan {
    Plain(u32),
    Extrapolated(u32),
}

impl Plan {
    /// As many kicks, but all of them plain micro-steps, which never diverge, where extrapolation would.
    fn sound(self, motion: &mut impl Motion, time: f64) -> Self {
        match self {
            Self::Extrapolated(m) if !motion.is_resolved(time / f64::from(m)) => Self::Plain(3 * m),
            plan => plan,
        }
    }
}

impl Controller {
    /// Takes a motion through a step.
    pub(crate) fn drive(
        &mut self,
        motion: &mut impl Motion,
        time: f64,
        accuracy: Accuracy,
    ) -> Outcome {
        let Some(tolerance) = accuracy.tolerance else {
            return self.fixed(motion, time, accuracy);
        };
        let most = accuracy.most();
        // How fine it has to be is found out.
        let (least, cut) = accuracy.cap(motion.least(time, 0).count);
        self.scale_to(time);
        let mut outcome = match self.known.filter(|_| self.age > 0) {
            Some(known) => {
                self.age -= 1;
                let (plan, capped) = cheapest(known, tolerance, [least, most]);
                // It can have become another motion since the probe.
                let plan = plan.sound(motion, time);
                Outcome {
                    microsteps: take(motion, time, plan),
                    error: Some(time * error_of(known, plan)),
                    capped,
                    ..Outcome::default()
                }
            }
            None => self.probe(motion, time, tolerance, [least, most]),
        };
        outcome.capped |= cut;
        outcome
    }

    /// Has its constants hold for steps of another length: they rise with the power of it that they fall with of the count.
    fn scale_to(&mut self, time: f64) {
        let ratio = time / std::mem::replace(&mut self.step, time);
        if let Some((plain, fine)) = self.known.as_mut().filter(|_| ratio != 1.0) {
            *plain *= ratio.powi(2);
            if let Some(fine) = fine {
                *fine *= ratio.powi(4);
            }
        }
    }

    /// Takes the step with three counts and learns from it.
    fn probe(
        &mut self,
        motion: &mut impl Motion,
        time: f64,
        tolerance: f64,
        [least, most]: [u32; 2],
    ) -> Outcome {
        let before = self.known;
        let m = before.map_or(least, |known| {
            match cheapest(known, tolerance, [least, most]).0 {
                Plan::Plain(n) => (n / 4).max(least),
                Plan::Extrapolated(m) => (m / 2).max(least),
            }
        });
        motion.save(0);
        motion.run(time, m);
        motion.save(1);
        motion.load(0);
        motion.run(time, 2 * m);
        let mut kicks = 3 * m;
        let count = f64::from(m);
        let plain = 4.0 / 3.0 * motion.distance(1) * count * count / time;
        // The combination costs three times the least: nothing is to be learnt where that many plain ones do.
        let cheap = plain <= tolerance * f64::from(3 * least).powi(2);
        if cheap || !motion.is_resolved(time / count) {
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
        let (plan, capped) = cheapest(known, tolerance, [least, most]);
        let calm = plan == Plan::Plain(least) && error_of(known, plan) < 0.25 * tolerance;
        let grows = known.0 > GROWTH * before.map_or(0.0, |known| known.0);
        self.put_off(grows, calm);
        let taken = match known.1 {
            Some(_) => Plan::Extrapolated(2 * m),
            None => Plan::Plain(2 * m),
        };
        let mut error = error_of(known, taken);
        if error > tolerance && taken != plan {
            // Not fine enough even so.
            motion.load(0);
            kicks += take(motion, time, plan);
            error = error_of(known, plan);
        }
        Outcome {
            microsteps: kicks,
            error: Some(time * error),
            capped: capped && error > tolerance,
            ..Outcome::default()
        }
    }

    /// Until when the next probe can wait: the sooner, the more the error grows.
    fn put_off(&mut self, grows: bool, calm: bool) {
        self.span = if grows {
            (self.span / 2).max(1)
        } else {
            (2 * self.span).min(BUSY)
        };
        self.calm = if calm { self.calm + 1 } else { 0 };
        self.age = if self.calm > 2 { CALM } else { self.span };
    }

    /// As many micro-steps as are asked for, or those that follow what moves.
    fn fixed(&mut self, motion: &mut impl Motion, time: f64, accuracy: Accuracy) -> Outcome {
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

fn take(motion: &mut impl Motion, time: f64, plan: Plan) -> u32 {
    match plan {
        Plan::Plain(n) => {
            motion.run(time, n);
            n
        }
        Plan::Extrapolated(m) => {
            motion.save(0);
            motion.run(time, m);
            motion.save(1);
            motion.load(0);
            motion.run(time, 2 * m);
            motion.extrapolate(1);
            3 * m
        }
    }
}

/// Error of a plan, m/s.
fn error_of((plain, fine): (f64, Option<f64>), plan: Plan) -> f64 {
    match (plan, fine) {
        (Plan::Extrapolated(m), Some(fine)) => fine / f64::from(m).powi(4),
        (Plan::Plain(n) | Plan::Extrapolated(n), _) => plain / f64::from(n).powi(2),
    }
}

/// The plan with the fewest kicks that keeps the tolerance, and whether the cap kept it from doing so.
fn cheapest(
    (plain, fine): (f64, Option<f64>),
    tolerance: f64,
    [least, most]: [u32; 2],
) -> (Plan, bool) {
    let wanted = |ratio: f64| (ratio.ceil().min(1e6) as u32).max(least);
    let n = wanted((plain / tolerance).sqrt());
    let extrapolated = fine.map(|fine| wanted((fine / tolerance).sqrt().sqrt()));
    match extrapolated {
        Some(m) if 3 * m < n => (
            Plan::Extrapolated(m.min((most / 3).max(1))),
            m > (most / 3).max(1),
        ),
        _ => (Plan::Plain(n.min(most)), n > most),
    }
}

#[cfg(test)]
mod tests;
