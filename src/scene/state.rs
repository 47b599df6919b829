//! The resource that holds all data of the scene from tick to tick.

use crate::backend::BodyId;
use crate::scene::assembly::Assembly;
use crate::scene::group::{Group, Groups};
use crate::scene::handles::Handles;
use crate::scene::held::Inside;
use crate::scene::lone::Lone;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow, Raised, Sweeps};
use crate::scene::still::{Stepped, Still};
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::prelude::*;
use std::sync::atomic::AtomicBool;

/// The scene as the engine's step sees it. Each field is data that one stage of a step leaves for another. A stage
/// borrows only the fields that it needs.
#[derive(Resource, Default)]
pub struct Scene {
    /// Rows of all elements, in the order of the query that finds them, including elements with a fault.
    pub(crate) elements: Vec<ElementRow>,
    /// Number that the last new element was given. See [`RareElement::serial`](crate::scene::rows::RareElement::serial).
    pub(crate) last_serial: u32,
    /// Row index of each element.
    pub(crate) row_of: EntityHashMap<u32>,
    /// Row indices of elements that changed since the last step.
    pub(crate) changed: Vec<u32>,
    /// Row indices of elements with a fault, which do not act.
    pub(crate) faulty: Vec<u32>,
    /// Row index of an element and index of its end, for each end that must be looked for in every tick.
    pub(crate) followed: Vec<(u32, u8)>,
    /// Rows of the bodies that elements can move, in the order of their entities.
    pub(crate) bodies: Vec<BodyRow>,
    pub(crate) handles: Handles,
    /// Bodies that hold an element but that elements cannot move.
    pub(crate) walls: EntityHashSet,
    /// Whether one of them has changed its kind. The engine may learn of that only after this tick's preparation.
    pub(crate) wall_changed: bool,
    pub(crate) groups: Groups,
    pub(crate) assemblies: Vec<Assembly>,
    /// Elements that need no assembly, one list per context.
    pub(crate) lone: Vec<Lone>,
    /// Indices of the groups in which contacts or joints may hold a body.
    pub(crate) tangible: Vec<u32>,
    /// Whether `tangible` must be found anew, because the groups are new or a body gained or lost its colliders.
    pub(crate) touch_changed: bool,
    /// Whether the engine had joints when `tangible` was last found.
    pub(crate) had_joints: bool,
    /// Number of the tick.
    pub(crate) tick: u32,
    pub(crate) stepped: Stepped,
    /// Simulated time of this tick in the first context that is stepped, s; 0 if the engine does not step. See
    /// [`Stepped::times`] for the others.
    pub(crate) time: f64,
    /// Whether an element or body of the scene gained or lost a component that matters. Then all rows are made anew.
    pub(crate) disturbed: bool,
    /// Elements that must be read in the next tick: they lost a companion component, or differ from the snapshot that was restored.
    pub(crate) touched: Vec<Entity>,
    /// Whether the rows were found to be out of date after the tick was prepared. Then they are made anew in the next tick.
    pub(crate) stale: bool,
    /// Whether the user's force or torque on some body changed in this tick.
    pub(crate) loaded: bool,
    /// Whether positions of bodies must be stored after this step, because several elements may read them. Not
    /// necessary if only lone elements are solved.
    pub(crate) noting: bool,
    /// Whether some body was given a push in this tick.
    pub(crate) delivered: bool,
    /// Whether an end in `followed` has moved since the last step.
    pub(crate) shifted: bool,
    pub(crate) still: Still,
    /// Whether some element without a fault has no end that elements can move.
    pub(crate) immovable: bool,
    /// Whether the readouts are in another order than the rows even if the rows are new.
    pub(crate) unordered: bool,
    /// Whether numbers were computed for the next step of some element. Until that step they are checked in every tick, because
    /// its ends may still be put elsewhere.
    pub(crate) awaited: bool,
    /// Whether the rows were made anew in this tick, or in earlier ticks without a step in between.
    pub(crate) renewed: bool,
    /// Context and data of joints and hidden bodies that must still be removed from the engine, as their element no longer acts.
    pub(crate) left: Vec<(Entity, Box<Inside>)>,
    /// Context and handle of bodies that no element moves any more, with the settings that must still be restored.
    pub(crate) unloaded: Vec<(Entity, BodyId, Raised)>,
    /// Number of solver sweeps that each context was given.
    pub(crate) sweeps: EntityHashMap<Sweeps>,
    /// Change tick at which the rows were restored from a snapshot, until they are next prepared. Earlier changes are ignored.
    pub(crate) since: Option<Tick>,
    /// Whether Rapier's snapshot was restored since the last step, but the springs' snapshot not yet.
    pub(crate) engine_went_back: bool,
    /// Whether there are changes that the scene has not been prepared for yet.
    pub(crate) news: AtomicBool,
    /// Whether `disturbed` only tells what restoring Rapier's snapshot did, which the springs' snapshot takes into account.
    pub(crate) undisturbed: bool,
}

