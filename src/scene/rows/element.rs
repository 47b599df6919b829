//! The row of an element: what is kept of it from step to step.

use super::body::BodyRow;
use super::flags::ElementFlags;
use crate::backend::{BodyId, Place};
use crate::dynamics::guide::Guide;
use crate::dynamics::kick::Memo;
use crate::dynamics::law::Law;
use crate::dynamics::single;
use crate::dynamics::tolerance::{Controller, Method, Outcome};
use crate::input::check::{Numbers, Parameters, Ties, Trouble};
use crate::input::companions::Companion;
use crate::scene::held::Inside;
use crate::scene::still::Stepped;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use std::num::NonZeroU32;
use std::sync::Arc;

/// What holds an end of an element.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Held {
    /// A rigid body, movable or not. `local` is the held point in the body's frame, m.
    Body {
        body: BodyId,
        context: Entity,
        local: DVec3,
    },
    /// An entity without a rigid body. Over the coming step the end moves to where the game has just put the entity.
    Path { from: DVec3, to: DVec3 },
}

impl Held {
    pub(crate) const NOWHERE: Self = Self::Path {
        from: DVec3::ZERO,
        to: DVec3::ZERO,
    };
}

/// Energies since the element began to act, J.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct EnergyLedger {
    /// Energy that the element turned into heat.
    pub dissipated: f64,
    /// Work that changes of its parameters, and ends that something else moves, did on the element.
    pub work: f64,
}

/// How the game changed the tension of an element before a step by a change of parameters.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Jump {
    /// Change of the tension, N.
    pub by: f64,
    /// Tension after it, N.
    pub to: f64,
}

/// How an element was solved.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    /// Number of kicks, or of the engine's substeps.
    pub microsteps: u32,
    /// Estimate of the position error that the step added, m; 0 without a tolerance.
    pub error: f32,
    pub method: Method,
    /// Whether a cap kept the step from being as fine or as exact as was asked.
    pub capped: bool,
    /// Whether the stiffest motion of its component should be followed but needs more micro-steps than allowed.
    pub unresolved: bool,
}

impl From<Outcome> for Solved {
    fn from(outcome: Outcome) -> Self {
        // NaN must not be reported as a small error.
        let number = |error: f64| if error.is_nan() { f64::MAX } else { error };
        Self {
            microsteps: outcome.microsteps,
            error: single(outcome.error.map_or(0.0, number)),
            method: outcome.method,
            capped: outcome.capped,
            unresolved: outcome.unresolved,
        }
    }
}

/// Row index of a body, stored so that an `Option` of it needs no more memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BodyIndex(NonZeroU32);

impl BodyIndex {
    fn new(index: u32) -> Option<Self> {
        NonZeroU32::new(index.checked_add(1)?).map(Self)
    }

    fn get(self) -> usize {
        self.0.get() as usize - 1
    }
}

/// One element: the data that every step needs, in three cache lines. Thousands of rows do not fit into the processor's cache,
/// and data that is not read need not be loaded.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct ElementRow {
    pub entity: Entity,
    pub numbers: Numbers,
    on: [Option<BodyIndex>; 2],
    pub flags: ElementFlags,
    pub solved: Solved,
    /// Inverse effective mass of its ends along the line in the last step, 1/kg.
    pub inverse_mass: f64,
    /// Last length, m, or twist, rad.
    pub length: f64,
    /// Rate of the length, m/s, or of the twist, rad/s.
    pub rate: f64,
    pub law: Option<Arc<Law>>,
    pub trouble: Trouble,
    /// Its data in the engine's solver, while the engine solves it.
    pub inside: Option<Box<Inside>>,
    pub rare: Box<RareElement>,
    pub ledger: EnergyLedger,
    /// Last well-defined direction from end A to end B; zero if there was none yet.
    direction: DVec3,
    /// Last coefficients of the closed form.
    pub memo: Memo,
}

