//! Continues a network of points from its last step, if only the engine has moved it since. Then only the state of its bodies is
//! read, and only their pushes are written.

use crate::backend::{Engine, Sight};
use crate::dynamics::points::{FreePoint, Points};
use crate::scene::assembly::{Assembly, State};
use crate::scene::push::Given;
use crate::scene::rows::{BodyFlags, BodyRow, Cut, ElementRow, Members, pull_mark, take};
use crate::scene::step::Step;
use crate::threads::{PIECE, beside, each, share_pieces};
use bevy::math::{DVec3, Vec3};
use std::sync::atomic::Ordering;

/// What is known of a network of points from its last step.
#[derive(Default)]
pub(crate) struct WarmStart {
    /// Ends that elements cannot move: index of the element in the component, and index of the end.
    pub ends: Vec<(usize, usize)>,
    /// Natural frequency of the stiffest element, rad/s.
    pub omega: f32,
    /// Centre of mass of each body in its own frame, m.
    pub centers: Vec<Vec3>,
    /// None for a component that never was a network of points.
    in_memory: Option<Box<InMemory>>,
    /// Whether some body has not rested long enough to sleep.
    restless: bool,
    /// Whether something other than elements may have changed the energy of the network.
    pub perturbed: bool,
}

/// Bodies and elements in the order of their rows, which is also the order of the engine's memory. Large
/// networks are read and written in this order.
#[derive(Default)]
struct InMemory {
    /// Indices of the bodies within the component, in the order of their rows.
    bodies: Vec<u32>,
    /// Indices of the elements within the component, in the order of their rows.
    elements: Vec<u32>,
    /// For each body of the component, its place in `bodies`.
    place_of: Vec<u32>,
    /// For each body in `bodies`, its acceleration by everything but elements in the last step, m/s².
    pulls: Vec<DVec3>,
    /// For each body in `bodies`, its state before the step.
    met: Vec<Met>,
    /// For each body of the component, its velocity and force.
    given: Vec<Given>,
    /// Facts about each piece of `bodies`.
    noted: Vec<Noted>,
}

/// State of a body before the step.
#[derive(Clone, Copy, Debug, Default)]
struct Met {
    point: FreePoint,
    /// Number of extra substeps for which the body asks.
    more: u32,
}

/// Facts about some bodies of the network before the step.
#[derive(Clone, Copy, Debug, Default)]
struct Noted {
    /// Whether some body needs the general solver.
    stops: bool,
    /// See [`WarmStart`].
    restless: bool,
    perturbed: bool,
    /// Whether some body was disturbed.
    disturbed: bool,
    touch_changed: bool,
    /// Number of bodies that were read.
    count: usize,
}

impl Noted {
    fn add(&mut self, other: &Self) {
        self.stops |= other.stops;
        self.restless |= other.restless;
        self.perturbed |= other.perturbed;
        self.disturbed |= other.disturbed;
        self.touch_changed |= other.touch_changed;
    }

    /// Reads a body and adds the facts about it. `center` is its centre of mass in its own frame as of the last step, `pull` its
    /// acceleration in that step. Returns none if the body needs the general solver.
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
            // Written only if it differs, because `rare` is not in the memory that every step reads.
            row.rare.pulled = pull_mark(point.acceleration);
            self.perturbed = true;
        }
        self.disturbed |= take!(row.flags, BodyFlags::DISTURBED);
        self.restless |= step.is_restless(row, &body, false, omega, sight);
        Some(Met {
            point,
            more: body.more_substeps as u32,
        })
    }
}

impl InMemory {
    /// Finds the order of bodies and elements, and copies the accelerations of the last step.
    fn line_up(&mut self, members: &Members, points: &Points) {
        for (places, rows) in [
            (&mut self.bodies, members.bodies),
            (&mut self.elements, members.elements),
        ] {
            places.clear();
            places.extend(0..rows.len() as u32);
            places.sort_unstable_by_key(|slot| rows[*slot as usize]);
        }
        self.place_of.resize(self.bodies.len(), 0);
        for (place, slot) in self.bodies.iter().enumerate() {
            self.place_of[*slot as usize] = place as u32;
        }
        self.pulls.clear();
        self.pulls.extend(
            self.bodies
                .iter()
                .map(|slot| points.origin(*slot as usize).acceleration),
        );
    }

    /// State of a body of the component.
    fn met(&self, slot: usize) -> &Met {
        &self.met[self.place_of[slot] as usize]
    }
}

/// Divides `order` into pieces and returns each with its rows. `rows` are the row indices of all members of the component.
fn pieces<'a, T>(
    order: &'a [u32],
    rows: &'a [u32],
    mut all: Cut<'a, T>,
) -> impl ExactSizeIterator<Item = (&'a [u32], Cut<'a, T>)> {
    order.chunks(PIECE).map(move |slots| {
        let end = slots
            .last()
            .map_or(0, |last| rows[*last as usize] as usize + 1);
        (slots, all.take_before(end))
    })
}

