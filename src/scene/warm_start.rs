//! A network of points that only the engine has moved since its last step goes on as it is: no more is read
//! than where its bodies are, and no more written than what they are given.

use crate::backend::{Engine, Sight};
use crate::dynamics::points::{FreePoint, Points};
use crate::scene::assembly::{Assembly, State};
use crate::scene::push::Given;
use crate::scene::rows::{BodyFlags, BodyRow, Cut, ElementRow, Members, pull_mark, take};
use crate::scene::step::Step;
use crate::threads::{PIECE, share};
use bevy::math::{DVec3, Vec3};
use std::sync::atomic::Ordering;

/// What is known of such a network.
#[derive(Default)]
pub(crate) struct WarmStart {
    /// Ends that elements cannot move: which element's within the component, and which of its two.
    pub ends: Vec<(usize, usize)>,
    /// Natural frequency of the stiffest element.
    pub omega: f32,
    /// Where each body's centre of mass is in its own frame.
    pub centers: Vec<Vec3>,
    /// Places of its bodies within the component in the order of their rows, which is that of the engine's memory: large networks
    /// are read and written in that.
    in_memory: Vec<u32>,
    /// Acceleration of each by everything but elements in the last step, in that order,
    pulls: Vec<DVec3>,
    /// and how many substeps it asked for beyond those of all, in the component's.
    more: Vec<u32>,
    /// What each is given, in the component's order.
    given: Vec<Given>,
    /// How each is now, in the order of memory,
    met: Vec<Met>,
    /// and what was noted of each piece of them.
    noted: Vec<Noted>,
    /// Some body has not rested for long.
    restless: bool,
    /// Something else than elements can have changed what it has.
    pub perturbed: bool,
}

/// A body of it before a step.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    point: FreePoint,
    /// Substeps beyond those of all.
    more: u32,
}

/// What was noted of bodies of it before a step.
#[derive(Clone, Copy, Debug, Default)]
struct Noted {
    /// Some of them needs the general solver.
    stops: bool,
    /// See [`WarmStart`].
    restless: bool,
    perturbed: bool,
    /// Something was done to some of them.
    disturbed: bool,
    touch_changed: bool,
}

impl Noted {
    fn add(&mut self, other: &Self) {
        self.stops |= other.stops;
        self.restless |= other.restless;
        self.perturbed |= other.perturbed;
        self.disturbed |= other.disturbed;
        self.touch_changed |= other.touch_changed;
    }

    /// Takes a note of a body whose centre of mass was there in its own frame and that was pulled so. None if it needs the
    /// general solver.
    #[inline(always)]
    fn meet(
        &mut self,
        step: &Step,
        row: &mut BodyRow,
        center: Vec3,
        pull: &mut DVec3,
        omega: f32,
        sight: &impl Sight,
    ) -> Option<Met> {
        let body = sight.see(row.id)?;
        let same = center == body.local_center;
        if !body.is_movable || body.is_asleep || body.is_locked || !same {
            return None;
        }
        self.touch_changed |= row.notice_colliders(body.can_touch);
        let point = row.point(&body);
        self.perturbed |= row.was_perturbed(&body, point.position);
        if std::mem::replace(pull, point.acceleration) != point.acceleration {
            // Written only then: it lies apart from what every step needs.
            row.rare.pulled = pull_mark(point.acceleration);
            self.perturbed = true;
        }
        self.disturbed |= take!(row.flags, BodyFlags::DISTURBED);
        self.restless |= step.is_restless(row, &body, omega, sight);
        Some(Met {
            point,
            more: body.more_substeps as u32,
        })
    }
}

impl WarmStart {
    /// Reads all bodies; how many threads there are changes nothing of what comes out.
    fn meet(
        &mut self,
        step: &Step,
        members: &Members,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
    ) -> Noted {
        let count = self.in_memory.len();
        self.met.resize(count, Met::default());
        self.noted.clear();
        self.noted.resize(count.div_ceil(PIECE), Noted::default());
        let (centers, omega) = (&self.centers, self.omega);
        let row_of = |slot: u32| members.bodies[slot as usize] as usize;
        // The rows of each piece, cut off those of the next.
        let mut rest = bodies.again();
        let slots = self.in_memory.chunks(PIECE);
        let pieces = slots.zip(self.pulls.chunks_mut(PIECE));
        let pieces = pieces.zip(self.met.chunks_mut(PIECE)).zip(&mut self.noted);
        let pieces = pieces.map(|(((slots, pulls), met), noted)| {
            let end = slots.last().map_or(0, |last| row_of(*last) + 1);
            (slots, pulls, met, noted, rest.take_before(end))
        });
        share(pieces, |(slots, pulls, met, noted, mut rows)| {
            for ((slot, pull), met) in slots.iter().zip(pulls).zip(met) {
                let (row, center) = (&mut rows[row_of(*slot)], centers[*slot as usize]);
                let Some(now) = noted.meet(step, row, center, pull, omega, sight) else {
                    noted.stops = true;
                    return;
                };
                *met = now;
            }
        });
        let mut all = Noted::default();
        self.noted.iter().for_each(|noted| all.add(noted));
        all
    }

