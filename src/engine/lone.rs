//! Lone elements on bodies that they do not turn: read, solved and delivered some at a time.
//!
//! Most elements of most scenes are of this kind. One that has anything special (contacts,
//! joints, locked axes, ends that coincide, a sleeping end) is left to [`super::assembly`].

use super::group::{Group, Groups};
use super::point::{Flight, FreePoint, Route};
use super::rows::Members;
use super::rows::{BodyRow, ElementRow};
use super::step::Step;
use crate::dynamics::body::is_within;
use crate::dynamics::element::rounding;
use crate::dynamics::guide::Guide;
use crate::dynamics::lanes::{LANES, Lanes};
use crate::dynamics::moving::Moving;
use crate::dynamics::nonlinear_pair::NonlinearPair;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::tolerance::{Method, Outcome};
use bevy_rapier3d::rapier::dynamics::RigidBodySet;
use std::hint::black_box;

/// How many are read before they are solved: few enough to be in the first cache still when they are delivered.
pub(super) const BATCH: usize = 2 * LANES;

/// An element between reading and delivery.
struct PendingPair {
    group: usize,
    element: usize,
    points: [FreePoint; 2],
    movable: [Option<usize>; 2],
    pair: Pair,
    start: Separation,
    /// Energy at the start, where some is lost.
    energy: Option<f64>,
    restless: bool,
    /// It is solved in a lane beside others.
    plain: bool,
}

/// Elements between reading and delivery, in order, and those of them that are solved in lanes.
#[derive(Default)]
pub(super) struct Batch {
    pending: Vec<PendingPair>,
    lanes: Vec<Lanes>,
    plain: usize,
}

impl Batch {
    pub(super) fn is_full(&self) -> bool {
        self.pending.len() >= BATCH
    }
}

/// Prefetches what the next batch needs: it is looked at in every line of memory where it lies, so that all of it
/// comes at once. Read one after the other, each would be waited for.
pub(super) fn prefetch(
    groups: &Groups,
    next: usize,
    elements: &[ElementRow],
    bodies: &[BodyRow],
    set: &RigidBodySet,
) {
    let mut seen = 0;
    let awake = |group: &&Group| group.assembly.is_none() && group.dozing.is_none();
    for group in groups.list()[next..].iter().take(BATCH).filter(awake) {
        let members = groups.members(group);
        for row in members.bodies.iter().map(|b| &bodies[*b]) {
            seen ^= row.user.force.x.to_bits();
            if let Some(body) = set.get(row.handle) {
                let properties = body.mass_properties();
                seen ^= body.position().translation.x.to_bits() ^ body.linvel().x.to_bits();
                seen ^= body.user_force().x.to_bits() ^ body.angvel().x.to_bits();
                seen ^= properties.local_mprops.inv_mass.to_bits();
                seen ^= u32::from(body.locked_axes().bits()) ^ u32::from(body.is_sleeping());
                seen ^= body.additional_solver_iterations() as u32;
            }
        }
        for row in members.elements.iter().map(|e| &elements[*e]) {
            seen ^= row.parameters.stiffness.to_bits() ^ row.outcome.microsteps;
            seen ^= row.memory.length.to_bits() as u32 ^ u32::from(row.on[0].is_some());
        }
    }
    // Or else the compiler would see that nobody asks for it.
    black_box(seen);
}

