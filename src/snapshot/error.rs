use bevy::prelude::Entity;
use std::fmt;

/// Why a snapshot cannot be restored into a world. Nothing has been changed then, except as
/// [`CoiloverSnapshot::restore`](crate::CoiloverSnapshot::restore) says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The world has no [`CoiloverPlugin`](crate::CoiloverPlugin), or no `RapierPhysicsPlugin`.
    NoPlugin,
    /// This entity is not an element that acts: it is gone or disabled, has lost its element, or waits for named ends.
    NoElement(Entity),
    /// This entity is not a body that Rapier knows.
    NoBody(Entity),
    /// This entity is not a collider that Rapier knows.
    NoCollider(Entity),
    /// This entity has no joint that Rapier knows.
    NoJoint(Entity),
    /// This entity is not a Rapier context.
    NoContext(Entity),
    /// Two entities of the snapshot are mapped to this one.
    Twice(Entity),
    /// The body, collider or joint of this entity has another handle in Rapier than in the snapshot: it was spawned in
    /// another order, or spawned again.
    OtherHandle(Entity),
    /// The body, collider or joint of this entity was spawned after the snapshot. Despawn it first.
    Unknown(Entity),
    /// Rapier's joints and solver iterations are not those of the snapshot's tick. Restore a
    /// [`RapierSnapshot`](crate::RapierSnapshot) of the same tick first, or see
    /// [`CoiloverSnapshot::without_engine`](crate::CoiloverSnapshot::without_engine).
    OtherEngine,
    /// The snapshot, as read from a file or received over the network, refers to parts that it does not contain, or
    /// has two joints where an element has one.
    Broken,
}

impl fmt::Display for SnapshotError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NoPlugin => f.write_str("the world has no CoiloverPlugin or no RapierPhysicsPlugin"),
            Self::NoElement(entity) => write!(f, "{entity} is no element that acts"),
            Self::NoBody(entity) => write!(f, "{entity} is no body that Rapier knows"),
            Self::NoCollider(entity) => write!(f, "{entity} is no collider that Rapier knows"),
            Self::NoJoint(entity) => write!(f, "{entity} has no joint that Rapier knows"),
            Self::NoContext(entity) => write!(f, "{entity} is no Rapier context"),
            Self::Twice(entity) => write!(f, "two entities of the snapshot are mapped to {entity}"),
            Self::OtherHandle(entity) => {
                write!(f, "{entity} has another handle in Rapier than it had in the snapshot")
            }
            Self::Unknown(entity) => {
                write!(f, "{entity} came after the snapshot and is still in Rapier; despawn it first")
            }
            Self::OtherEngine => f.write_str(
                "Rapier's joints or solver iterations are not those of the snapshot; put a RapierSnapshot of the same tick back first",
            ),
            Self::Broken => f.write_str("the snapshot names parts that it has not"),
        }
    }
}

impl std::error::Error for SnapshotError {}