/// Data of an element that not every step needs.
#[derive(Clone, Debug)]
pub(crate) struct RareElement {
    /// Number of the element in the order in which elements became known; 0 if it has none yet. It decides where nothing else
    /// distinguishes two elements. Unlike an entity, it is the same in another world.
    pub serial: u32,
    pub ties: Ties,
    pub guide: Guide,
    pub held: [Held; 2],
    /// Positions of its ends after the last step, m: in the body's frame if elements can move the
    /// body, otherwise in the world frame.
    pub places: [Option<DVec3>; 2],
    /// Rotations, after the last step, of the bodies at its ends. Valid only for an element with an axis,
    /// at an end that elements cannot move.
    /// None until one of them is stored.
    pub facings: Option<Box<[DQuat; 2]>>,
    /// Whether its length is another one at once, because it was given other anchors or another axis since the last step. Valid
    /// only with [`ElementFlags::REFITTED`].
    pub leapt: bool,
    /// Last twist with full turns counted, rad.
    pub angle: f64,
    /// Valid only with [`ElementFlags::JUMPED`] or [`ElementFlags::LEADS`].
    pub jump: Jump,
    /// Scales of the bodies at its ends. They ignore the rounding noise of transforms.
    pub scales: [Option<Vec3>; 2],
    /// None while it has nothing to remember, as for an element that takes equal micro-steps.
    pub controller: Option<Box<Controller>>,
}

impl RareElement {
    pub(crate) fn facings(&self) -> [DQuat; 2] {
        self.facings
            .as_deref()
            .copied()
            .unwrap_or([DQuat::IDENTITY; 2])
    }

    pub(crate) fn set_facings(&mut self, facings: [DQuat; 2]) {
        match &mut self.facings {
            Some(known) => **known = facings,
            None if facings != [DQuat::IDENTITY; 2] => self.facings = Some(Box::new(facings)),
            None => {}
        }
    }

    pub(crate) fn controller(&self) -> Controller {
        self.controller.as_deref().copied().unwrap_or_default()
    }

    pub(crate) fn set_controller(&mut self, controller: Controller) {
        match &mut self.controller {
            Some(known) => **known = controller,
            None if controller != Controller::default() => {
                self.controller = Some(Box::new(controller));
            }
            None => {}
        }
    }
}

/// For each end, the flag that says that it must be looked for in every tick.
const WATCHED: [ElementFlags; 2] = [ElementFlags::A_IS_WATCHED, ElementFlags::B_IS_WATCHED];

