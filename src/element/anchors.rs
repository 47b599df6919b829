use bevy::prelude::*;

/// Points at which an element is attached, beside [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper). Each point is in the local frame of its end, like the translation of a child
/// entity, so the scale of the end applies to it. A force at a point off the centre of mass also turns the body.
///
/// Without this component, both points are the origins of the ends. [`WorldAnchors`](crate::WorldAnchors) takes points
/// of the world instead. Torsion elements have no anchors, so this component does not change what they do.
///
/// Each coordinate must be finite and at most 1e12 in magnitude. Otherwise the element gets a
/// [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Anchors {
    /// Point on end A, in the local frame of end A, m.
    pub a: Vec3,
    /// Point on end B, in the local frame of end B, m.
    pub b: Vec3,
}

impl Anchors {
    /// Points on end A and end B, each in the local frame of its end, m.
    pub const fn new(a: Vec3, b: Vec3) -> Self {
        Self { a, b }
    }
}
