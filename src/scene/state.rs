//! Elements and the bodies they act on, as flat arrays kept from tick to tick.

use crate::backend::BodyId;
use crate::scene::assembly::Assembly;
use crate::scene::group::{Group, Groups};
use crate::scene::held::Inside;
use crate::scene::lone::Lone;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow, Raised, Sweeps};
use crate::scene::still::{Stepped, Still};
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// The scene as the engine's step sees it. It has a field for all that one stage of a step leaves for another, and no more:
/// a stage takes those that it needs by their names.
#[derive(Resource, Default)]
pub struct Scene {
    /// In the order of the query that finds them, inert ones too.
    pub(crate) elements: Vec<ElementRow>,
    /// Indices of the elements.
    pub(crate) row_of: EntityHashMap<u32>,
    /// Elements that changed since the last step.
    pub(crate) changed: Vec<usize>,
    /// Elements that take no part.
    pub(crate) faulty: Vec<usize>,
    /// Elements with an end that is watched, and that end.
    pub(crate) followed: Vec<(usize, usize)>,
    /// In the order of their entities.
    pub(crate) bodies: Vec<BodyRow>,
    pub(crate) index: EntityHashMap<u32>,
    /// Indices of the bodies by what the engine calls them.
    pub(crate) handles: HashMap<(Entity, BodyId), u32>,
    /// Bodies that hold elements, but that these cannot move.
    pub(crate) walls: EntityHashSet,
    pub(crate) groups: Groups,
    pub(crate) assemblies: Vec<Assembly>,
    /// What needs no assembly, world by world.
    pub(crate) lone: Vec<Lone>,
    /// Components of which contacts or joints may hold some body: indices of their groups.
    pub(crate) tangible: Vec<u32>,
    /// These have to be found anew: some body has colliders that had none, or the other way round.
    pub(crate) touch_changed: bool,
    /// There were joints when they were found last.
    pub(crate) had_joints: bool,
    /// Number of the tick.
    pub(crate) tick: u32,
    pub(crate) stepped: Stepped,
    /// Seconds that the engine will step in this tick; 0 if it will not.
    pub(crate) time: f64,
    /// A body or an element that it knows has lost a component, or a body is another one: look at everything again.
    pub(crate) disturbed: bool,
    /// Elements that have lost a companion since the last tick.
    pub(crate) left_behind: Vec<Entity>,
    /// Something was found amiss after the scene was prepared: look at everything again.
    pub(crate) stale: bool,
    /// A user's force on some body changed in this tick.
    pub(crate) loaded: bool,
    /// Some body was given something in this tick whose place several elements may ask for afterwards.
    pub(crate) noting: bool,
    /// Some body was given something in this tick.
    pub(crate) delivered: bool,
    /// Some followed end was not where it had been.
    pub(crate) shifted: bool,
    pub(crate) still: Still,
    /// Some element has no end that elements can move.
    pub(crate) immovable: bool,
    /// The readouts stand in another order than the rows even when these have just been made.
    pub(crate) unordered: bool,
    /// The rows were made anew in this tick.
    pub(crate) renewed: bool,
    /// What elements that are gone have left in the engine's solver, and in which context.
    pub(crate) left: Vec<(Entity, Box<Inside>)>,
    /// Bodies that no element moves any more, and what they have besides forces.
    pub(crate) unloaded: Vec<(Entity, BodyId, Raised)>,
    /// What contexts have been told besides.
    pub(crate) sweeps: EntityHashMap<Sweeps>,
    /// The rows are those of a snapshot, put there at that tick: what changed before is none of theirs.
    pub(crate) since: Option<Tick>,
    /// Rapier's snapshot was put back since the last step, and springs' was not yet.
    pub(crate) engine_went_back: bool,
    /// Elements whose components are others than a snapshot says.
    pub(crate) pending: Vec<Entity>,
}

impl Scene {
    /// Whether it is an element or a body that holds one.
    pub(crate) fn knows(&self, entity: Entity) -> bool {
        self.index.contains_key(&entity)
            || self.walls.contains(&entity)
            || self.row_of.contains_key(&entity)
    }

    /// Forgets what was so of the last step alone.
    pub(crate) fn begin(&mut self) {
        self.time = 0.0;
        self.tick = self.tick.wrapping_add(1).max(1);
        self.stepped.worlds.clear();
        self.stepped.some_rest = false;
        self.delivered = false;
        self.noting = false;
        self.engine_went_back = false;
    }

    /// Forgets what has been left in worlds that are gone.
    pub(crate) fn forget_worlds(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.left.retain(|(context, _)| is_there(*context));
        self.unloaded.retain(|(context, ..)| is_there(*context));
        self.sweeps.retain(|context, _| is_there(*context));
        self.still.retain(is_there);
    }

    /// Finds the components of which contacts may hold some body, or joints, where there are any.
    pub(crate) fn find_tangible(&mut self, any_joints: bool) {
        let changed = std::mem::replace(&mut self.had_joints, any_joints) != any_joints;
        if !(changed || self.touch_changed) {
            return;
        }
        self.touch_changed = false;
        let tangible = BodyFlags::CAN_TOUCH | BodyFlags::LINGERS | BodyFlags::NEW;
        let (groups, bodies) = (&self.groups, &self.bodies);
        let may_be_held = |group: &Group| {
            let mut bodies = groups
                .members(group)
                .bodies
                .iter()
                .map(|b| &bodies[*b as usize]);
            any_joints
                || group.inside
                || group.held
                || bodies.any(|row| row.flags.intersects(tangible))
        };
        let all = groups.list().iter().enumerate();
        let found = all.filter(|(_, group)| may_be_held(group));
        self.tangible.clear();
        self.tangible.extend(found.map(|(g, _)| g as u32));
    }

    /// The row of a body that says it stands at `slot`.
    pub(crate) fn body(&mut self, slot: usize, entity: Entity) -> Option<&mut BodyRow> {
        self.bodies.get_mut(slot).filter(|row| row.entity == entity)
    }
}
