use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A spring and a damper side by side (Kelvin–Voigt): tension = stiffness · (length − rest length)
/// + damping · rate of the length.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct SpringDamper {
    /// The end that the pair starts from.
    #[entities]
    pub body_a: Entity,
    /// The end that the pair goes to.
    #[entities]
    pub body_b: Entity,
    /// Length without force, m; `None` is the length at the first step it acts, written back here then. A load then sags
    /// first: see [`HoldPose`](crate::HoldPose).
    pub rest_length: Option<f32>,
    /// N/m, finite and not negative.
    pub stiffness: f32,
    /// N s/m, finite and not negative.
    pub damping: f32,
}

impl SpringDamper {
    /// A pair of 1 N/m and 1 N s/m whose rest length is the length at the first step it acts.
    pub const fn new(body_a: Entity, body_b: Entity) -> Self {
        Self {
            body_a,
            body_b,
            rest_length: None,
            stiffness: 1.0,
            damping: 1.0,
        }
    }

    /// Sets the stiffness, N/m.
    pub const fn with_stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = stiffness;
        self
    }

    /// Sets the damping, N s/m.
    pub const fn with_damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }

    /// Sets the length without force, m.
    pub const fn with_rest_length(mut self, rest_length: f32) -> Self {
        self.rest_length = Some(rest_length);
        self
    }
}
