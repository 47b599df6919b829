use bevy::prelude::*;

/// Which way an element acts, spring and damper together.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone, Hash)]
pub enum SpringAction {
    /// Pulls and pushes.
    #[default]
    Both,
    /// Pulls only: a rope, a bungee. Slack is slack, without damping. A [`Preload`] is added before the cut: a
    /// preload P on a stiffness k lets it go slack at P/k below its rest length, not at the rest length.
    Pull,
    /// Pushes only: a seat, a buffer.
    Push,
}

/// A constant tension beside the spring's, N: the force at rest length. Negative pushes the ends apart.
///
/// It is part of [`SpringReadout::spring_force`](crate::SpringReadout::spring_force). Beside
/// [`SpringAction::Pull`] or [`Push`](SpringAction::Push), spring and preload are added first, and the sum is cut at
/// zero: a slack rope has no force whatever its preload. [`HoldPose`](crate::HoldPose) finds the preload that holds a
/// load.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Preload(pub f32);

/// Most force that spring and damper have together, N, above zero: their sum is cut there, as a clutch slips. The stops of a
/// [`SpringTravel`] are not held back by it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct MaxForce(pub f32);

/// Least and greatest length, with a stop at each: beyond it a force
/// `stop_stiffness` · p · (1 + `progression` · p) for a penetration p pushes back, and `stop_damping` takes
/// energy while it is pressed. A stop never holds anything back that leaves it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct SpringTravel {
    /// Length at which the bump stop begins, m: the solid length of a coil, say. 0 for none.
    pub min_length: f32,
    /// Length at which the rebound stop begins, m; infinite for none.
    pub max_length: f32,
    /// N/m.
    pub stop_stiffness: f32,
    /// Growth of the stop's stiffness with penetration, 1/m.
    pub progression: f32,
    /// N s/m.
    pub stop_damping: f32,
}

impl SpringTravel {
    /// Between two lengths (m), with stops of a stiffness (N/m) and neither progression nor damping.
    pub const fn new(min_length: f32, max_length: f32, stop_stiffness: f32) -> Self {
        Self {
            min_length,
            max_length,
            stop_stiffness,
            progression: 0.0,
            stop_damping: 0.0,
        }
    }

    /// Sets the growth of the stops' stiffness, 1/m.
    pub const fn with_progression(mut self, progression: f32) -> Self {
        self.progression = progression;
        self
    }

    /// Sets the stops' damping, N s/m.
    pub const fn with_stop_damping(mut self, damping: f32) -> Self {
        self.stop_damping = damping;
        self
    }
}
