//! Elements and the bodies they act on, as flat arrays kept from tick to tick.

use super::assembly::Assembly;
use super::find::{Found, Wanted};
use super::group::Groups;
use super::held::Inside;
use super::rows::{BodyRow, ElementRow, Raised, Sweeps};
use super::still::Still;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_rapier3d::prelude::RapierRigidBodySet;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

/// The scene as the engine's step sees it. It has a field for all that one stage of a step leaves for another, and no more:
/// a stage takes those that it needs by their names.
#[derive(Resource, Default)]
pub struct Scene {
    /// In the order of the query that finds them, inert ones too.
    pub(super) elements: Vec<ElementRow>,
    /// Indices of the elements.
    pub(super) row_of: EntityHashMap<usize>,
    /// Elements that changed since the last step.
    pub(super) changed: Vec<usize>,
    /// Elements that take no part.
    pub(super) faulty: Vec<usize>,
    /// Elements with an end that is watched, and that end.
    pub(super) followed: Vec<(usize, usize)>,
    /// In the order of their entities.
    pub(super) bodies: Vec<BodyRow>,
    pub(super) index: EntityHashMap<usize>,
    /// Indices of the bodies by what the engine calls them.
    pub(super) handles: HashMap<(Entity, RigidBodyHandle), u32>,
    pub(super) scratch: Scratch,
    /// Bodies that hold elements, but that these cannot move.
    pub(super) walls: EntityHashSet,
    pub(super) groups: Groups,
    pub(super) assemblies: Vec<Assembly>,
    /// The contexts that are stepped in this tick.
    pub(super) stepped: Vec<Entity>,
    /// Seconds that the engine will step in this tick; 0 if it will not.
    pub(super) time: f64,
    /// Something was found amiss after the scene was prepared: look at everything again.
    pub(super) stale: bool,
    /// A user's force on some body changed in this tick.
    pub(super) loaded: bool,
    /// Some body was given something in this tick.
    pub(super) delivered: bool,
    /// Some followed end was not where it had been.
    pub(super) shifted: bool,
    pub(super) still: Still,
    /// Some element has no end that elements can move.
    pub(super) immovable: bool,
    /// The readouts stand in another order than the rows even when these have just been made.
    pub(super) unordered: bool,
    /// The rows were made anew in this tick.
    pub(super) renewed: bool,
    /// What elements that are gone have left in the engine's solver, and in which context.
    pub(super) left: Vec<(Entity, Box<Inside>)>,
    /// Bodies that no element moves any more, and what they have besides forces.
    pub(super) unloaded: Vec<(Entity, RigidBodyHandle, Raised)>,
    /// What contexts have been told besides.
    pub(super) sweeps: EntityHashMap<Sweeps>,
    /// The rows are those of a snapshot, put there at that tick: what changed before is none of theirs.
    pub(super) since: Option<Tick>,
    /// Rapier's snapshot was put back since the last step, and springs' was not yet.
    pub(super) engine_went_back: bool,
    /// Elements whose components are others than a snapshot says.
    pub(super) pending: Vec<Entity>,
}

impl Scene {
    /// Whether it is an element or a body that holds one.
    pub(super) fn knows(&self, entity: Entity) -> bool {
        self.index.contains_key(&entity)
            || self.walls.contains(&entity)
            || self.row_of.contains_key(&entity)
    }

    /// The row of a body that says it stands at `slot`.
    pub(super) fn body(&mut self, slot: usize, entity: Entity) -> Option<&mut BodyRow> {
        self.bodies.get_mut(slot).filter(|row| row.entity == entity)
    }
}

/// What is needed only while rows are made anew. Kept between, for its memory alone.
#[derive(Default)]
pub(super) struct Scratch {
    /// The ends of every element, or none of an inert one.
    pub(super) found: Vec<Option<Found>>,
    /// The rows of bodies as they were.
    pub(super) bodies: Vec<BodyRow>,
    /// The bodies that there are to be, in the order of their entities.
    pub(super) wanted: Vec<Wanted>,
}

impl Scratch {
    pub(super) fn clear(&mut self) {
        self.found.clear();
        self.bodies.clear();
        self.wanted.clear();
    }
}

/// Notes when the engine's bodies were changed last, at the end of a tick.
pub(crate) fn mark(mut scene: ResMut<Scene>, sets: Query<Ref<RapierRigidBodySet>>) {
    let changed = |context| sets.get(context).ok().map(|set| set.last_changed());
    scene.still.mark(changed);
}
