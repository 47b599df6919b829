//! Data of an element that the engine's own solver solves. The backend decides when that is necessary (`rapier::held`).

mod joint;
mod twist;

pub(crate) use joint::{Along, Joints, KeptJoint, SoftJoint, SoftJoints, WantedJoints};
pub(crate) use twist::Turn;

use crate::backend::BodyId;
use crate::dynamics::body::shortest;
use crate::dynamics::guide::Guide;
use crate::dynamics::line::Line;
use crate::dynamics::pieces::Pieces;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::Entity;

/// Data of an element inside the engine's solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inside {
    pub joints: Joints,
    /// Hidden bodies in the engine that stand for ends without a rigid body.
    pub hidden: [Option<BodyId>; 2],
    /// The context that contains the joints and hidden bodies.
    pub context: Option<Entity>,
    /// Whether the element acts in the coming step.
    pub active: bool,
    pub pieces: Pieces,
    /// Length at the start of the step, m; twist of a torsion element, rad.
    pub from: f64,
    pub direction: DVec3,
    /// Positions of its ends at the start of the step, m.
    pub places: [DVec3; 2],
    /// Rotations, at the start of the step, of the bodies at its ends.
    pub facings: [DQuat; 2],
    /// Mean rates of its length over the last step and over the step before that, m/s.
    pub rates: Option<[f64; 2]>,
    /// Energy that its bodies got beyond what its law gives, J. Later steps take it back.
    pub debt: f64,
    pub turn: Option<Turn>,
    /// Whether its twist differs from the rotation of its bodies: see [`twist`].
    pub slipped: bool,
    pub leeway: Leeway,
}

/// Inverse effective mass of an element whose bodies joints and contacts hold.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Leeway {
    /// Inverse effective mass that joints and contacts leave, 1/kg.
    pub left: f64,
    /// Share of the inverse mass of the free element that joints alone would leave.
    pub jointed: f64,
    /// Whether these numbers are final. Before its first step they are not, because the engine does not know the contacts yet.
    pub known: bool,
    /// For each end, whether a joint held it and whether a contact pressed it when the numbers were computed.
    pub by: [(bool, bool); 2],
    /// For each end, the sum of inverse masses and moments of inertia of its body when the numbers were computed.
    pub masses: [f64; 2],
    /// Number of steps since the numbers were computed.
    pub age: u32,
}

/// Number of steps after which a [`Leeway`] is computed again in any case, because joints and contacts of an element shift: about
/// a second. Pinned by `held::tests`.
const OLD: u32 = 64;
/// Least number of steps before a [`Leeway`] is computed again after a joint or contact let go. A drumming foot lets go in every
/// other step. Pinned by `held::tests`.
const YOUNG: u32 = 8;

impl Default for Leeway {
    fn default() -> Self {
        Self {
            left: 0.0,
            jointed: 1.0,
            known: false,
            by: Default::default(),
            masses: [0.0; 2],
            age: 0,
        }
    }
}

impl Leeway {
    /// Counts a step. Returns whether the numbers must be computed again. `by` and `masses` are those of now, and `known` says
    /// whether contacts are known.
    pub(crate) fn is_due(&mut self, by: [(bool, bool); 2], masses: [f64; 2], known: bool) -> bool {
        self.age = self.age.saturating_add(1);
        let mut ends = self.by.iter().zip(by);
        let more = ends.any(|(old, new)| (new.0 && !old.0) || (new.1 && !old.1));
        let fewer = self.age >= YOUNG && self.by != by;
        let other = self.masses != masses;
        let due = !self.known || self.age >= OLD || more || fewer || other;
        if due {
            (self.by, self.masses, self.age, self.known) = (by, masses, 0, known);
        }
        due
    }
}

impl Inside {
    /// Stores the state of the element at the start of a step, and its force over the step.
    pub(crate) fn begin(&mut self, from: f64, pieces: Pieces, line: &Line, facings: [DQuat; 2]) {
        self.facings = facings;
        self.from = from;
        self.pieces = pieces;
        self.direction = line.direction;
        self.places = line.holds.map(|hold| hold.position);
    }

    /// Returns the length after a step: for a torsion element its twist, for others the measured length `seen`. `facings` are the
    /// rotations of the bodies at its ends now, `energy` gives the stored energy at a twist.
    pub(crate) fn wound(
        &mut self,
        facings: [DQuat; 2],
        seen: f64,
        time: f64,
        energy: impl Fn(f64) -> f64,
    ) -> f64 {
        let relative = facings[0].inverse() * facings[1];
        let Some(turn) = &self.turn else {
            return seen;
        };
        let (length, slipped) =
            turn.arrive([self.from, seen], relative, self.slipped, time, energy);
        self.slipped = slipped;
        length
    }

    /// Rotation of an end's body over the step.
    fn turned(&self, end: usize, facings: [DQuat; 2]) -> DQuat {
        facings[end] * self.facings[end].inverse()
    }

    /// Displacement over the step of the point at which an element acts on the body at an end, m, or for a torsion element the
    /// rotation of the body, rad. Returns none if that is zero. `places` and `facings` are the positions of the ends and the
    /// rotations of their bodies now.
    pub(crate) fn moved(
        &self,
        guide: Guide,
        end: usize,
        places: [DVec3; 2],
        facings: [DQuat; 2],
    ) -> Option<DVec3> {
        let turned = self.turned(end, facings);
        if self.turn.is_some() {
            let by = shortest(turned).to_scaled_axis();
            return (by != DVec3::ZERO).then_some(by);
        }
        let mut by = places[end] - self.places[end];
        if end == 0 && matches!(guide, Guide::OfA(_)) {
            // It acts on A at the point of end B: at the one that is there in the middle of the step.
            let arm = 0.5 * (self.places[1] - self.places[0] + places[1] - places[0]);
            by += 0.5 * (turned * arm - turned.inverse() * arm);
        }
        (by != DVec3::ZERO).then_some(by)
    }

    /// Mean direction over the step. An end that moves across the element, or turns its axis, does no work by that.
    pub(crate) fn way(&self, guide: Guide, places: [DVec3; 2], facings: [DQuat; 2]) -> DVec3 {
        let now = match guide {
            Guide::Centres => (places[1] - places[0]).try_normalize(),
            Guide::OfA(_) => Some(self.turned(0, facings) * self.direction),
            Guide::World(_) | Guide::Twist(_) => None,
        };
        now.map_or(self.direction, |now| 0.5 * (self.direction + now))
    }
}

#[cfg(test)]
mod tests;
