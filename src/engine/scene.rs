//! Elements and the bodies they act on, as flat arrays kept from tick to tick.

use super::assembly::Assembly;
use super::check::{Parameters, Trouble};
use super::companions::Companion;
use super::energy::EnergyLedger;
use super::forces::Share;
use super::group::Groups;
use super::inside::{Inside, Raised, Sweeps};
use super::renew::{Scratch, mix};
use super::sleep::Rest;
use super::still::Still;
use crate::dynamics::kick::Memo;
use crate::dynamics::tolerance::{Controller, Outcome};
use bevy::ecs::entity::{EntityHashMap, EntityHashSet};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_rapier3d::prelude::ExternalForce;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};

/// Where an element is held.
#[derive(Clone, Copy, Debug)]
pub(super) enum Held {
    /// On a rigid body, movable or not, at a point of its own frame.
    Body {
        handle: RigidBodyHandle,
        context: Entity,
        local: DVec3,
    },
    /// A plain entity's path over the coming step: it goes where the game has just put it.
    Path { from: DVec3, to: DVec3 },
}

impl Held {
    pub(super) const NOWHERE: Self = Self::Path {
        from: DVec3::ZERO,
        to: DVec3::ZERO,
    };
}

/// One element. What every step needs stands together: thousands of rows do not fit into the processor's
/// cache, and what is not read need not come.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct ElementRow {
    pub parameters: Parameters,
    /// A parameter or an end changed since the last tick.
    pub changed: bool,
    /// Its numbers or laws are others than in its last step.
    pub refitted: bool,
    /// The rest length was found in this tick and has to be written back.
    pub captured: bool,
    /// The coefficients were worked out in this tick and have to be written back.
    pub tuned: bool,
    /// They are to be worked out once more: contacts are known only after the first step.
    pub tuned_again: bool,
    /// Whether some body of it was stepped, or none can be: then there is something to read out.
    pub active: bool,
    /// Which ends have to be looked for in every tick: what is not a body itself can be moved by the game.
    pub watched: [bool; 2],
    /// Where its ends are is known for good: on two bodies, at the same points of them.
    pub placed: bool,
    pub entity: Entity,
    /// What stands beside it makes of it.
    pub companion: Companion,
    pub trouble: Trouble,
    /// Inverse of the effective mass of its ends along the line in the last step, 1/kg.
    pub inverse_mass: f64,
    /// How it was solved.
    pub outcome: Outcome,
    pub ledger: EnergyLedger,
    /// The bodies that it moves, as indices into [`Scene::bodies`].
    pub on: [Option<u32>; 2],
    pub memory: Memory,
    pub held: [Held; 2],
    /// What it has in the engine's solver, while that solves it.
    pub inside: Option<Box<Inside>>,
}

impl ElementRow {
    /// Index of the body that it moves at an end.
    pub(super) fn movable(&self, end: usize) -> Option<usize> {
        self.on[end].map(|index| index as usize)
    }

    /// Whether its context is among those that were stepped.
    pub(super) fn has_acted(&self, bodies: &[BodyRow], stepped: &[Entity]) -> bool {
        match self.movable(0).or(self.movable(1)) {
            Some(body) => stepped.contains(&bodies[body].context),
            None => !stepped.is_empty(),
        }
    }

    /// Whether it moves both of its ends, one, or none.
    pub(super) fn moves(&self) -> usize {
        self.on.iter().flatten().count()
    }
}

/// What an element remembers from step to step.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(super) struct Memory {
    /// Last well-defined direction from end A to end B.
    pub direction: Option<DVec3>,
    /// The last coefficients, and how exact they were.
    pub memo: Memo,
    /// Last length or twist.
    pub length: f64,
    pub controller: Controller,
    /// Where its ends were after the last step: a body's own point if elements can move it, else a point
    /// of the world.
    pub places: [Option<DVec3>; 2],
    /// Last twist, full turns counted.
    pub angle: f64,
    /// How what holds its ends was turned then, where elements cannot turn it and that matters.
    pub facings: [DQuat; 2],
    /// The bodies' scales, held against the rounding noise of their transforms.
    pub scales: [Option<DVec3>; 2],
}

