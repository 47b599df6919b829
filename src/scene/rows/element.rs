//! What is kept of an element from step to step.

use super::body::BodyRow;
use super::flags::ElementFlags;
use crate::backend::{BodyId, Place};
use crate::dynamics::guide::Guide;
use crate::dynamics::kick::Memo;
use crate::dynamics::law::Law;
use crate::dynamics::tolerance::{Controller, Method, Outcome};
use crate::input::check::{Numbers, Parameters, Ties, Trouble};
use crate::input::companions::Companion;
use crate::scene::held::Inside;
use crate::scene::still::Stepped;
use bevy::ecs::entity::EntityHashMap;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use std::num::NonZeroU32;
use std::sync::Arc;

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

/// How an element was solved.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    /// Kicks, or the engine's substeps.
    pub microsteps: u32,
    /// Estimate of the error of position that the step added, m; 0 where nobody asked.
    pub error: f32,
    pub method: Method,
    /// A cap kept the step from being as fine or as exact as was asked.
    pub capped: bool,
    /// A motion of what it was solved with was to be followed, and more micro-steps would have been needed than may be.
    pub unresolved: bool,
}

impl From<Outcome> for Solved {
    fn from(outcome: Outcome) -> Self {
        Self {
            microsteps: outcome.microsteps,
            error: outcome.error.unwrap_or(0.0) as f32,
            method: outcome.method,
            capped: outcome.capped,
            unresolved: outcome.unresolved,
        }
    }
}

/// A row of a body, as a number that takes no more room where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BodyIndex(NonZeroU32);

impl BodyIndex {
    fn new(index: usize) -> Option<Self> {
        let number = u32::try_from(index).ok()?.checked_add(1)?;
        NonZeroU32::new(number).map(Self)
    }

    fn get(self) -> usize {
        self.0.get() as usize - 1
    }
}

/// One element: what every step needs, in three lines of memory. Thousands of rows do not fit into the processor's cache, and what is
/// not read need not come.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct ElementRow {
    pub entity: Entity,
    pub numbers: Numbers,
    on: [Option<BodyIndex>; 2],
    pub flags: ElementFlags,
    pub solved: Solved,
    /// Inverse of the effective mass of its ends along the line in the last step, 1/kg.
    pub inverse_mass: f64,
    /// Last length or twist,
    pub length: f64,
    /// and its rate.
    pub rate: f64,
    pub law: Option<Arc<Law>>,
    pub trouble: Trouble,
    /// What it has in the engine's solver, while that solves it.
    pub inside: Option<Box<Inside>>,
    pub rare: Box<RareElement>,
    pub ledger: EnergyLedger,
    /// Last direction from end A to end B that was well defined; zero before.
    direction: DVec3,
    /// The last coefficients.
    pub memo: Memo,
}

/// What not every step needs of an element.
#[derive(Clone, Debug)]
pub(crate) struct RareElement {
    pub ties: Ties,
    pub guide: Guide,
    pub held: [Held; 2],
    /// Where its ends were after the last step: a body's own point if elements can move it, else a point
    /// of the world.
    pub places: [Option<DVec3>; 2],
    /// How what holds its ends was turned then, where elements cannot turn it and that matters.
    pub facings: [DQuat; 2],
    /// Last twist, full turns counted.
    pub angle: f64,
    /// The bodies' scales, held against the rounding noise of their transforms.
    pub scales: [Option<DVec3>; 2],
    pub controller: Controller,
}

/// Which flag says that an end is watched.
const WATCHED: [ElementFlags; 2] = [ElementFlags::A_IS_WATCHED, ElementFlags::B_IS_WATCHED];

impl ElementRow {
    /// An inert row.
    pub(crate) fn new(entity: Entity) -> Self {
        Self {
            entity,
            numbers: Numbers::default(),
            on: [None; 2],
            flags: WATCHED[0] | WATCHED[1],
            solved: Solved::default(),
            inverse_mass: 0.0,
            length: 0.0,
            rate: 0.0,
            law: None,
            trouble: Trouble::default(),
            inside: None,
            rare: Box::new(RareElement {
                ties: Ties::NONE,
                guide: Guide::default(),
                held: [Held::NOWHERE; 2],
                places: [None; 2],
                facings: [DQuat::IDENTITY; 2],
                angle: 0.0,
                scales: [None; 2],
                controller: Controller::default(),
            }),
            ledger: EnergyLedger::default(),
            direction: DVec3::ZERO,
            memo: Memo::default(),
        }
    }

