//! What an element has inside the engine's solver: the engine's room decides about it.

mod joint;
mod twist;

pub(crate) use joint::{Along, Joints, KeptJoint, SoftJoint, SoftJoints, Wanted};
pub(crate) use twist::Turn;

use crate::backend::BodyId;
use crate::dynamics::body::shortest;
use crate::dynamics::line::Line;
use crate::dynamics::pieces::Pieces;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::Entity;

/// What an element has inside the engine's solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inside {
    pub joints: Joints,
    /// Bodies of the engine that stand for ends which are none.
    pub hidden: [Option<BodyId>; 2],
    /// The context in which that is.
    pub context: Option<Entity>,
    /// It acts in the coming step.
    pub active: bool,
    pub pieces: Pieces,
    /// Length at the start of the step.
    pub from: f64,
    pub direction: DVec3,
    /// Where its ends were then, and how what holds them was turned.
    pub places: [DVec3; 2],
    pub facings: [DQuat; 2],
    /// Mean rates over the last step and the one before.
    pub rates: Option<[f64; 2]>,
    /// Energy that its bodies have been given beyond what the law has, J.
    pub debt: f64,
    pub turn: Option<Turn>,
    /// Its twist is not what the bodies show: see [`twist`].
    pub slipped: bool,
    pub leeway: Leeway,
}

/// What joints and contacts have left of an element's inverse mass.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Leeway {
    /// 1/kg.
    pub left: f64,
    /// Share of it that joints alone would leave.
    pub jointed: f64,
    /// It is that of a step in which all that holds it was known.
    pub known: bool,
    /// What held its ends then,
    pub by: [(bool, bool); 2],
    /// and how many steps ago that was.
    pub age: u32,
}

/// Steps after which it is looked for anew, for what holds an element shifts; and after how few, where something has let
/// go of it: a foot that drums does so in every other step.
const OLD: u32 = 64;
const YOUNG: u32 = 8;

impl Default for Leeway {
    fn default() -> Self {
        Self {
            left: 0.0,
            jointed: 1.0,
            known: false,
            by: Default::default(),
            age: 0,
        }
    }
}

impl Leeway {
    /// Takes a step; says whether it is to be looked for anew, with such holds.
    pub(crate) fn is_due(&mut self, by: [(bool, bool); 2], known: bool) -> bool {
        self.age += 1;
        let mut ends = self.by.iter().zip(by);
        let more = ends.any(|(old, new)| (new.0 && !old.0) || (new.1 && !old.1));
        let fewer = self.age >= YOUNG && self.by != by;
        let due = !self.known || self.age >= OLD || more || fewer;
        if due {
            (self.by, self.age, self.known) = (by, 0, known);
        }
        due
    }
}

impl Inside {
    /// Notes what it is to do.
    pub(crate) fn begin(&mut self, from: f64, pieces: Pieces, line: &Line, facings: [DQuat; 2]) {
        self.facings = facings;
        self.from = from;
        self.pieces = pieces;
        self.direction = line.direction;
        self.places = line.holds.map(|hold| hold.position);
    }

    /// The length after a step that seems to have led there, with what holds both ends turned like this: that of a
    /// torsion element is what it has been wound up to.
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

    /// Whether its twist is another than its bodies show.
    pub(crate) fn has_slipped(&self) -> bool {
        self.slipped
    }

    /// How far an end has been moved over the step that is there now, or what holds it has been turned.
    pub(crate) fn moved(&self, end: usize, place: DVec3, facing: DQuat) -> Option<DVec3> {
        let by = match &self.turn {
            Some(_) => shortest(facing * self.facings[end].inverse()).to_scaled_axis(),
            None => place - self.places[end],
        };
        (by != DVec3::ZERO).then_some(by)
    }
}
