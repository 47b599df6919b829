use bevy::prelude::*;

/// Where an element is held, beside [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper): a point in each end's local frame, as a child entity with
/// that translation would stand (so the end's scale counts). Off-centre points load a body with torque.
///
/// Without this component both are zero: the origin of each end. [`WorldAnchors`](crate::WorldAnchors) takes points of
/// the world instead.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Anchors {
    /// On end A, in its local frame, m.
    pub a: Vec3,
    /// On end B, in its local frame, m.
    pub b: Vec3,
}

impl Anchors {
    /// Points on end A and end B.
    pub const fn new(a: Vec3, b: Vec3) -> Self {
        Self { a, b }
    }
}