impl WarmStart {
    /// Reads all bodies. The number of threads does not change the result.
    fn meet(
        &mut self,
        step: &Step,
        members: &Members,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
    ) -> Noted {
        let (centers, omega) = (&self.centers, self.omega);
        let InMemory {
            bodies: slots,
            pulls,
            met,
            noted,
            ..
        } = &mut **self.in_memory.get_or_insert_default();
        met.resize(slots.len(), Met::default());
        noted.clear();
        noted.resize(slots.len().div_ceil(PIECE), Noted::default());
        let pieces = pieces(slots, members.bodies, bodies.again()).zip(pulls.chunks_mut(PIECE));
        let pieces = pieces.zip(met.chunks_mut(PIECE)).zip(&mut *noted);
        share_pieces(pieces, |((((slots, mut rows), pulls), met), noted)| {
            for ((slot, pull), met) in slots.iter().zip(pulls).zip(met) {
                let slot = *slot as usize;
                let (row, center) = (&mut rows[members.bodies[slot] as usize], centers[slot]);
                let Some(now) = noted.meet(step, row, center, pull, omega, sight) else {
                    noted.stops = true;
                    return;
                };
                *met = now;
                noted.count += 1;
            }
        });
        let mut all = Noted::default();
        noted.iter().for_each(|noted| all.add(noted));
        all
    }

    /// Marks the bodies that were read, because they are read once more in this step.
    fn mark_counted(&self, members: &Members, bodies: &mut Cut<BodyRow>) {
        let Some(in_memory) = &self.in_memory else {
            return;
        };
        let pieces = in_memory.bodies.chunks(PIECE).zip(&in_memory.noted);
        for slot in pieces.flat_map(|(slots, noted)| &slots[..noted.count]) {
            let row = &mut bodies[members.bodies[*slot as usize] as usize];
            row.flags.insert(BodyFlags::COUNTED);
        }
    }

    /// Forgets the bodies before they are read anew.
    pub(crate) fn begin(&mut self) {
        self.centers.clear();
        if let Some(in_memory) = &mut self.in_memory {
            in_memory.bodies.clear();
        }
    }
}

impl Assembly {
    /// Reads the network, if it can continue from its last step. Returns whether it can.
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
            // Reading the bodies has cleared their flags, so set the flag again on one of them.
            if let Some(first) = members.bodies.first().filter(|_| disturbed) {
                bodies[*first as usize].flags.insert(BodyFlags::DISTURBED);
            }
            self.warm.mark_counted(members, bodies);
            return false;
        }
        self.warm.restless |= disturbed;
        self.component.is_warm = true;
        self.component.perturbed = self.warm.perturbed;
        self.state = State::Ready;
        true
    }

    /// Places bodies and ends. Returns none if the network cannot continue from its last step.
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
        let in_memory = warm.in_memory.get_or_insert_default();
        if in_memory.bodies.is_empty() {
            in_memory.line_up(members, points);
        }
        let noted = warm.meet(step, members, bodies, sight);
        self.touch_changed |= noted.touch_changed;
        warm.perturbed |= noted.perturbed;
        warm.restless = noted.restless;
        *disturbed |= noted.disturbed;
        if noted.stops {
            return None;
        }
        let in_memory = warm.in_memory.as_deref()?;
        if !points.place(|slot| &in_memory.met(slot).point) {
            return None;
        }
        for (index, (element, end)) in warm.ends.iter().enumerate() {
            let row = &elements[members.elements[*element] as usize];
            let has_moved = step.has_moved(row, sight);
            warm.perturbed |= has_moved;
            *disturbed |= has_moved;
            let [from, to] = step.path(&row.rare.held[*end], sight);
            if has_moved && (from == to || Step::has_leapt(row, *end, from)) {
                // The end has leapt. Only the general solver computes the work of that.
                return None;
            }
            points.place_end(index, from, (to - from) / time);
        }
        Some(())
    }

    /// Gives each body its push, and stores the results of the elements.
    pub(crate) fn deliver_warm(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
    ) {
        let WarmStart {
            in_memory,
            restless,
            ..
        } = &mut self.warm;
        let (Some(points), Some(in_memory)) = (self.component.warm_points(), in_memory) else {
            return;
        };
        let mut given = std::mem::take(&mut in_memory.given);
        given.resize(members.bodies.len(), Given::default());
        each(&mut given, |slot, given| {
            let more = in_memory.met(slot).more as usize;
            let (origin, moved) = (points.origin(slot), points.step_of(slot));
            *given = step.push_point(more, &origin, &moved).into();
        });
        let give = || {
            for (slot, met) in in_memory.bodies.iter().zip(&in_memory.met) {
                let row = &mut bodies[members.bodies[*slot as usize] as usize];
                let second_substep = step.terms(met.more as usize).second_substep;
                let push = given[*slot as usize].push(*restless, second_substep);
                row.give(&push, step.tick, engine);
            }
        };
        step.delivered.store(true, Ordering::Relaxed);
        let pieces = pieces(&in_memory.elements, members.elements, Cut::all(elements));
        let solved = self.outcome.into();
        beside(give, pieces, |(slots, mut rows)| {
            for slot in slots.iter().map(|slot| *slot as usize) {
                let row = &mut rows[members.elements[slot] as usize];
                let (direction, heat, work) = points.result(slot);
                row.solved = solved;
                row.ledger.dissipated += heat;
                row.ledger.work += work;
                row.set_direction(direction);
            }
        });
        in_memory.given = given;
    }
}