    /// Forgets what was known of its bodies: they are read anew.
    pub(crate) fn begin(&mut self) {
        self.centers.clear();
        self.in_memory.clear();
    }

    /// Takes in which bodies there are, and how they were at the start of the last step.
    fn line_up(&mut self, members: &Members, points: &Points) {
        let count = members.bodies.len();
        self.in_memory.extend(0..count as u32);
        self.in_memory
            .sort_unstable_by_key(|slot| members.bodies[*slot as usize]);
        self.pulls.clear();
        self.pulls.extend(
            self.in_memory
                .iter()
                .map(|slot| points.origin(*slot as usize).acceleration),
        );
        self.more.clear();
        self.more.resize(count, 0);
    }
}

impl Assembly {
    /// Takes the network in, if it can go on as it is.
    pub(crate) fn continue_warm(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &Cut<ElementRow>,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
    ) -> bool {
        self.component.is_warm = false;
        self.warm.perturbed = false;
        if self.component.elements.len() != members.elements.len() {
            return false;
        }
        let mut disturbed = false;
        let goes_on = self.place(step, members, elements, bodies, sight, &mut disturbed);
        if goes_on.is_none() {
            // What has been taken note of is not lost.
            if let Some(first) = members.bodies.first() {
                let row = &mut bodies[*first as usize];
                if disturbed {
                    row.flags.insert(BodyFlags::DISTURBED);
                }
            }
            return false;
        }
        self.warm.restless |= disturbed;
        self.component.is_warm = true;
        self.component.perturbed = self.warm.perturbed;
        self.state = State::Ready;
        true
    }

    /// Places bodies and ends; none if some body needs the general solver.
    fn place(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &Cut<ElementRow>,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
        disturbed: &mut bool,
    ) -> Option<()> {
        let warm = &mut self.warm;
        let time = step.plan.time;
        let points = self.component.points_to_continue(time)?;
        if warm.in_memory.is_empty() {
            warm.line_up(members, points);
        }
        let noted = warm.meet(step, members, bodies, sight);
        self.touch_changed |= noted.touch_changed;
        warm.perturbed |= noted.perturbed;
        warm.restless = noted.restless;
        *disturbed |= noted.disturbed;
        if noted.stops {
            return None;
        }
        for (slot, met) in warm.in_memory.iter().zip(&warm.met) {
            let slot = *slot as usize;
            warm.more[slot] = met.more;
            if !points.place(slot, &met.point) {
                return None;
            }
        }
        for (index, (element, end)) in warm.ends.iter().enumerate() {
            let row = &elements[members.elements[*element] as usize];
            let has_moved = step.has_moved(row, sight);
            warm.perturbed |= has_moved;
            *disturbed |= has_moved;
            let [from, to] = step.path(&row.rare.held[*end], sight);
            if has_moved && from == to {
                // It has leapt: what work that was is to be found.
                return None;
            }
            points.place_end(index, from, (to - from) / time);
        }
        Some(())
    }

    /// Gives the engine what takes the bodies on.
    pub(crate) fn deliver_warm(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
    ) {
        let points = self.component.warm_points();
        let WarmStart {
            in_memory,
            more,
            given,
            restless,
            ..
        } = &mut self.warm;
        given.resize(more.len(), Given::default());
        let pieces = given.chunks_mut(PIECE).zip(more.chunks(PIECE)).enumerate();
        share(pieces, |(piece, (given, more))| {
            for (at, (given, more)) in given.iter_mut().zip(more).enumerate() {
                let slot = piece * PIECE + at;
                let (origin, flight) = (points.origin(slot), points.flight(slot));
                *given = step.push_point(*more as usize, &origin, &flight).into();
            }
        });
        for slot in in_memory.iter().map(|slot| *slot as usize) {
            let row = &mut bodies[members.bodies[slot] as usize];
            let push = given[slot].push(*restless, step.terms(more[slot] as usize).second_substep);
            row.give(&push, step.tick, engine);
        }
        step.delivered.store(true, Ordering::Relaxed);
        for (e, (direction, heat, work)) in members.elements.iter().zip(points.take_results()) {
            let row = &mut elements[*e as usize];
            row.solved = self.outcome.into();
            row.ledger.dissipated += heat;
            row.ledger.work += work;
            row.set_direction(direction);
        }
    }
}
