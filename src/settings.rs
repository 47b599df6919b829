//! Settings that a game can change.

use crate::dynamics::tolerance::Accuracy;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// Default of [`CoiloverSettings::resolve`], the most kicks per step of all stiff networks together: about half a millisecond.
/// Pinned by `stiff_by_default::a_heavy_body_behind_a_light_one_keeps_its_phase`.
pub(crate) const RESOLVE: u32 = 1024;

/// Default of [`CoiloverSettings::max_microsteps`]: for one element, about a tenth of a millisecond. Pinned by
/// `tolerance::tests::any_number_of_microsteps_keeps_below_the_cap`.
pub(crate) const MAX_MICROSTEPS: u32 = 256;

/// Default of [`CoiloverSettings::max_iterations`]. It bounds the time of a solve that converges slowly. Pinned by
/// `network::tests::a_stiff_net_under_a_heavy_body_needs_more_than_half_of_the_iterations_that_it_may_take`.
pub(crate) const MAX_ITERATIONS: u32 = 200;

/// Default of [`CoiloverSettings::max_substeps`]. It is enough for modes up to ω·dt = 96: stiffer ones are damped. Pinned by
/// `quarter_car::sag_and_motion_are_those_of_the_chassis_on_a_fixed_base`.
pub(crate) const MAX_SUBSTEPS: u32 = 64;

/// How the plugin runs. The public fields may be changed at any time.
#[derive(Resource, Clone, Copy, Debug)]
pub struct CoiloverSettings {
    /// Number of micro-steps per engine step, at least 1. In each micro-step, every element gives its bodies one push,
    /// a *kick*. Where contacts or joints hold a body, this multiplies the least number of solver substeps, 16.
    pub microsteps: u32,
    /// Most kicks that all networks together may take in one step to follow springs that are too stiff for
    /// `microsteps`. A kick of one element takes 0.3 to 0.5 µs, so this is a time budget. 1 switches this off, also for
    /// lone elements.
    ///
    /// To be followed, a network needs at least three times its stiffest ω·dt micro-steps, each with one kick of every
    /// element. If the budget is too small for that, the network takes `microsteps`, or up to 4 where these resolve its
    /// stiffest mode, and up to 16 after a step that gained energy. It is then stable, but the phase of the stiff
    /// motion is wrong. A lone element takes ω·dt/2 micro-steps, up to 32, whatever the budget. With a `tolerance`,
    /// this setting does not choose the micro-steps.
    pub resolve: u32,
    /// Extrapolation: a step is taken with n and with 2n micro-steps, and the two results are combined so that the error is of
    /// fourth order. (A lone element between the centres of two bodies has this order anyway.)
    /// Where the motion is not resolved, the step is taken with 3n plain micro-steps instead. Where contacts or joints
    /// hold a body, this doubles the least number of solver substeps.
    pub extrapolation: bool,
    /// Position error that may be added, m per simulated second; `None` for a fixed number of micro-steps. Each network
    /// then takes as many micro-steps in each step as its own error requires, and `microsteps`, `resolve` and
    /// `extrapolation` do not choose them. It has no effect where contacts or joints hold a body.
    pub tolerance: Option<f32>,
    /// Most micro-steps of one engine step, at least 1. Where more are needed,
    /// [`SpringReadout::capped`](crate::SpringReadout::capped) is set.
    pub max_microsteps: u32,
    /// Most iterations of one linear solve of a large network, at least 1. Where more are needed,
    /// [`SpringReadout::capped`](crate::SpringReadout::capped) is set.
    pub max_iterations: u32,
    /// Most solver substeps per engine step that elements request where contacts or joints hold one of their bodies, at
    /// least 1. Where more are needed, [`SpringReadout::capped`](crate::SpringReadout::capped) is set.
    pub max_substeps: u32,
    pub(crate) schedule: Interned<dyn ScheduleLabel>,
}

impl CoiloverSettings {
    pub(crate) fn accuracy(&self) -> Accuracy {
        Accuracy {
            microsteps: self.microsteps.max(1),
            resolve: if self.resolve > 1 { self.resolve } else { 0 },
            extrapolate: self.extrapolation,
            tolerance: self
                .tolerance
                .filter(|t| t.is_finite() && *t > 0.0)
                .map(f64::from),
            max_microsteps: self.max_microsteps.max(1),
            max_iterations: self.max_iterations.max(1),
        }
    }
}
