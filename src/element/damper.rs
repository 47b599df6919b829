use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A viscous damper between two ends: tension = damping · rate of the length. It resists every change of the length.
///
/// Each end is a rigid body, a descendant of one, or any other entity with a `Transform`. A field or an end that is not
/// valid gives the element a [`SpringFault`](crate::SpringFault), and it does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(SpringReadout)]
#[type_path = "bevy_coilover"]
pub struct Damper {
    /// End A, where the damper starts.
    #[entities]
    pub body_a: Entity,
    /// End B, to which the damper goes.
    #[entities]
    pub body_b: Entity,
    /// Damping, N s/m, from 0 to 1e12.
    pub damping: f32,
}

impl Damper {
    /// Returns a damper of 1 N s/m between two ends.
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