/// One movable body that elements act on. What every step needs stands first: see [`ElementRow`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct BodyRow {
    pub entity: Entity,
    pub handle: RigidBodyHandle,
    /// Some element holds it off its centre of mass.
    pub turns: bool,
    /// Its mass, its elements or the user's share changed since the last step.
    pub disturbed: bool,
    /// It has been at rest since some time.
    pub rests: bool,
    /// Its only element goes through the step without an assembly.
    pub is_alone: bool,
    /// [`Self::now`] is of the last step; nobody asks for that of a body that is alone.
    pub is_noted: bool,
    /// It was stepped and has not been looked at since.
    pub is_fresh: bool,
    /// The engine has not stepped it yet.
    pub is_new: bool,
    /// It has colliders.
    pub can_touch: bool,
    /// A joint holds it,
    pub jointed: bool,
    /// something touches it,
    pub touched: bool,
    /// and pushes it,
    pub pressed: bool,
    /// so that it may go on creeping: see [`super::sleep`];
    pub creeps: bool,
    /// or did so a moment ago: it counts as held for so long still, s.
    pub lingers: f32,
    pub user: ExternalForce,
    /// What we give it over the coming step; `None` where it is not stepped by us.
    pub share: Option<Share>,
    /// The engine still has a share of ours, which it should not have while it solves the elements itself.
    pub carries_share: bool,
    pub context: Entity,
    /// Centre of mass after the last step that was noted, and its velocity.
    pub now: (DVec3, Vec3),
    /// Since when and where it has been at rest, if it is.
    pub rest: Rest,
    /// The torque of its share.
    pub torque: Vec3,
    /// What it has been given besides forces.
    pub raised: Raised,
    /// Of all its elements, N/m.
    pub stiffness: f64,
    /// The engine's substep then, s.
    pub substep: f64,
    /// Index of its component,
    pub group: u32,
    /// and its own within that.
    pub slot: usize,
    /// Its place among the bodies of its component: see [`super::find::Wanted::rank`].
    pub rank: u64,
    /// How many elements act on it.
    pub elements: u32,
    /// Which ones, as a hash; a change wakes it.
    pub signature: u64,
    /// Acceleration by everything but elements in the last step, as a hash.
    pub pulled: u64,
    /// Rotation and angular velocity after the last step that was noted, of a body that elements turn, as a hash.
    pub turned: u64,
}

impl BodyRow {
    pub(super) fn new(entity: Entity, handle: RigidBodyHandle, context: Entity) -> Self {
        Self {
            entity,
            handle,
            context,
            turns: false,
            rank: 0,
            elements: 0,
            signature: 0,
            disturbed: true,
            group: u32::MAX,
            slot: 0,
            is_new: true,
            can_touch: true,
            jointed: false,
            touched: false,
            pressed: false,
            creeps: false,
            lingers: 0.0,
            user: ExternalForce::default(),
            share: None,
            carries_share: false,
            rests: false,
            is_alone: false,
            is_noted: true,
            is_fresh: false,
            rest: Rest::default(),
            torque: Vec3::ZERO,
            raised: Raised::default(),
            stiffness: 0.0,
            substep: 0.0,
            now: (DVec3::ZERO, Vec3::ZERO),
            turned: 0,
            pulled: 0,
        }
    }

    /// Whether something else than the engine's step has moved it, now that its centre of mass is here.
    pub(super) fn was_displaced(&self, at: DVec3) -> bool {
        !self.is_noted || self.now.0 != at
    }

    /// Whether something else than elements and the engine's step can have changed its energy since the last step,
    /// now that its centre of mass is here; but for what acts on it.
    pub(super) fn was_driven(&self, body: &RapierBody, at: DVec3) -> bool {
        let goes_on = !self.was_displaced(at)
            && self.now.1 == body.linvel()
            && (!self.turns || self.turned == turning_mark(body));
        !goes_on || self.disturbed
    }

    /// Position and velocity of its centre of mass after the last step that was noted.
    pub(super) fn place(&self) -> (DVec3, DVec3) {
        (self.now.0, self.now.1.as_dvec3())
    }
}

/// Rotation and angular velocity of a body, as a hash.
pub(super) fn turning_mark(body: &RapierBody) -> u64 {
    let [x, y, z, w] = body.position().rotation.to_array();
    let [a, b, c] = body.angvel().to_array();
    let bits = [x, y, z, w, a, b, c].map(|x| u64::from(x.to_bits()));
    bits.into_iter().fold(0, |sum, bits| mix(sum ^ bits))
}

/// An acceleration, as a hash.
pub(super) fn pull_mark(acceleration: DVec3) -> u64 {
    let bits = acceleration.to_array().map(f64::to_bits);
    bits.into_iter().fold(0, |sum, bits| mix(sum ^ bits))
}

/// The scene as the engine's step sees it.
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
