//! What a game reads back from an element.

use bevy::prelude::*;

/// The state of an element after the last step, on every element without asking. SI units.
///
/// Forces are the element's own, tension positive. (The force that stands in a body's
/// `ExternalForce` is what the engine must be given for the body to arrive where this force takes
/// it; see [`SpringLoad`](crate::SpringLoad).) Zero on an element that has not acted yet.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct SpringReadout {
    /// Distance between the anchors, m.
    pub length: f32,
    /// Rate of the length, m/s.
    pub rate: f32,
    /// Tension of the spring, N.
    pub spring_force: f32,
    /// Tension of the damper, N.
    pub damper_force: f32,
    /// Energy in the spring, J.
    pub stored_energy: f32,
    /// Power that the damper turns into heat, W.
    pub dissipated_power: f32,
}

impl SpringReadout {
    /// Spring and damper together, N, tension positive.
    pub const fn force(&self) -> f32 {
        self.spring_force + self.damper_force
    }
}