impl ElementRow {
    /// A row of an element that does not act yet.
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
                serial: 0,
                ties: Ties::NONE,
                guide: Guide::default(),
                held: [Held::NOWHERE; 2],
                places: [None; 2],
                facings: None,
                leapt: false,
                angle: 0.0,
                jump: Jump::default(),
                scales: [None; 2],
                controller: None,
            }),
            ledger: EnergyLedger::default(),
            direction: DVec3::ZERO,
            memo: Memo::default(),
        }
    }

    pub(crate) fn has(&self, flags: ElementFlags) -> bool {
        self.flags.contains(flags)
    }

    /// Row index of the body at an end, if the element moves it.
    #[inline(always)]
    pub(crate) fn movable(&self, end: usize) -> Option<usize> {
        self.on[end].map(BodyIndex::get)
    }

    /// Row indices of all bodies that it moves.
    pub(crate) fn all_movable(&self) -> impl Iterator<Item = usize> {
        self.on.into_iter().flatten().map(BodyIndex::get)
    }

    /// Indices of the ends that it moves, with the row indices of the bodies there.
    #[inline(always)]
    pub(crate) fn movable_ends(&self) -> impl Iterator<Item = (usize, usize)> {
        let ends = self.on.into_iter().enumerate();
        ends.filter_map(|(end, on)| Some((end, on?.get())))
    }

    /// Number of its ends that it moves.
    pub(crate) fn moves(&self) -> usize {
        self.on.iter().flatten().count()
    }

    /// Whether its context was stepped. An element without a context acts if any context was stepped.
    pub(crate) fn has_acted(&self, bodies: &[BodyRow], stepped: &Stepped) -> bool {
        let stepped = &stepped.worlds;
        let context = self.context(bodies);
        context.map_or(!stepped.is_empty(), |context| stepped.contains(&context))
    }

    /// The context in which it acts; none if it is between two points.
    fn context(&self, bodies: &[BodyRow]) -> Option<Entity> {
        if let Some(body) = self.movable(0).or(self.movable(1)) {
            return Some(bodies[body].rare.context);
        }
        self.rare.held.iter().find_map(|held| match held {
            Held::Body { context, .. } => Some(*context),
            Held::Path { .. } => None,
        })
    }

    /// Simulated time of this tick in its context, s. `time` is that of the first context.
    #[inline(always)]
    pub(crate) fn time_of(&self, bodies: &[BodyRow], stepped: &Stepped, time: f64) -> f64 {
        if stepped.times.is_empty() {
            return time;
        }
        let own = self.context(bodies);
        let own = own.and_then(|context| stepped.times.get(&context));
        own.copied().unwrap_or(time)
    }

    /// Whether an end must be looked for in every tick.
    pub(crate) fn is_watched(&self, end: usize) -> bool {
        self.has(WATCHED[end])
    }

    /// Whether any end must be looked for in every tick.
    #[inline(always)]
    pub(crate) fn is_any_watched(&self) -> bool {
        self.flags.intersects(WATCHED[0].union(WATCHED[1]))
    }

    /// Last well-defined direction from end A to end B.
    #[inline(always)]
    pub(crate) fn direction(&self) -> Option<DVec3> {
        (self.direction != DVec3::ZERO).then_some(self.direction)
    }

    #[inline(always)]
    pub(crate) fn set_direction(&mut self, direction: Option<DVec3>) {
        self.direction = direction.unwrap_or(DVec3::ZERO);
    }

    /// Its ends, anchors and numbers.
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

    /// Whether numbers were computed for its next step, which are written back after it.
    pub(crate) fn awaits_step(&self) -> bool {
        self.flags
            .intersects(ElementFlags::TUNED | ElementFlags::POSED)
    }

    /// Sets the law and the guide that result from its companion components.
    pub(crate) fn set_companion(&mut self, companion: Companion) {
        self.law = companion.law;
        self.rare.guide = companion.guide;
    }

    /// Takes its data in the engine's solver out of the row. Also returns the context.
    pub(crate) fn take_inside(&mut self) -> Option<(Entity, Box<Inside>)> {
        let inside = self.inside.take()?;
        Some((inside.context?, inside))
    }

    /// Resets the row before its components are read anew. Keeps what is remembered of the element.
    pub(crate) fn reset(&mut self) {
        if self.trouble.lasting().is_some() {
            // The ends may have moved while the element had a fault. That must not count as a leap.
            self.rare.places = [None; 2];
        }
        self.rare.held = [Held::NOWHERE; 2];
        self.on = [None; 2];
        self.flags.insert(WATCHED[0] | WATCHED[1]);
        let found_anew = ElementFlags::PLACED
            | ElementFlags::CAPTURED
            | ElementFlags::TUNED
            | ElementFlags::POSED
            | ElementFlags::ACTIVE
            | ElementFlags::IS_PLAIN
            | ElementFlags::HELD
            | ElementFlags::DOZES;
        self.flags.remove(found_anew);
        self.inverse_mass = 0.0;
        self.solved = Solved::default();
    }

    /// Connects an end to the place where it was found. `row` is the row index of the body there, if elements can move it.
    pub(crate) fn hold(&mut self, end: usize, place: &Place, row: Option<u32>) {
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
                self.on[end] = row.and_then(BodyIndex::new);
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
