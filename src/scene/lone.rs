//! Lone elements on bodies that they do not turn: read, solved and delivered some at a time.
//!
//! Most elements of most scenes are of this kind. One that has anything special (contacts,
//! joints, locked axes, ends that coincide, a sleeping end) is left to [`crate::scene::assembly`].

use crate::backend::{BodyId, Engine, Seen, Sight};
use crate::dynamics::body::is_within;
use crate::dynamics::element::rounding;
use crate::dynamics::guide::Guide;
use crate::dynamics::lanes::{LANES, Lanes};
use crate::dynamics::moving::Moving;
use crate::dynamics::nonlinear_pair::NonlinearPair;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::points::{Flight, FreePoint};
use crate::dynamics::tolerance::{Method, Outcome};
use crate::scene::rows::{BodyRow, ElementRow, Members};
use crate::scene::step::Step;

/// How a lone element goes through the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Route {
    /// Read; to be solved with others of its batch.
    Batched,
    /// It has no body any more that it could move.
    Gone,
    /// Asleep; and if so, only these, its bodies, can wake it.
    Asleep(Option<[BodyId; 2]>),
    /// By the general solver in this step.
    GeneralOnce,
    /// By the general solver for as long as can be seen.
    General,
}

/// How many are read before they are solved: few enough to be in the first cache still when they are delivered.
pub(crate) const BATCH: usize = 2 * LANES;

/// An element between reading and delivery.
struct PendingPair {
    group: usize,
    element: usize,
    points: [FreePoint; 2],
    seen: [Option<Seen>; 2],
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
pub(crate) struct Batch {
    pending: Vec<PendingPair>,
    lanes: Vec<Lanes>,
    plain: usize,
}

impl Batch {
    pub(crate) fn is_full(&self) -> bool {
        self.pending.len() >= BATCH
    }
}

/// The bodies that a lone element moves, with the indices of their rows.
type Bodies = [Option<(usize, Seen)>; 2];

/// The element and its motion; none where its direction or its law means nothing. Captures its rest length if need be.
#[inline(always)]
fn pair_of(
    row: &mut ElementRow,
    [a, b]: &[FreePoint; 2],
    has_moved: bool,
) -> Option<(Pair, Separation)> {
    let (d, v) = (b.position - a.position, b.velocity - a.velocity);
    let rounding = rounding(a.position, b.position);
    let rest_length = row.parameters.rest_length.map(f64::from);
    let coincide = d.length_squared() <= rounding * rounding;
    if coincide && row.memory.direction.is_none() && rest_length != Some(0.0) {
        return None;
    }
    let length = d.length();
    if has_moved {
        row.account_for_leap(length);
    }
    row.memory.length = length;
    if !row.is_sound(v, d) {
        return None;
    }
    let rest_length = rest_length.unwrap_or_else(|| {
        row.parameters.rest_length = Some(length as f32);
        row.captured = true;
        f64::from(length as f32)
    });
    let pair = Pair {
        stiffness: f64::from(row.parameters.stiffness),
        damping: f64::from(row.parameters.damping),
        rest_length,
        inverse_mass: a.inverse_mass + b.inverse_mass,
        outside: b.acceleration - a.acceleration,
        rounding,
    };
    Some((pair, Separation::new(d, v, row.memory.direction)))
}

impl Step {
    /// Reads the element of a group, if it is an ordinary one.
    pub(crate) fn gather_lone(
        &self,
        batch: &mut Batch,
        group: usize,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        sight: &impl Sight,
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
        let found = match self.find_bodies(row, members, bodies, sight, stale) {
            Ok(found) => found,
            Err(route) => return route,
        };
        let points = match self.find_points(row, &found, bodies, sight) {
            Ok(points) => points,
            Err(route) => return route,
        };
        let has_moved = self.has_moved(row, sight);
        let Some((pair, start)) = pair_of(row, &points, has_moved) else {
            return Route::GeneralOnce;
        };
        let omega = (row.slope() * pair.inverse_mass).sqrt();
        let mut restless = row.changed || has_moved;
        for (b, body) in found.into_iter().flatten() {
            restless |= std::mem::take(&mut bodies[b].disturbed);
            restless |= self.is_restless(&mut bodies[b], &body, omega as f32, sight);
        }
        row.active = true;
        row.trouble.set_passing(None);
        row.inverse_mass = pair.inverse_mass;
        // What is lost is what its damper took: exact for a linear one at any damping.
        let damped = row.is_damped();
        let energy = damped.then(|| row.energy_of(&pair, &start, row.memory.length));
        let plain = self.put_in_lane(row, batch, &pair, &start);
        batch.pending.push(PendingPair {
            group,
            element,
            points,
            seen: [0, 1].map(|end| {
                let on = row.movable(end);
                let found = found.into_iter().flatten();
                found
                    .filter(|(b, _)| Some(*b) == on)
                    .map(|(_, body)| body)
                    .next()
            }),
            movable: [0, 1].map(|end| row.movable(end)),
            pair,
            start,
            energy,
            restless,
            plain,
        });
        Route::Batched
    }