    pub(crate) fn has(&self, flags: ElementFlags) -> bool {
        self.flags.contains(flags)
    }

    /// Index of the body that it moves at an end.
    #[inline(always)]
    pub(crate) fn movable(&self, end: usize) -> Option<usize> {
        self.on[end].map(BodyIndex::get)
    }

    /// Indices of all bodies that it moves.
    pub(crate) fn all_movable(&self) -> impl Iterator<Item = usize> {
        self.on.into_iter().flatten().map(BodyIndex::get)
    }

    /// Its ends that it moves, and the indices of the bodies there.
    #[inline(always)]
    pub(crate) fn movable_ends(&self) -> impl Iterator<Item = (usize, usize)> {
        let ends = self.on.into_iter().enumerate();
        ends.filter_map(|(end, on)| Some((end, on?.get())))
    }

    /// Whether it moves both of its ends, one, or none.
    pub(crate) fn moves(&self) -> usize {
        self.on.iter().flatten().count()
    }

    /// Whether its context is among those that were stepped.
    pub(crate) fn has_acted(&self, bodies: &[BodyRow], stepped: &Stepped) -> bool {
        let stepped = &stepped.worlds;
        if let Some(body) = self.movable(0).or(self.movable(1)) {
            return stepped.contains(&bodies[body].rare.context);
        }
        let context = self.rare.held.iter().find_map(|held| match held {
            Held::Body { context, .. } => Some(context),
            Held::Path { .. } => None,
        });
        context.map_or(!stepped.is_empty(), |context| stepped.contains(context))
    }

    /// Whether an end has to be looked for in every tick.
    pub(crate) fn is_watched(&self, end: usize) -> bool {
        self.has(WATCHED[end])
    }

    /// Whether some end has.
    #[inline(always)]
    pub(crate) fn is_any_watched(&self) -> bool {
        self.flags.intersects(WATCHED[0].union(WATCHED[1]))
    }

    /// Last direction from end A to end B that was well defined.
    #[inline(always)]
    pub(crate) fn direction(&self) -> Option<DVec3> {
        (self.direction != DVec3::ZERO).then_some(self.direction)
    }

    #[inline(always)]
    pub(crate) fn set_direction(&mut self, direction: Option<DVec3>) {
        self.direction = direction.unwrap_or(DVec3::ZERO);
    }

    /// All its numbers.
    pub(crate) fn parameters(&self) -> Parameters {
        Parameters {
            ties: self.rare.ties,
            numbers: self.numbers,
        }
    }

    pub(crate) fn set_parameters(&mut self, parameters: Parameters) {
        self.numbers = parameters.numbers;
        self.rare.ties = parameters.ties;
    }

    /// What stands beside it makes that of it.
    pub(crate) fn set_companion(&mut self, companion: Companion) {
        self.law = companion.law;
        self.rare.guide = companion.guide;
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
            self.rare.places = [None; 2];
        }
        self.rare.held = [Held::NOWHERE; 2];
        self.on = [None; 2];
        self.flags.insert(WATCHED[0] | WATCHED[1]);
        let found_anew = ElementFlags::PLACED
            | ElementFlags::CAPTURED
            | ElementFlags::TUNED
            | ElementFlags::ACTIVE
            | ElementFlags::IS_PLAIN
            | ElementFlags::HELD
            | ElementFlags::DOZES;
        self.flags.remove(found_anew);
        self.inverse_mass = 0.0;
        self.solved = Solved::default();
    }

    /// Holds an end where it was found.
    pub(crate) fn hold(&mut self, end: usize, place: &Place, index: &EntityHashMap<u32>) {
        self.rare.held[end] = match *place {
            Place::OnBody {
                entity,
                body,
                context,
                local,
            } => {
                let ties = &self.rare.ties;
                let direct = entity == ties.ends[end] && ties.anchors[end] == Vec3::ZERO;
                self.flags.set(WATCHED[end], !direct);
                let index = index.get(&entity);
                self.on[end] = index.and_then(|index| BodyIndex::new(*index as usize));
                Held::Body {
                    body,
                    context,
                    local,
                }
            }
            Place::Point(to) => Held::Path {
                from: self.rare.places[end].unwrap_or(to),
                to,
            },
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::rows::body::BodyRow;

    #[test]
    fn a_row_is_what_a_step_reads_of_it() {
        assert_eq!(size_of::<ElementRow>(), 192);
        assert_eq!(size_of::<BodyRow>(), 64);
    }
}
