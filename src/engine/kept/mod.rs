//! All that the springs' next step depends on and that no component says, as plain data.
//!
//! [`take`] reads it from the scene, [`put`] makes a scene of it again: rows are made anew from the components, as they are
//! for elements that are new, and then given what they remembered. So only memory is kept: laws, ends, components of the
//! scene and coefficients come out the same to the last bit.

mod anew;
mod check;
mod inside;
mod map;
mod put;
mod take;

pub(crate) use anew::note_engine;

use super::held::{Leeway, SoftJoint};
use super::rows::{EnergyLedger, Memory, Raised, Rest, Sweeps};
use crate::dynamics::step::Remembered;
use crate::readout::SpringReadout;
use bevy::math::{DVec3, Vec3};
use bevy::prelude::Entity;
use bevy_rapier3d::rapier::dynamics::{ImpulseJointHandle, RigidBodyHandle};

/// No body.
const NONE: u32 = u32::MAX;

/// What is kept of a scene.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Kept {
    contexts: Vec<KeptContext>,
    /// Component by component, in the order in which each solves them; then those that are in none.
    elements: Vec<KeptElement>,
    /// Likewise.
    bodies: Vec<KeptBody>,
    /// Components of which more is known than their elements and bodies.
    groups: Vec<KeptGroup>,
    /// What elements that are gone have left in the engine, and in which context.
    left: Vec<(Entity, KeptInside)>,
    /// Bodies that no element moves any more, and what they have besides forces.
    unloaded: Vec<(Entity, RigidBodyHandle, Raised)>,
    /// Seconds that the engine stepped in the last tick.
    time: f64,
    /// The engine has not gone back: what it has of ours is that of the world.
    engine_stays: bool,
}

/// A Rapier context.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct KeptContext {
    entity: Entity,
    /// It was stepped in the last tick.
    stepped: bool,
    sweeps: Sweeps,
}

/// An element.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct KeptElement {
    entity: Entity,
    /// Indices of the bodies that it moves, or [`NONE`].
    on: [u32; 2],
    /// Stiffness and damping that acted last, N/m and N s/m, and the rest length, m.
    numbers: [f32; 2],
    rest_length: Option<f32>,
    changed: bool,
    refitted: bool,
    captured: bool,
    tuned: bool,
    tuned_again: bool,
    active: bool,
    ledger: EnergyLedger,
    readout: SpringReadout,
    inside: Option<Box<KeptInside>>,
    memory: Memory,
}

/// A body that elements move: all fields of its row that are not found anew.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct KeptBody {
    entity: Entity,
    rank: u64,
    disturbed: bool,
    rests: bool,
    is_alone: bool,
    is_noted: bool,
    is_fresh: bool,
    is_new: bool,
    can_touch: bool,
    jointed: bool,
    touched: bool,
    pressed: bool,
    creeps: bool,
    carries_share: bool,
    raised_iterations: bool,
    /// s.
    lingers: f32,
    clear: u8,
    /// Force (N) and torque (N m) of the user's, and of elements.
    user: [Vec3; 2],
    elements: [Vec3; 2],
    now: (DVec3, Vec3),
    rest: Rest,
    raised: Raised,
    /// s.
    substep: f64,
    pulled: u64,
    turned: u64,
}

/// A component.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct KeptGroup {
    /// Index of one of its bodies.
    body: u32,
    held: bool,
    is_asleep: bool,
    /// Of one that is solved in an assembly of its own.
    assembly: Option<Box<Remembered>>,
}

/// What an element has in the engine's solver.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
struct KeptInside {
    joints: Vec<KeptJoint>,
    hidden: [Option<RigidBodyHandle>; 2],
    active: bool,
    slipped: bool,
    rates: Option<[f64; 2]>,
    debt: f64,
    leeway: Leeway,
}

/// A joint of ours in the engine.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct KeptJoint {
    /// Which one of its element's.
    pub place: u8,
    pub handle: ImpulseJointHandle,
    pub joint: SoftJoint,
}

impl Kept {
    /// Bytes that it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        let insides = self.elements.iter().filter_map(|e| e.inside.as_deref());
        let insides = insides.chain(self.left.iter().map(|(_, inside)| inside));
        let inside = |inside: &KeptInside| size_of::<KeptInside>() + size_of_val(&*inside.joints);
        let assemblies = self.groups.iter().filter_map(|g| g.assembly.as_deref());
        let assembly = |a: &Remembered| size_of::<Remembered>() + a.vectors() * size_of::<DVec3>();
        size_of::<Self>()
            + size_of_val(&*self.contexts)
            + size_of_val(&*self.elements)
            + size_of_val(&*self.bodies)
            + size_of_val(&*self.groups)
            + size_of_val(&*self.unloaded)
            + insides.map(inside).sum::<usize>()
            + assemblies.map(assembly).sum::<usize>()
    }
}
