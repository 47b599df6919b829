use crate::readout::SpringReadout;
use bevy::prelude::*;

/// A linear spring between two ends: tension = stiffness · (length − rest length). It pulls when it is longer than its
/// rest length, and pushes when it is shorter.
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
pub struct Spring {
    /// End A, where the spring starts.
    #[entities]
    pub body_a: Entity,
    /// End B, to which the spring goes.
    #[entities]
    pub body_b: Entity,
    /// Length without force, m. `None` for the length in the first step in which the spring acts; that is then written
    /// back here. A load then sags first; see [`HoldPose`](crate::HoldPose). It is negative only beside a
    /// [`SpringAxis`](crate::SpringAxis).
    pub rest_length: Option<f32>,
    /// Stiffness, N/m, from 0 to 1e12.
    pub stiffness: f32,
}

impl Spring {
    /// Returns a spring of 1 N/m. Its rest length is the length in the first step in which it acts.
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
