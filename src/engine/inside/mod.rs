//! What the engine holds, the engine solves: components some body of which contacts or joints hold.
//!
//! A force that is worked out for a whole step, before the engine knows of contact and joint, is explicit to them, however
//! exact it is in free flight. So each element of such a component is a soft constraint of the engine's own solver, in as
//! many substeps as it needs. A step runs [`touch`] → [`plan`] → [`write`] → (Rapier steps) → [`Inside::arrive`].
//! [`order`] says what one element is to do, [`linkage`] what mass it has then, [`twist`] what a torsion element is, [`joint`] how Rapier is told.

mod joint;
mod linkage;
mod near;
mod order;
mod plan;
mod raise;
mod touch;
mod twist;
mod write;

pub(super) use linkage::{Holding, inverse_mass};
pub(super) use near::Outlook;
pub(super) use raise::{Raised, Sweeps};
pub(super) use touch::{Crowd, Surroundings};
pub(super) use write::{Engine as EngineParts, Solver};

use super::scene::ElementRow;
use crate::dynamics::body::shortest;
use crate::dynamics::line::Line;
use crate::dynamics::soft::Tangent;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::Entity;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;
use joint::Joints;
use twist::Turn;

/// Share of what a law owes its bodies that is kept from step to step: lost energy is given back only soon after.
const KEPT: f64 = 0.8;

/// What an element has inside the engine's solver.
#[derive(Clone, Debug, Default)]
pub(super) struct Inside {
    joints: Joints,
    /// Bodies of the engine that stand for ends which are none.
    hidden: [Option<RigidBodyHandle>; 2],
    /// The context in which that is.
    pub context: Option<Entity>,
    /// It acts in the coming step.
    pub active: bool,
    tangent: Tangent,
    /// Length at the start of the step.
    from: f64,
    direction: DVec3,
    /// Where its ends were then, and how what holds them was turned.
    places: [DVec3; 2],
    facings: [DQuat; 2],
    /// Mean rates over the last step and the one before.
    rates: Option<[f64; 2]>,
    /// Energy that its bodies have been given beyond what the law has, J.
    debt: f64,
    turn: Option<Turn>,
    /// Its twist is not what the bodies show: see [`twist`].
    slipped: bool,
    leeway: Leeway,
}

/// What joints and contacts have left of an element's inverse mass.
#[derive(Clone, Copy, Debug)]
struct Leeway {
    /// 1/kg.
    left: f64,
    /// Share of it that joints alone would leave.
    jointed: f64,
    /// It is that of a step in which all that holds it was known.
    known: bool,
    /// What held its ends then,
    by: [(bool, bool); 2],
    /// and how many steps ago that was.
    age: u32,
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
    fn is_due(&mut self, by: [(bool, bool); 2], known: bool) -> bool {
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
    fn begin(&mut self, from: f64, tangent: Tangent, line: &Line, facings: [DQuat; 2]) {
        self.facings = facings;
        self.from = from;
        self.tangent = tangent;
        self.direction = line.direction;
        self.places = line.holds.map(|hold| hold.position);
    }

    /// The length after a step that seems to have led there, with what holds both ends turned like this: that of a
    /// torsion element is what it has been wound up to.
    pub(super) fn wound(
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
    pub(super) fn has_slipped(&self) -> bool {
        self.slipped
    }

    /// How far an end has been moved over the step that is there now, or what holds it has been turned.
    pub(super) fn moved(&self, end: usize, place: DVec3, facing: DQuat) -> Option<DVec3> {
        let by = match &self.turn {
            Some(_) => shortest(facing * self.facings[end].inverse()).to_scaled_axis(),
            None => place - self.places[end],
        };
        (by != DVec3::ZERO).then_some(by)
    }
}

impl ElementRow {
    /// Takes in how a step went that ended with such a length. `moved` are ends that something else moves, and how far it
    /// moved or turned them.
    pub(super) fn arrive_inside(
        &mut self,
        length: f64,
        moved: [Option<DVec3>; 2],
        time: f64,
    ) -> (f64, f64) {
        let Some(inside) = &self.inside else {
            return (length, 0.0);
        };
        let (from, tangent, direction) = (inside.from, inside.tangent, inside.direction);
        let rate = (length - from) / time;
        let middle = 0.5 * (from + length);
        let drag = self.drag(middle, rate);
        let heat = drag * rate * time;
        let won = if self.companion.law.is_some() {
            let stored = |length: f64| self.elastic(length).energy;
            stored(length) - stored(from) - tangent.work([from, length])
        } else {
            0.0
        };
        let tension = tangent.elastic(middle) + drag;
        let mut work = 0.0;
        for (by, sign) in moved.into_iter().zip([-1.0, 1.0]) {
            work += sign * tension * by.map_or(0.0, |by| by.dot(direction));
        }
        if heat.is_finite() && work.is_finite() {
            self.ledger.dissipated += heat.max(0.0);
            self.ledger.work += work;
        }
        if let Some(inside) = &mut self.inside {
            let owed = inside.debt + won;
            inside.debt = if owed < 0.0 { KEPT * owed } else { owed };
            let last = inside.rates.map_or(rate, |rates| rates[0]);
            inside.rates = Some([rate, last]);
        }
        (length, rate)
    }
}
