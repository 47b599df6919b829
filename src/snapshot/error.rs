use bevy::prelude::Entity;
use std::fmt;

/// Why a snapshot cannot be put into a world. Nothing has been changed then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SnapshotError {
    /// The world has no [`CoiloverPlugin`](crate::CoiloverPlugin), or no `RapierPhysicsPlugin`.
    NoPlugin,
    /// This entity is no element that acts: it is gone, is disabled, or has another component now.
    NoElement(Entity),
    /// This entity is no body that Rapier knows.
    NoBody(Entity),
    /// This entity is no collider that Rapier knows.
    NoCollider(Entity),
    /// This entity has no joint that Rapier knows.
    NoJoint(Entity),
    /// This entity is no Rapier context.
    NoContext(Entity),
    /// Two entities of the snapshot have been mapped to this one.
    Twice(Entity),
    /// Rapier calls this entity's body, collider or joint otherwise than it did: it was spawned in another order, or anew.
    OtherHandle(Entity),
    /// This entity's body, collider or joint came after the snapshot: despawn it first.
    Unknown(Entity),
    /// Rapier's joints and solver iterations are not those of the tick of the snapshot: put a [`RapierSnapshot`](crate::RapierSnapshot) of the same
    /// tick back first, or see [`CoiloverSnapshot::without_engine`](crate::CoiloverSnapshot::without_engine).
    OtherEngine,
    /// What was read from a file or from the net names parts that it has not.
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
