//! What a game can set.

use crate::dynamics::tolerance::Accuracy;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// How the plugin runs.
#[derive(Resource, Clone, Copy, Debug)]
pub struct CoiloverSettings {
    /// Micro-steps per engine step, at least 1; may be changed at any time.
    pub microsteps: u32,
    /// Kicks of elements that all networks together may take in a step to follow springs that are too stiff for `microsteps`:
    /// the budget of time for that, at 0.3 to 0.5 µs a kick. 1 for none. A network needs three times its stiffest ω·dt or
    /// more of each of its elements; where there are too many for that, it takes `microsteps`, and up to sixteen where those
    /// win energy: stable, but the stiff motion is wrong in phase. A lone element takes ω·dt/2 of its own, up to 32. Under a tolerance it does not count.
    pub resolve: u32,
    /// Combine one and two times as many micro-steps to fourth order wherever the motion is resolved,
    /// and take three times as many plain ones elsewhere.
    pub extrapolation: bool,
    /// Error of position that may be added, m per simulated second; `None` for a fixed count of
    /// micro-steps. With a tolerance the two settings above do not count: every component takes as many
    /// micro-steps in every step as its own error asks for.
    pub tolerance: Option<f32>,
    /// Most micro-steps of one engine step, at least 1. Where that is too few,
    /// [`SpringReadout::capped`](crate::SpringReadout::capped) says so.
    pub max_microsteps: u32,
    /// Most iterations of one solve of a large network, at least 1; told likewise.
    pub max_iterations: u32,
    /// Most solver substeps of one engine step that elements ask for where contacts or joints hold a body of theirs, at
    /// least 1; told likewise.
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
