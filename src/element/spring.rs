use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A linear spring between two ends: tension = stiffness · (length − rest length).
///
/// Each end is a body, something below a body in the hierarchy, or any entity with a `Transform`.
/// It pulls when longer than its rest length and pushes when shorter.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct Spring {
    /// The end that the spring starts from.
    #[entities]
    pub body_a: Entity,
    /// The end that the spring goes to.
    #[entities]
    pub body_b: Entity,
    /// Length without force, m; `None` is the length at the first step it acts, written back here then. A load then sags
    /// first: see [`HoldPose`](crate::HoldPose).
    pub rest_length: Option<f32>,
    /// N/m, finite and not negative.
    pub stiffness: f32,
}

impl Spring {
    /// A spring of 1 N/m whose rest length is the length at the first step it acts.
    pub const fn new(body_a: Entity, body_b: Entity) -> Self {
        Self {
            body_a,
            body_b,
            rest_length: None,
            stiffness: 1.0,
        }
    }

    /// Sets the stiffness, N/m.
    pub const fn with_stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Sets the length without force, m.
    pub const fn with_rest_length(mut self, rest_length: f32) -> Self {
        self.rest_length = Some(rest_length);
        self
    }
}
