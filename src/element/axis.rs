use bevy::prelude::*;

/// Makes an element act along an axis instead of from end to end: its length is then the distance of the
/// ends along that axis, negative where end B is behind end A. Any length of vector but zero will do.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum SpringAxis {
    /// An axis of the world. Each end is pushed at its own point, so ends that are apart across the axis
    /// feel a torque which nobody answers, as with any force from outside.
    World(Vec3),
    /// An axis of end A's frame, which turns with it. End A is pushed where end B is, as by a slide fixed to
    /// it, so both momenta are kept. End A must be a rigid body.
    BodyA(Vec3),
}
