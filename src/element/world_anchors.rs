use super::Anchors;
use bevy::prelude::*;

/// Points at which an element is attached, in the world: an easier way to set [`Anchors`].
///
/// At the next step both points are converted to [`Anchors`], in the frames that the ends have then, and this component
/// is removed. Points on ends that are still looked up by their [names](crate::EndNames) wait for them. From then on each
/// point moves with its end. Insert it again to attach the element elsewhere.
///
/// If an end is a body without a `Transform`, a warning is logged once, and this component waits until the body has one.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn hang(commands: &mut Commands, ceiling: Entity, sign: Entity) {
/// commands.spawn((
///     Spring::new(ceiling, sign).with_stiffness(200.0),
///     WorldAnchors::new(Vec3::new(0.5, 3.0, 0.0), Vec3::new(0.5, 2.0, 0.0)),
/// ));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Anchors)]
pub struct WorldAnchors {
    /// Point at which end A is attached, in the world, m.
    pub a: Vec3,
    /// Point at which end B is attached, in the world, m.
    pub b: Vec3,
}

impl WorldAnchors {
    /// Points for end A and end B, in the world, m.
    pub const fn new(a: Vec3, b: Vec3) -> Self {
        Self { a, b }
    }
}
