//! What a game can set.

use crate::dynamics::step::Accuracy;
use bevy::ecs::intern::Interned;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;

/// How the plugin runs.
#[derive(Resource, Clone, Copy, Debug)]
pub struct CoiloverSettings {
    /// Micro-steps per engine step, at least 1; may be changed at any time.
    pub microsteps: u32,
    /// Combine one and two times as many micro-steps to fourth order wherever the motion is resolved,
    /// and take three times as many plain ones elsewhere.
    pub extrapolation: bool,
    pub(crate) schedule: Interned<dyn ScheduleLabel>,
}

impl CoiloverSettings {
    pub(crate) fn accuracy(&self) -> Accuracy {
        Accuracy {
            microsteps: self.microsteps.max(1),
            extrapolate: self.extrapolation,
        }
    }
}
