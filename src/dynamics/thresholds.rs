//! Numbers above which a step does not resolve what moves, or must be watched.

use super::poles::RESOLVED_PHASE;

/// Phase per coarse step below which fourth-order extrapolation converges, rad. Pinned by
/// `dynamics::tests::elastic_pendulum_follows_the_reference_at_each_setting`.
const EXTRAPOLATION_LIMIT: f64 = 1.5;

/// ω h of the stiffest mode above which more micro-steps are needed to resolve it: the stability limit of an explicit step. Pinned by
/// `messages::what_cannot_be_followed_is_told_once`.
pub(crate) const MOST_PHASE: f64 = 2.0;

/// (ω h)² of the stiffest mode above which more micro-steps are needed to resolve it.
pub(super) const RESOLVED: f64 = MOST_PHASE * MOST_PHASE;

/// c h/m from which a damper counts as strong. A lone element's step may then gain no energy at all. A lone force law is not
/// stepped by the kick. In a network, the steeper of a law's slope and secant counts. A spring of zero rest length has an axis.
/// Pinned by `hard_cases::a_damper_passed_at_speed_only_takes_energy`.
pub(super) const STRONG: f64 = 0.5;

/// Change of a length, as a share of the lengths, up to which a difference quotient of energies would be rounding: about the root of
/// the rounding of f64. No tuning constant.
pub(super) const SHORT: f64 = 1e-7;

/// Gain of energy that is not removed, as a share of the energy: it may be rounding, which is a thousandth of that. Pinned by
/// `hard_cases::a_damper_passed_at_speed_only_takes_energy`.
pub(super) const ROUNDED_GAIN: f64 = 1e-9;

/// Whether a spring of zero rest length must have an axis, because its damper is strong. `z` is (ω h)² and `decay` is c h/m.
/// For a stiffer spring, its isotropic, implicit form matters more than an axis for the damper.
#[inline(always)]
pub(super) fn is_damper_stiff(z: f64, decay: f64) -> bool {
    z < RESOLVED && decay > STRONG
}

/// Whether a lone element needs more than the plain kick: its oscillation is not resolved, or its damper is strong. `z` is
/// (ω h)² and `decay` is c h/m.
pub(super) fn is_special(z: f64, decay: f64) -> bool {
    decay >= STRONG || !is_resolved(z)
}

/// Whether extrapolation converges for coarse micro-steps with (ω h)² = `z` and c h/m = `decay`.
pub(super) fn converges(z: f64, decay: f64) -> bool {
    z < EXTRAPOLATION_LIMIT * EXTRAPOLATION_LIMIT && decay < EXTRAPOLATION_LIMIT
}

/// Whether the frequency of a step with (ω h)² = `z` is exact.
pub(super) fn is_resolved(z: f64) -> bool {
    z < RESOLVED_PHASE * RESOLVED_PHASE
}