impl Step {
    /// Reads the element of a group, if it is an ordinary one.
    pub(super) fn gather_lone(
        &self,
        batch: &mut Batch,
        group: usize,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        set: &RigidBodySet,
        stale: &mut bool,
    ) -> Route {
        let Some(&element) = members.elements.first() else {
            return Route::Gone;
        };
        let row = &mut elements[element];
        if row.companion.guide != Guide::Centres {
            return Route::General;
        }
        if row.on[0] == row.on[1] {
            return Route::GeneralOnce;
        }
        let time = self.plan.time;
        let movable = [0, 1].map(|end| row.movable(end));
        // In the order in which they lie in memory, so that it sees what comes.
        let mut sleepers = 0;
        let mut found = [None; 2];
        for (found, index) in found.iter_mut().zip(members.bodies) {
            let Some(body) = self.movable(set, bodies[*index].handle, stale) else {
                row.active = false;
                return Route::Gone;
            };
            bodies[*index].can_touch = !body.colliders().is_empty();
            sleepers += usize::from(body.is_sleeping());
            *found = Some((*index, body));
        }
        if sleepers > 0 {
            let disturbed = row.changed || members.bodies.iter().any(|b| bodies[*b].disturbed);
            if sleepers < members.bodies.len() || disturbed || self.has_moved(row, set) {
                return Route::GeneralOnce;
            }
            row.active = false;
            return Route::Asleep(match movable {
                [Some(a), Some(b)] if row.watched == [false; 2] => {
                    Some([bodies[a].handle, bodies[b].handle])
                }
                _ => None,
            });
        }
        let mut points = [FreePoint::default(); 2];
        for end in 0..2 {
            let body = |index| found.iter().flatten().find(|(b, _)| *b == index);
            points[end] = match movable[end].and_then(body) {
                Some(&(index, body)) => match FreePoint::of(&bodies[index], body, self) {
                    Ok(point) => point,
                    Err(reason) => return reason,
                },
                None => {
                    let (from, to) = self.path(&row.held[end], set);
                    FreePoint {
                        position: from,
                        velocity: (to - from) / time,
                        ..FreePoint::default()
                    }
                }
            };
        }
        let [a, b] = &points;
        let (d, v) = (b.position - a.position, b.velocity - a.velocity);
        let rounding = rounding(a.position, b.position);
        let rest_length = row.parameters.rest_length.map(f64::from);
        let coincide = d.length_squared() <= rounding * rounding;
        if coincide && row.memory.direction.is_none() && rest_length != Some(0.0) {
            return Route::GeneralOnce;
        }
        let length = d.length();
        let has_moved = self.has_moved(row, set);
        if has_moved {
            row.account_for_leap(length);
        }
        row.memory.length = length;
        if !row.is_sound(v, d) {
            return Route::GeneralOnce;
        }
        let inverse_mass = a.inverse_mass + b.inverse_mass;
        let omega = (row.slope() * inverse_mass).sqrt();
        let mut restless = row.changed || has_moved;
        for (b, body) in found.into_iter().flatten() {
            restless |= std::mem::take(&mut bodies[b].disturbed);
            restless |= self.is_restless(&mut bodies[b], body, omega as f32);
        }
        row.active = true;
        row.trouble.set_passing(None);
        row.inverse_mass = inverse_mass;
        let rest_length = rest_length.unwrap_or_else(|| {
            row.parameters.rest_length = Some(length as f32);
            row.captured = true;
            f64::from(length as f32)
        });
        let pair = Pair {
            stiffness: f64::from(row.parameters.stiffness),
            damping: f64::from(row.parameters.damping),
            rest_length,
            inverse_mass,
            outside: b.acceleration - a.acceleration,
            rounding,
        };
        let start = Separation::new(d, v, row.memory.direction);
        // What is lost is what its damper took: exact for a linear one at any damping.
        let damped = match &row.companion.law {
            Some(law) => law.damps(),
            None => row.parameters.damping > 0.0,
        };
        let energy = damped.then(|| row.energy_of(&pair, &start, length));
        let count = self
            .accuracy
            .plain()
            .filter(|_| row.companion.law.is_none());
        let step = count.map_or(0.0, |count| time / f64::from(count));
        let plain = count.is_some() && pair.is_plain(step);
        if plain {
            let (at, lane) = (batch.plain / LANES, batch.plain % LANES);
            if batch.lanes.len() <= at {
                batch.lanes.push(Lanes::default());
            }
            let memo = &mut row.memory.memo;
            batch.lanes[at].take_in(lane, &pair, &start, step, memo);
            batch.plain += 1;
        }
        batch.pending.push(PendingPair {
            group,
            element,
            points,
            movable,
            pair,
            start,
            energy,
            restless,
            plain,
        });
        Route::Batched
    }

