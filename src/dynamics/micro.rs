//! Decides whether a lone element can be solved beside others in [`super::lanes`].

use super::kick::Memo;
use super::pair::stiffness_number;
use super::poles::Poles;
use super::thresholds::{RESOLVED, converges, is_special};

/// Micro-steps of a lone element that [`super::lanes`] may solve.
#[derive(Clone, Copy)]
pub(crate) struct Micro {
    /// Duration, s.
    pub step: f64,
    /// Whether the element may take more of them if these do not resolve it.
    pub may_resolve: bool,
    /// Whether the step is extrapolated from these and twice as many.
    pub extrapolates: bool,
}

impl Micro {
    /// Returns the poles of an element for these micro-steps if [`super::lanes`] can solve it, and those for half of them if the
    /// step is extrapolated. Its energy must need no check. It must also need no finer micro-steps, unless it may not take
    /// them. The rest length must be above zero. `memos` are those of these micro-steps and of half of them.
    #[inline(always)]
    pub(crate) fn poles(
        &self,
        [stiffness, damping]: [f64; 2],
        inverse_mass: f64,
        memos: [&mut Memo; 2],
    ) -> Option<[Poles; 2]> {
        let [coarse, fine] = memos;
        let numbers = |step: f64| {
            let decay = damping * inverse_mass * step;
            (stiffness_number(stiffness, inverse_mass, step), decay)
        };
        let (z, decay) = numbers(self.step);
        let finer = self.may_resolve && z > RESOLVED;
        if finer || is_special(z, decay) || self.extrapolates && !converges(z, decay) {
            return None;
        }
        let poles = coarse.poles(z, decay / 2.0);
        let half = self.extrapolates.then(|| {
            let (z, decay) = numbers(0.5 * self.step);
            fine.poles(z, decay / 2.0)
        });
        Some([poles, half.unwrap_or(poles)])
    }
}
