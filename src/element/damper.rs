use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A viscous damper between two ends: tension = damping · rate of the length.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct Damper {
    /// The end that the damper starts from.
    #[entities]
    pub body_a: Entity,
    /// The end that the damper goes to.
    #[entities]
    pub body_b: Entity,
    /// N s/m, finite and not negative.
    pub damping: f32,
}

impl Damper {
    /// A damper of 1 N s/m.
    pub const fn new(body_a: Entity, body_b: Entity) -> Self {
        Self {
            body_a,
            body_b,
            damping: 1.0,
        }
    }

    /// Sets the damping, N s/m.
    pub const fn with_damping(mut self, damping: f32) -> Self {
        self.damping = damping;
        self
    }
}
