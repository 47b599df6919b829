//! Snapshots of the springs: to go back to an earlier tick, or to continue from it in another world.

mod error;

pub use crate::backend::rapier::snapshot::RapierSnapshot;
pub use error::SnapshotError;

use crate::scene::kept::Kept;
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

/// Everything that springs remember from one tick to the next: for rollback, saved games and replays.
///
/// If everything else is restored as well, the future is the same bit for bit. Take the snapshot at the end of a tick,
/// after [`CoiloverSystems::Readout`](crate::CoiloverSystems::Readout), and restore it at the same point.
///
/// It contains:
///
/// - Of each element: full turns counted, direction and places of its ends, the energy ledger,
///   [`SpringReadout`](crate::SpringReadout), the error control of its micro-steps, and its state inside Rapier's
///   solver.
/// - Of each body that elements act on: [`SpringLoad`](crate::SpringLoad) with `ExternalForce`, since when it has been
///   at rest, contacts that have just ended, and settings that the crate has raised for it in Rapier.
/// - Of each network: its energy bound, the impacts that are not over, and the starting values of its iterations.
///
/// It does not contain what the game can restore itself:
///
/// - Elements and their companions. If stiffness, damping or rest length of a component differ from those that acted
///   last, that counts as a change by the game. Writing the same values again does not. A rest length that was found in
///   the first step is written back if the component has none.
/// - Rapier: bodies, contacts, joints. [`RapierSnapshot`] contains them, with `Transform`, `Velocity` and `Sleeping` of
///   bodies. Restore it first.
/// - `Transform` of ends that are not bodies, [`CoiloverSettings`](crate::CoiloverSettings), `Time<Fixed>`, and whatever
///   else the game's own systems read.
///
/// It takes about 860 bytes for a lone spring with its two bodies (`cargo bench -p benches --bench snapshot`); see
/// [`bytes`](Self::bytes).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn rollback(world: &mut World) -> Result<(), SnapshotError> {
/// let (springs, engine) = (CoiloverSnapshot::take(world), RapierSnapshot::take(world));
/// // Ticks later:
/// engine.restore(world)?;
/// springs.restore(world)?;
/// # Ok(())
/// # }
/// ```
///
/// In another world, or if elements have been despawned and spawned again, entities have other ids. Give the new ids to
/// the snapshot with `MapEntities`. A map from old to new ids is an `EntityMapper`:
///
/// ```
/// # use bevy::ecs::entity::{EntityHashMap, MapEntities};
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn load(world: &mut World, mut springs: CoiloverSnapshot, mut new: EntityHashMap<Entity>) -> Result<(), SnapshotError> {
/// springs.map_entities(&mut new);
/// springs.restore(world)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub struct CoiloverSnapshot(Kept);

impl CoiloverSnapshot {
    /// Takes a snapshot. It is empty if the world has no [`CoiloverPlugin`](crate::CoiloverPlugin).
    pub fn take(world: &World) -> Self {
        Self(Kept::take(world))
    }

    /// Makes the springs of a world continue from this snapshot. Elements that were spawned after the snapshot may
    /// stay, and continue as new elements.
    ///
    /// If the snapshot does not fit the world, an error is returned and nothing is changed. There is one exception: if
    /// a [`RapierSnapshot`] was restored just before, the springs then start afresh, and what they had inside Rapier at
    /// the tick of the snapshot is removed.
    ///
    /// The snapshot may come from a source that you do not trust. Numbers that no scene has, such as NaN, are replaced by
    /// those of a new element or body.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        self.0.put(world)
    }

    /// Leaves out the state inside Rapier's solver, for a world whose Rapier is not restored and whose bodies are only
    /// moved. Springs on bodies that contacts or joints hold then continue nearly as before, but not bit for bit.
    #[must_use]
    pub fn without_engine(mut self) -> Self {
        self.0.forget_engine();
        self
    }

    /// Returns all entities in the snapshot: Rapier's contexts, then bodies, then elements. If snapshot and world have
    /// one context each, these count as the same, whatever their ids are.
    pub fn entities(&self) -> impl Iterator<Item = Entity> {
        self.0.entities()
    }

    /// Number of bytes that the snapshot takes in memory.
    pub fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

impl MapEntities for CoiloverSnapshot {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.0.map_entities(mapper);
    }
}
