//! The ways to take a step, their errors, and the one with the fewest kicks.

use super::Steppable;
use crate::functions::cbrt;

/// One way to take a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Plan {
    Plain(u32),
    Extrapolated(u32),
}

impl Plan {
    /// Replaces extrapolation by plain micro-steps with as many kicks where it would diverge. Plain micro-steps never
    /// diverge.
    pub(super) fn sound(self, motion: &mut impl Steppable, time: f64) -> Self {
        match self {
            Self::Extrapolated(m) if !motion.is_resolved(time / f64::from(m)) => Self::Plain(3 * m),
            plan => plan,
        }
    }
}

/// Takes a step in that way. Returns the number of kicks.
pub(super) fn take(motion: &mut impl Steppable, time: f64, plan: Plan) -> u32 {
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
pub(super) fn error_of((plain, fine): (f64, Option<f64>), order: i32, plan: Plan) -> f64 {
    match (plan, fine) {
        (Plan::Extrapolated(m), Some(fine)) => fine / f64::from(m).powi(4),
        (Plan::Plain(n) | Plan::Extrapolated(n), _) => plain / f64::from(n).powi(order),
    }
}

/// Returns the plan with the fewest kicks that keeps the tolerance, and whether the cap prevents such a plan.
pub(super) fn cheapest(
    (plain, fine): (f64, Option<f64>),
    order: i32,
    tolerance: f64,
    [least, most]: [u32; 2],
) -> (Plan, bool) {
    let wanted = |ratio: f64| (ratio.ceil().min(1e6) as u32).max(least);
    let ratio = plain / tolerance;
    let n = wanted(match order {
        2 => ratio.sqrt(),
        3 => cbrt(ratio),
        _ => ratio.sqrt().sqrt(),
    });
    let extrapolated = fine.map(|fine| wanted((fine / tolerance).sqrt().sqrt()));
    match extrapolated {
        Some(m) if 3 * m < n => (
            Plan::Extrapolated(m.min((most / 3).max(1))),
            m > (most / 3).max(1),
        ),
        _ => (Plan::Plain(n.min(most)), n > most),
    }
}
