//! All that the springs' next step depends on and that no component says, as plain data.
//!
//! Going back, rows are made anew from the components, as they are for elements that are new, and then given what they
//! remembered. So only memory is kept: laws, ends, components of the scene and coefficients come out the same to the last
//! bit.

mod inside;
mod map;
mod memory;

use crate::backend::BodyId;
use crate::dynamics::step::Remembered;
use crate::dynamics::tolerance::Controller;
use crate::readout::SpringReadout;
use crate::scene::held::{KeptJoint, Leeway};
use crate::scene::rows::{BodyFlags, ElementFlags, EnergyLedger, Raised, Rest, Sweeps};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy::prelude::Entity;

/// No body.
pub(crate) const NONE: u32 = u32::MAX;

/// What is kept of a scene.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Kept {
    pub(crate) contexts: Vec<KeptContext>,
    /// Component by component, in the order in which each solves them; then those that are in none.
    pub(crate) elements: Vec<KeptElement>,
    /// Likewise.
    pub(crate) bodies: Vec<KeptBody>,
    /// Components of which more is known than their elements and bodies.
    pub(crate) groups: Vec<KeptGroup>,
    /// What elements that are gone have left in the engine, and in which context.
    pub(crate) left: Vec<(Entity, KeptInside)>,
    /// Bodies that no element moves any more, and what they have besides forces.
    pub(crate) unloaded: Vec<(Entity, BodyId, Raised)>,
    /// Seconds that the engine stepped in the last tick.
    pub(crate) time: f64,
    /// The engine has not gone back: what it has of ours is that of the world.
    pub(crate) engine_stays: bool,
}

/// A Rapier context.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptContext {
    pub(crate) entity: Entity,
    /// It was stepped in the last tick.
    pub(crate) stepped: bool,
    pub(crate) sweeps: Sweeps,
}

/// An element.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptElement {
    pub(crate) entity: Entity,
    /// Indices of the bodies that it moves, or [`NONE`].
    pub(crate) on: [u32; 2],
    /// Stiffness and damping that acted last, N/m and N s/m, and the rest length, m.
    pub(crate) numbers: [f32; 2],
    pub(crate) rest_length: Option<f32>,
    pub(crate) flags: ElementFlags,
    pub(crate) ledger: EnergyLedger,
    pub(crate) readout: SpringReadout,
    pub(crate) inside: Option<Box<KeptInside>>,
    pub(crate) memory: Memory,
}

/// What an element remembers.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Memory {
    /// Last direction from end A to end B that was well defined.
    pub(crate) direction: Option<DVec3>,
    /// Last length or twist.
    pub(crate) length: f64,
    pub(crate) controller: Controller,
    /// Where its ends were after the last step.
    pub(crate) places: [Option<DVec3>; 2],
    /// Last twist, full turns counted.
    pub(crate) angle: f64,
    /// How what holds its ends was turned then.
    pub(crate) facings: [DQuat; 2],
    /// The bodies' scales.
    pub(crate) scales: [Option<DVec3>; 2],
}

/// A body that elements move: all fields of its row that are not found anew.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptBody {
    pub(crate) entity: Entity,
    pub(crate) rank: u64,
    pub(crate) flags: BodyFlags,
    /// Its second substep is ours.
    pub(crate) raised_iterations: bool,
    /// s.
    pub(crate) lingers: f32,
    pub(crate) clear: u8,
    /// Force (N) and torque (N m) of the user's, and of elements.
    pub(crate) user: [Vec3; 2],
    pub(crate) elements: [Vec3; 2],
    pub(crate) now: (DVec3, Vec3),
    pub(crate) rest: Rest,
    pub(crate) raised: Raised,
    /// s.
    pub(crate) substep: f64,
    pub(crate) pulled: u64,
    pub(crate) turned: u64,
}

/// A component.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptGroup {
    /// Index of one of its bodies.
    pub(crate) body: u32,
    pub(crate) held: bool,
    pub(crate) is_asleep: bool,
    /// Of one that is solved in an assembly of its own.
    pub(crate) assembly: Option<Box<Remembered>>,
}

/// What an element has in the engine's solver.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptInside {
    pub(crate) joints: Vec<KeptJoint>,
    pub(crate) hidden: [Option<BodyId>; 2],
    pub(crate) active: bool,
    pub(crate) slipped: bool,
    pub(crate) rates: Option<[f64; 2]>,
    pub(crate) debt: f64,
    pub(crate) leeway: Leeway,
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
