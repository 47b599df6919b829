use bevy::prelude::*;

/// Makes an element act along an axis instead of along the line between its ends. The length of the element is then the
/// distance from end A to end B along this axis, m; it is negative where end B is behind end A. The vector may have any
/// finite length but zero: only its direction counts. With another vector, or beside a torsion element, the element gets
/// a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum SpringAxis {
    /// Axis of the world. Each end is pushed at its own point. If the ends are apart across the axis, they feel a net
    /// torque, as with any external force.
    World(Vec3),
    /// Axis in the frame of body A, which turns with body A. Body A is the rigid body that end A is or is a descendant
    /// of; there must be one. It is pushed at the point where end B is, as by a slide fixed to it, so momentum and
    /// angular momentum are conserved.
    BodyA(Vec3),
}
