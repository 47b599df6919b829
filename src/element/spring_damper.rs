use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A spring and a damper side by side (Kelvin–Voigt): tension = stiffness · (length − rest length) + damping · rate of
/// the length.
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
pub struct SpringDamper {
    /// End A, where the pair starts.
    #[entities]
    pub body_a: Entity,
    /// End B, to which the pair goes.
    #[entities]
    pub body_b: Entity,
    /// Length without force, m. `None` for the length in the first step in which the pair acts; that is then written
    /// back here. A load then sags first; see [`HoldPose`](crate::HoldPose). It is negative only beside a
    /// [`SpringAxis`](crate::SpringAxis).
    pub rest_length: Option<f32>,
    /// Stiffness, N/m, from 0 to 1e12.
    pub stiffness: f32,
    /// Damping, N s/m, from 0 to 1e12.
    pub damping: f32,
}

impl SpringDamper {
    /// Returns a pair of 1 N/m and 1 N s/m. Its rest length is the length in the first step in which it acts.
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
