//! Decides how many micro-steps a motion needs.

use super::line::Motion;
use super::tolerance::Least;

/// Phase per coarse step below which fourth-order extrapolation converges, rad.
pub(super) const EXTRAPOLATION_LIMIT: f64 = 1.5;

/// (ω h)² of the stiffest mode above which more micro-steps are needed to resolve it. Pinned by
/// `messages::what_cannot_be_followed_is_told_once`.
pub(super) const RESOLVED: f64 = 4.0;

/// c h/m from which a damper counts as strong. The energy of a lone element's step is then checked. A lone force law is not
/// stepped by the kick. In a network, the steeper of a law's slope and secant counts. A spring of zero rest length has an axis.
/// Pinned by `hard_cases::a_damper_passed_at_speed_only_takes_energy`.
pub(super) const STRONG: f64 = 0.5;

/// Whether a spring of zero rest length must have an axis, because its damper is strong. `z` is (ω h)² and `decay` is c h/m.
/// For a stiffer spring, its isotropic, implicit form matters more than an axis for the damper.
#[inline(always)]
pub(super) fn is_damper_stiff(z: f64, decay: f64) -> bool {
    z < RESOLVED && decay > STRONG
}

/// (ω h)² at which the micro-steps of a network follow its stiffest mode accurately. Frequencies are then right to a few
/// parts in a million. The energy oscillates so little that the oscillation does not count as an energy gain. Pinned by
/// `stiff_by_default`.
const FOLLOWED: f64 = 0.1;

/// Greatest number of micro-steps that a network of any size takes to resolve a stiff mode, whatever the settings ask
/// for.
const EXTRA_STEPS: u32 = 4;

/// Number of kicks of elements per step that a network may take to follow a mode that it resolves already. Few, because
/// the error is small then.
const FEW_KICKS: usize = 16;

/// Greatest number of micro-steps that resolve a lone element, whatever the settings ask for. It is enough for ω·dt = 64,
/// and takes a microsecond. Pinned by `stiff_by_default::a_lone_spring_keeps_its_phase_at_any_stiffness`; more only cost time.
const MOST_ALONE: u32 = 32;

/// Distance up to which kinks of a law are looked for, as a multiple of the change of length in a step.
const AHEAD: f64 = 1.25;

/// Micro-steps that resolve a lone element with (ω h)² = `z` over the whole step; one if they are more than
/// [`MOST_ALONE`]. They are so few that they do not come out of the budget of the networks, `most`, but a budget of 0
/// allows one. Resolved micro-steps are exact along the line.
pub(super) fn lone_steps(z: f64, most: u32) -> Least {
    let most = if most == 0 { 1 } else { MOST_ALONE };
    Least::of(z, within((z / RESOLVED).sqrt(), most).unwrap_or(1))
}

/// Micro-steps of a network whose stiffest mode has (ω h)² = `z` over the whole step. Returns those that follow the mode,
/// if they are at most `most` or few. Otherwise returns those that just resolve it, if they are at most [`EXTRA_STEPS`],
/// or else one.
pub(super) fn network_steps(z: f64, elements: usize, most: u32) -> Least {
    // Each network may take these few, however many elements share the budget. A budget of 0 allows one.
    let few = if most == 0 {
        1
    } else {
        (FEW_KICKS / elements.max(1)) as u32
    };
    let most = if z <= RESOLVED { few } else { most.max(few) };
    let count = within((z / FOLLOWED).sqrt(), most)
        .or_else(|| within((z / RESOLVED).sqrt(), EXTRA_STEPS))
        .unwrap_or(1);
    Least::of(z, count)
}

impl Least {
    /// `count` micro-steps for a motion with (ω h)² = `z` over the whole step.
    fn of(z: f64, count: u32) -> Self {
        Self {
            count,
            suffice: z <= RESOLVED * f64::from(count).powi(2),
        }
    }

    /// (ω h)² over one of the micro-steps, where `z` is that over the whole step.
    pub(super) fn in_each(self, z: f64) -> f64 {
        z / f64::from(self.count).powi(2)
    }
}

fn within(steps: f64, most: u32) -> Option<u32> {
    (steps <= f64::from(most)).then(|| steps.ceil().max(1.0) as u32)
}

/// Two predicted changes of length over a step, m: at the speed in the middle of the step and at the speed at its end,
/// both under the external forces.
pub(super) fn predicted_travel(motion: &Motion, time: f64) -> [f64; 2] {
    [0.5, 1.0].map(|share| AHEAD * time * (motion.axial + share * time * motion.pushed))
}