    /// The bodies that an element moves, in the order in which they lie in memory, so that it sees what comes.
    #[inline(always)]
    fn find_bodies(
        &self,
        row: &mut ElementRow,
        members: &Members,
        bodies: &mut [BodyRow],
        sight: &impl Sight,
        stale: &mut bool,
    ) -> Result<Bodies, Route> {
        let mut sleepers = 0;
        let mut found = [None; 2];
        for (found, index) in found.iter_mut().zip(members.bodies) {
            let Some(body) = self.movable(sight, bodies[*index].id, stale) else {
                row.active = false;
                return Err(Route::Gone);
            };
            bodies[*index].can_touch = body.can_touch;
            sleepers += usize::from(body.is_asleep);
            *found = Some((*index, body));
        }
        if sleepers == 0 {
            return Ok(found);
        }
        let disturbed = row.changed || members.bodies.iter().any(|b| bodies[*b].disturbed);
        if sleepers < members.bodies.len() || disturbed || self.has_moved(row, sight) {
            return Err(Route::GeneralOnce);
        }
        row.active = false;
        Err(Route::Asleep(match [0, 1].map(|end| row.movable(end)) {
            [Some(a), Some(b)] if row.watched == [false; 2] => Some([bodies[a].id, bodies[b].id]),
            _ => None,
        }))
    }

    /// Both ends as points.
    #[inline(always)]
    fn find_points(
        &self,
        row: &ElementRow,
        found: &Bodies,
        bodies: &[BodyRow],
        sight: &impl Sight,
    ) -> Result<[FreePoint; 2], Route> {
        let mut points = [FreePoint::default(); 2];
        for (end, point) in points.iter_mut().enumerate() {
            let body = |index| found.iter().flatten().find(|(b, _)| *b == index);
            *point = match row.movable(end).and_then(body) {
                Some((_, body)) if body.is_locked => return Err(Route::General),
                Some((index, body)) => bodies[*index].point(body),
                None => {
                    let [from, to] = self.path(&row.held[end], sight);
                    FreePoint {
                        position: from,
                        velocity: (to - from) / self.plan.time,
                        ..FreePoint::default()
                    }
                }
            };
        }
        Ok(points)
    }

    /// Has a linear element solved in a lane beside others, if it is plain; says whether.
    #[inline(always)]
    fn put_in_lane(
        &self,
        row: &mut ElementRow,
        batch: &mut Batch,
        pair: &Pair,
        start: &Separation,
    ) -> bool {
        let count = self.accuracy.plain();
        let Some(count) = count.filter(|_| row.companion.law.is_none()) else {
            return false;
        };
        let step = self.plan.time / f64::from(count);
        if !pair.is_plain(step) {
            return false;
        }
        let (at, lane) = (batch.plain / LANES, batch.plain % LANES);
        if batch.lanes.len() <= at {
            batch.lanes.push(Lanes::default());
        }
        batch.lanes[at].take_in(lane, pair, start, step, &mut row.memory.memo);
        batch.plain += 1;
        true
    }

    /// Takes what has been read through the step; the groups of those that need the general solver after all
    /// are added to a list.
    pub(crate) fn scatter(
        &self,
        batch: &mut Batch,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
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
            self.arrive(row, pending, &flights, bodies, engine);
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
            if moves && !is_within(flight.moved, flight.velocity, self.plan.fastest, time) {
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
        engine: &mut impl Engine,
    ) {
        for (end, flight) in flights.iter().enumerate() {
            let point = &pending.points[end];
            match pending.movable[end] {
                Some(index) => {
                    let row = &mut bodies[index];
                    row.is_alone = true;
                    if let Some(seen) = &pending.seen[end] {
                        let push = self.push_point(seen, point, flight);
                        self.deliver(row, &push, pending.restless, engine);
                    }
                }
                // What holds this end moves it against what the other end is given.
                None => row.ledger.work -= flight.given.dot(point.velocity),
            }
        }
    }
}