    /// Takes what has been read through the step; the groups of those that need the general solver after all
    /// are added to a list.
    pub(super) fn scatter(
        &self,
        batch: &mut Batch,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        set: &mut RigidBodySet,
        failed: &mut Vec<usize>,
    ) {
        let time = self.plan.time;
        let count = self.accuracy.plain();
        if let Some(count) = count {
            for lanes in &mut batch.lanes[..batch.plain.div_ceil(LANES)] {
                lanes.run(time, count);
            }
        }
        let mut plain = 0;
        let Batch { pending, lanes, .. } = batch;
        for pending in pending.iter() {
            let row = &mut elements[pending.element];
            let together = pending.plain.then(|| {
                let (at, lane) = (plain / LANES, plain % LANES);
                plain += 1;
                lanes[at].state(lane)
            });
            let (outcome, end, length) = match together.flatten() {
                Some((end, length)) => (Outcome::plain(&self.accuracy), end, length),
                None => {
                    let (outcome, end) = self.alone(row, pending);
                    (outcome, end, end.d.length())
                }
            };
            let sound = end.d.is_finite() && end.v.is_finite();
            let Some(flights) = self.flights(pending, &end).filter(|_| sound) else {
                failed.push(pending.group);
                continue;
            };
            row.memory.direction = end.direction;
            row.outcome = Outcome {
                method: Method::ClosedForm,
                ..outcome
            };
            if let Some(before) = pending.energy {
                row.ledger.dissipated += before - row.energy_of(&pending.pair, &end, length);
            }
            self.arrive(row, pending, &flights, bodies, set);
        }
        batch.pending.clear();
        batch.plain = 0;
    }

    /// Solves one by itself.
    fn alone(&self, row: &mut ElementRow, pending: &PendingPair) -> (Outcome, Separation) {
        let (time, memory) = (self.plan.time, &mut row.memory);
        let PendingPair { pair, start, .. } = pending;
        match &row.companion.law {
            None => {
                let mut moving = Moving::new(pair, *start, &mut memory.memo);
                let outcome = memory.controller.drive(&mut moving, time, self.accuracy);
                (outcome, moving.state)
            }
            Some(law) => {
                let mut moving = NonlinearPair::new(pair, law, *start, &mut memory.memo);
                let outcome = memory.controller.drive(&mut moving, time, self.accuracy);
                (outcome, moving.state)
            }
        }
    }

    /// What takes both ends along; none if one of them would fly faster than the engine lets it.
    fn flights(&self, pending: &PendingPair, end: &Separation) -> Option<[Flight; 2]> {
        let time = self.plan.time;
        let PendingPair { pair, start, .. } = pending;
        // What the element adds to the free motion of the separation.
        let moved = end.d - start.d - time * (start.v + 0.5 * time * pair.outside);
        let sped = end.v - start.v - time * pair.outside;
        let mut flights = [Flight::default(); 2];
        for (end, flight) in flights.iter_mut().enumerate() {
            let (point, sign) = (&pending.points[end], if end == 0 { -1.0 } else { 1.0 });
            let share = sign * point.inverse_mass / pair.inverse_mass;
            let pulled = time * point.acceleration;
            *flight = Flight {
                moved: time * (point.velocity + 0.5 * pulled) + share * moved,
                velocity: point.velocity + pulled + share * sped,
                given: sign / pair.inverse_mass * sped,
            };
            let moves = pending.movable[end].is_some();
            if moves && !is_within(flight.moved, flight.velocity, self.engine.fastest, time) {
                return None;
            }
        }
        Some(flights)
    }

    /// Gives the engine what takes both bodies where the element takes them.
    fn arrive(
        &self,
        row: &mut ElementRow,
        pending: &PendingPair,
        flights: &[Flight; 2],
        bodies: &mut [BodyRow],
        set: &mut RigidBodySet,
    ) {
        for (end, flight) in flights.iter().enumerate() {
            let point = &pending.points[end];
            match pending.movable[end] {
                Some(index) => {
                    let row = &mut bodies[index];
                    row.is_alone = true;
                    self.deliver_point(row, point, flight, pending.restless, set);
                }
                // What holds this end moves it against what the other end is given.
                None => row.ledger.work -= flight.given.dot(point.velocity),
            }
        }
    }
}
