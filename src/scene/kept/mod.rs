//! The data of a snapshot: everything on which the next step of the springs depends and that is not
//! in the components of entities.
//!
//! To restore a snapshot, all rows are made anew from the components, as for new elements, and then get what they
//! remembered. So a snapshot needs only that memory. Laws, ends, the components of the scene and the coefficients of
//! solvers come out the same to the last bit.

mod inside;
mod map;
mod memory;
mod sound;

use crate::backend::BodyId;
use crate::dynamics::step::Remembered;
use crate::dynamics::tolerance::Controller;
use crate::readout::SpringReadout;
use crate::scene::held::{KeptJoint, Leeway};
use crate::scene::rows::{
    BodyFlags, ElementFlags, EnergyLedger, Jump, Raised, Rest, Searched, Sweeps,
};
use bevy::math::{DQuat, DVec3, Vec3};
use bevy::prelude::Entity;

/// Index that stands for no body.
pub(crate) const NONE: u32 = u32::MAX;

/// The data of a scene.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Kept {
    pub(crate) contexts: Vec<KeptContext>,
    /// Elements, component by component, in the order in which each component solves them; then elements in no component.
    pub(crate) elements: Vec<KeptElement>,
    /// Bodies, component by component, in the order within each component.
    pub(crate) bodies: Vec<KeptBody>,
    /// Components that have data besides that of their elements and bodies.
    pub(crate) groups: Vec<KeptGroup>,
    /// Context and data of joints and hidden bodies that must still be removed from the engine, as their element no longer acts.
    pub(crate) left: Vec<(Entity, KeptInside)>,
    /// Context and handle of bodies that no element moves any more, with the settings that must still be restored.
    pub(crate) unloaded: Vec<(Entity, BodyId, Raised)>,
    /// Simulated time of the last tick, s.
    pub(crate) time: f64,
    /// Whether the engine is not restored with the springs, so that it keeps its present joints and settings.
    pub(crate) engine_stays: bool,
}

/// A Rapier context.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptContext {
    pub(crate) entity: Entity,
    /// Whether it was stepped in the last tick.
    pub(crate) stepped: bool,
    pub(crate) sweeps: Sweeps,
}

/// An element.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptElement {
    pub(crate) entity: Entity,
    /// Indices in [`Kept::bodies`] of the bodies that it moves, or [`NONE`].
    pub(crate) on: [u32; 2],
    /// Stiffness (N/m) and damping (N s/m) that acted last.
    pub(crate) numbers: [f32; 2],
    /// Rest length that acted last, m.
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
    /// See [`crate::scene::rows::RareElement::serial`].
    pub(crate) serial: u32,
    /// Last well-defined direction from end A to end B.
    pub(crate) direction: Option<DVec3>,
    /// Last length, m, or twist, rad.
    pub(crate) length: f64,
    pub(crate) controller: Controller,
    /// Positions of its ends after the last step, as in the element's row.
    pub(crate) places: [Option<DVec3>; 2],
    /// See [`crate::scene::rows::RareElement::leapt`].
    pub(crate) leapt: bool,
    /// Last twist with full turns counted, rad.
    pub(crate) angle: f64,
    /// Rotations, after the last step, of the bodies at its ends.
    pub(crate) facings: [DQuat; 2],
    /// Scales of the bodies at its ends.
    pub(crate) scales: [Option<DVec3>; 2],
    /// What the game changed while the engine was paused.
    pub(crate) jump: Jump,
}

/// A body that elements move: all fields of its row that are not found anew.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptBody {
    pub(crate) entity: Entity,
    pub(crate) rank: u64,
    pub(crate) flags: BodyFlags,
    /// Whether the crate gave it a second substep.
    pub(crate) raised_iterations: bool,
    /// Time for which it still counts as held, s.
    pub(crate) lingers: f32,
    pub(crate) clear: u8,
    pub(crate) searched: Searched,
    /// Force (N) and torque (N m) of the user.
    pub(crate) user: [Vec3; 2],
    /// Force (N) and torque (N m) of elements.
    pub(crate) elements: [Vec3; 2],
    pub(crate) now: (DVec3, Vec3),
    pub(crate) rest: Rest,
    pub(crate) raised: Raised,
    /// Substep with which the engine last solved its component, s.
    pub(crate) substep: f64,
    pub(crate) pulled: u64,
    pub(crate) turned: u64,
}

/// A component.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct KeptGroup {
    /// Index of one of its bodies in [`Kept::bodies`].
    pub(crate) body: u32,
    pub(crate) held: bool,
    pub(crate) is_asleep: bool,
    /// Memory of its assembly, if it has one.
    pub(crate) assembly: Option<Box<Remembered>>,
}

/// Data of an element in the engine's solver.
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
    /// Size in memory, bytes.
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