impl Scene {
    /// Whether an entity is an element, or a body that holds one.
    pub(crate) fn knows(&self, entity: Entity) -> bool {
        self.walls.contains(&entity)
            || self.row_of.contains_key(&entity)
            || self.body_row(entity).is_some()
    }

    /// Row index of a body, if elements can move it.
    pub(crate) fn body_row(&self, body: Entity) -> Option<usize> {
        self.bodies
            .binary_search_by_key(&body, |row| row.entity)
            .ok()
    }

    /// Makes the next tick make all rows anew.
    pub(crate) fn disturb(&mut self) {
        self.disturbed = true;
        self.undisturbed = false;
    }

    /// Whether numbers were computed for a step that is still to come.
    pub(crate) fn awaits_step(&mut self) -> bool {
        self.awaited = self.awaited && self.elements.iter().any(ElementRow::awaits_step);
        self.awaited
    }

    /// Whether the rows need no preparation as long as nothing outside of the scene changes.
    pub(crate) fn is_settled(&self) -> bool {
        let unsettled = self.disturbed
            || self.stale
            || self.awaited
            || self.renewed
            || self.shifted
            || self.since.is_some();
        !unsettled
            && self.touched.is_empty()
            && self.changed.is_empty()
            && self.followed.is_empty()
            && self.faulty.is_empty()
    }

    /// Resets what belongs to the last step only, and counts the tick.
    pub(crate) fn begin(&mut self) {
        self.time = 0.0;
        self.tick = self.tick.wrapping_add(1).max(1);
        self.stepped.worlds.clear();
        self.stepped.some_rest = false;
        self.stepped.led.clear();
        self.stepped.times.clear();
        self.delivered = false;
        self.noting = false;
        self.engine_went_back = false;
        self.undisturbed = false;
    }

    /// Notes that a context is stepped for `time` seconds in this tick.
    pub(crate) fn note_step(&mut self, context: Entity, time: f64) {
        if self.stepped.worlds.is_empty() {
            self.time = time;
        } else if time != self.time {
            // In an interpolated game, each context has a lag of its own.
            self.stepped.times.insert(context, time);
        }
        self.stepped.worlds.push(context);
    }

    /// Forgets contexts that no longer exist.
    pub(crate) fn forget_worlds(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.left.retain(|(context, _)| is_there(*context));
        self.unloaded.retain(|(context, ..)| is_there(*context));
        self.sweeps.retain(|context, _| is_there(*context));
        self.still.retain(is_there);
    }

    /// Finds `tangible` again if that is necessary. If the engine has any joints, all groups belong to it.
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

    /// The row at `slot`, if it is the row of `entity`.
    pub(crate) fn body(&mut self, slot: usize, entity: Entity) -> Option<&mut BodyRow> {
        self.bodies.get_mut(slot).filter(|row| row.entity == entity)
    }
}
