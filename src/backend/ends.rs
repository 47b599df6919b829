//! The ends of elements as the engine has them, and the interface that finds them before a step.

use super::BodyId;
use crate::dynamics::guide::Guide;
use crate::element::{HoldPose, SpringTuning};
use crate::input::check::{Fault, Parameters};
use bevy::ecs::entity::EntityHashSet;
use bevy::math::{DVec3, Vec3};
use bevy::prelude::Entity;

/// Where the end of an element is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Place {
    /// A point fixed to a rigid body. `local` is in the body's frame and includes the body's scale, m.
    OnBody {
        entity: Entity,
        body: BodyId,
        /// Entity of the engine's world that contains the body.
        context: Entity,
        local: DVec3,
    },
    /// The present position of an entity that is not on a rigid body, world frame, m.
    Point(DVec3),
}

/// Both ends of an element without a fault.
pub(crate) struct Found {
    pub places: [Place; 2],
    /// The body at each end, if elements can move it.
    pub movable: [Option<Movable>; 2],
}

/// How an element stands before a step.
#[derive(Clone, Copy)]
pub(crate) struct Stance<'a> {
    pub guide: Guide,
    pub places: &'a [Place; 2],
    /// Last twist of a torsion element with full turns counted, rad.
    pub angle: f64,
}

/// What the companions of an element make of its tension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowance {
    /// Constant tension, N.
    pub preload: f64,
    /// Least and greatest tension of spring and preload together, N.
    pub limits: [f64; 2],
}

impl Allowance {
    /// By how much a tension is beyond the limits, N; not above zero if it is within.
    pub(crate) fn beyond(&self, tension: f64) -> f64 {
        let [least, greatest] = self.limits;
        (least - tension).max(tension - greatest)
    }
}

/// Data about a body that elements can move.
#[derive(Clone, Copy)]
pub(crate) struct Movable {
    /// Whether the element turns the body.
    pub turns: bool,
    /// Centre of mass in the body's frame, m.
    pub center: Vec3,
    /// Sort key of the body within its component: a hash of its state when it was first found. It does not depend on the order
    /// in which bodies were spawned.
    pub rank: u64,
}

/// Finds and checks the ends of elements before the engine's step.
pub(crate) trait Finder {
    /// Finds one end.
    fn place(
        &self,
        end: Entity,
        anchor: Vec3,
        field: &'static str,
        scale: &mut Option<Vec3>,
    ) -> Result<Place, Fault>;

    /// Finds both ends, or the fault of the element. The engine has not yet recomputed the masses of the bodies in `modified`.
    fn find(
        &mut self,
        parameters: &Parameters,
        guide: Guide,
        scales: &mut [Option<Vec3>; 2],
        modified: &EntityHashSet,
    ) -> Result<Found, Fault>;

    /// Writes the coefficients that `tuning` asks for into `parameters`. `allowed` is what the spring's companions allow. Returns
    /// whether contacts may hold the ends.
    fn tune(
        &self,
        tuning: SpringTuning,
        stance: &Stance,
        allowed: Allowance,
        parameters: &mut Parameters,
    ) -> Result<bool, Fault>;

    /// Returns the tension with which the element holds its load in its present pose, and its present length, N and m
    /// (for a torsion element N m and rad).
    fn pose(&self, pose: HoldPose, stance: &Stance) -> Result<[f64; 2], Fault>;
}
