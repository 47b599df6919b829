//! Going back to an earlier tick, or on from it in another world.

mod error;

pub use crate::backend::rapier::snapshot::RapierSnapshot;
pub use error::SnapshotError;

use crate::scene::kept::Kept;
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;

/// All that springs remember from one tick to the next: for rollback, saved games and replays.
///
/// With what else there is put back beside it, the future is the same bit for bit. Take it where a tick is over, after
/// [`CoiloverSystems::Readout`](crate::CoiloverSystems::Readout), and put it back there.
///
/// It holds, of each element: turns counted, direction and places of its ends, the ledger of energy,
/// [`SpringReadout`](crate::SpringReadout), the error control of its micro-steps, and what it has inside Rapier's solver. Of
/// each body that elements act on: [`SpringLoad`](crate::SpringLoad) with `ExternalForce`, since when it has been at rest,
/// contacts that have just ended, and what it was lent in Rapier. Of each network: its energy bound, blows that are not over,
/// and from where iterations start.
///
/// It does not hold what the game can put back itself:
///
/// - elements and their companions. A component whose stiffness, damping or rest length is another than acted last counts as
///   changed by the game; one that is only written anew does not. Rest lengths that were found at the first step are written
///   back where a component has none.
/// - Rapier: bodies, contacts, joints. [`RapierSnapshot`] does, with `Transform`, `Velocity` and `Sleeping` of bodies. Put it
///   back first.
/// - `Transform` of ends that are no bodies, `Time<Fixed>`, and whatever else the game's own systems read.
///
/// It takes some 700 bytes for a spring with a body of its own; [`bytes`](Self::bytes) tells.
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
/// In another world, or where elements have been despawned and spawned again, entities have other ids. Give it the new ones
/// with `MapEntities`; a map from old to new is an `EntityMapper`:
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
    /// Takes one. It is empty where there is no [`CoiloverPlugin`](crate::CoiloverPlugin).
    pub fn take(world: &World) -> Self {
        Self(Kept::take(world))
    }

    /// Has the springs of a world go on from there.
    ///
    /// Elements that came after the snapshot may stay, and go on as new ones. If it does not fit the world, nothing is
    /// changed; but if Rapier's was put back just before, springs begin anew, and leave nothing behind in Rapier of what
    /// they had in it then.
    pub fn restore(&self, world: &mut World) -> Result<(), SnapshotError> {
        self.0.put(world)
    }

    /// Leaves out what springs have inside Rapier's solver, for a world whose Rapier is not put back but only its bodies are
    /// moved. Springs on bodies that contacts or joints hold then go on nearly as they did, not bit for bit.
    #[must_use]
    pub fn without_engine(mut self) -> Self {
        self.0.forget_engine();
        self
    }

    /// All entities that it names: Rapier's contexts, then bodies, then elements. One context is taken for the one of a
    /// world that has one, whatever it is called.
    pub fn entities(&self) -> impl Iterator<Item = Entity> {
        self.0.entities()
    }

    /// Bytes that it takes in memory.
    pub fn bytes(&self) -> usize {
        self.0.bytes()
    }
}

impl MapEntities for CoiloverSnapshot {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.0.map_entities(mapper);
    }
}
