//! What elements are held by, and who finds it.

use super::BodyId;
use crate::dynamics::guide::Guide;
use crate::element::{HoldPose, SpringTuning};
use crate::input::check::{Fault, Parameters};
use bevy::ecs::entity::EntityHashSet;
use bevy::math::{DVec3, Vec3};
use bevy::prelude::Entity;

/// An end, found.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// A point fixed to a rigid body, in the body's own frame (scale taken in).
    OnBody {
        entity: Entity,
        body: BodyId,
        /// The world of the engine in which the body is.
        context: Entity,
        local: DVec3,
    },
    /// A point of the world, where the entity stands now.
    Point(DVec3),
}

/// Both ends of a sound element.
pub(crate) struct Found {
    pub places: [Place; 2],
    /// The bodies at both ends that elements can move.
    pub movable: [Option<Movable>; 2],
}

/// What is found of a body that elements can move.
#[derive(Clone, Copy)]
pub(crate) struct Movable {
    /// The element turns it.
    pub turns: bool,
    /// Where it stands among the bodies of a component, whenever it was spawned: a hash of how it was first found.
    pub rank: u64,
}

/// Finds the ends of elements in the world as an engine has it before its step, and judges them.
pub(crate) trait Finder {
    /// One end.
    fn place(
        &self,
        end: Entity,
        anchor: Vec3,
        field: &'static str,
        scale: &mut Option<DVec3>,
    ) -> Result<Place, Fault>;

    /// Both ends, or what is wrong with the element. The mass of `modified` bodies is yet to be worked
    /// out anew by the engine.
    fn find(
        &mut self,
        parameters: &Parameters,
        guide: Guide,
        scales: &mut [Option<DVec3>; 2],
        modified: &EntityHashSet,
    ) -> Result<Found, Fault>;

    /// Puts the coefficients that a tuning asks for into an element's numbers; says whether contacts may hold its ends.
    fn tune(
        &self,
        tuning: SpringTuning,
        guide: Guide,
        places: &[Place; 2],
        parameters: &mut Parameters,
    ) -> Result<bool, Fault>;

    /// The tension with which an element holds its load where that is, and its length there, N and m.
    fn pose(&self, pose: HoldPose, guide: Guide, places: &[Place; 2]) -> Result<[f64; 2], Fault>;
}
