//! What is kept of an element from step to step.

use crate::backend::{BodyId, Place};
use crate::dynamics::kick::Memo;
use crate::dynamics::tolerance::{Controller, Outcome};
use crate::input::check::{Parameters, Trouble};
use crate::input::companions::Companion;
use crate::scene::held::Inside;
use crate::scene::rows::body::BodyRow;
use bevy::ecs::entity::EntityHashMap;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;

/// Where an element is held.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Held {
    /// On a rigid body, movable or not, at a point of its own frame.
    Body {
        body: BodyId,
        context: Entity,
        local: DVec3,
    },
    /// A plain entity's path over the coming step: it goes where the game has just put it.
    Path { from: DVec3, to: DVec3 },
}

impl Held {
    pub(crate) const NOWHERE: Self = Self::Path {
        from: DVec3::ZERO,
        to: DVec3::ZERO,
    };
}

/// Since the element began to act, J.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EnergyLedger {
    /// Turned into heat.
    pub dissipated: f64,
    /// Done on it by changes of its parameters and by ends that something else moves.
    pub work: f64,
}

/// One element. What every step needs stands together: thousands of rows do not fit into the processor's
/// cache, and what is not read need not come.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct ElementRow {
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
    /// The bodies that it moves, as indices into the bodies' rows.
    pub on: [Option<u32>; 2],
    pub memory: Memory,
    pub held: [Held; 2],
    /// What it has in the engine's solver, while that solves it.
    pub inside: Option<Box<Inside>>,
}

impl ElementRow {
    /// Index of the body that it moves at an end.
    pub(crate) fn movable(&self, end: usize) -> Option<usize> {
        self.on[end].map(|index| index as usize)
    }

    /// Whether its context is among those that were stepped.
    pub(crate) fn has_acted(&self, bodies: &[BodyRow], stepped: &[Entity]) -> bool {
        match self.movable(0).or(self.movable(1)) {
            Some(body) => stepped.contains(&bodies[body].context),
            None => !stepped.is_empty(),
        }
    }

    /// Whether it moves both of its ends, one, or none.
    pub(crate) fn moves(&self) -> usize {
        self.on.iter().flatten().count()
    }
}

/// What an element remembers from step to step.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub(crate) struct Memory {
    /// Last well-defined direction from end A to end B.
    pub direction: Option<DVec3>,
    /// The last coefficients, and how exact they were.
    #[cfg_attr(feature = "serialize", serde(skip))]
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

impl ElementRow {
    /// An inert row.
    pub(crate) fn new(entity: Entity) -> Self {
        Self {
            entity,
            parameters: Parameters::NONE,
            companion: Companion::default(),
            ledger: default(),
            held: [Held::NOWHERE; 2],
            watched: [true; 2],
            on: [None; 2],
            placed: false,
            trouble: Trouble::default(),
            changed: false,
            refitted: false,
            captured: false,
            tuned: false,
            tuned_again: false,
            active: false,
            memory: Memory::default(),
            inverse_mass: 0.0,
            outcome: default(),
            inside: None,
        }
    }

    /// What it has in the engine's solver, and in which context.
    pub(crate) fn take_inside(&mut self) -> Option<(Entity, Box<Inside>)> {
        let inside = self.inside.take()?;
        Some((inside.context?, inside))
    }

    /// Makes it an inert one but for what is known of the element.
    pub(crate) fn reset(&mut self) {
        if self.trouble.lasting().is_some() {
            // Where its ends were when it last acted would make a leap of today's place.
            self.memory.places = [None; 2];
        }
        self.held = [Held::NOWHERE; 2];
        self.watched = [true; 2];
        self.on = [None; 2];
        self.placed = false;
        self.captured = false;
        self.tuned = false;
        self.active = false;
        self.inverse_mass = 0.0;
        self.outcome = default();
    }

    /// Holds an end where it was found.
    pub(crate) fn hold(&mut self, end: usize, place: &Place, index: &EntityHashMap<usize>) {
        self.held[end] = match *place {
            Place::OnBody {
                entity,
                body,
                context,
                local,
            } => {
                let direct = entity == self.parameters.ends[end];
                self.watched[end] = !direct || self.parameters.anchors[end] != Vec3::ZERO;
                self.on[end] = index.get(&entity).map(|index| *index as u32);
                Held::Body {
                    body,
                    context,
                    local,
                }
            }
            Place::Point(to) => Held::Path {
                from: self.memory.places[end].unwrap_or(to),
                to,
            },
        };
    }
}
