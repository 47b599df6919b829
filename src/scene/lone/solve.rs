//! Reads lone elements and solves them. Nothing is written but their own rows and what has become of them.

use super::{Given, Route, Way};
use crate::backend::{Seen, Sight};
use crate::dynamics::body::is_within;
use crate::dynamics::element::rounding;
use crate::dynamics::lanes::{LANES, Lanes};
use crate::dynamics::moving::Moving;
use crate::dynamics::nonlinear_pair::NonlinearPair;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::points::{Flight, FreePoint};
use crate::dynamics::tolerance::{Method, Outcome};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Solved};
use crate::scene::step::Step;

/// How many are read before they are solved.
const BATCH: usize = 2 * LANES;

/// An element between reading and solving.
struct Pending {
    /// Its place among those of the worker.
    at: usize,
    points: [FreePoint; 2],
    /// Substeps beyond those of all of the bodies at both ends; none of an end that it does not move.
    moves: [Option<usize>; 2],
    pair: Pair,
    start: Separation,
    /// Energy at the start, where some is lost.
    energy: Option<f64>,
    /// It is solved in a lane beside others.
    plain: bool,
}

/// What reads and solves a piece of all lone elements, kept from step to step.
#[derive(Default)]
pub(crate) struct Worker {
    pending: Vec<Pending>,
    lanes: Vec<Lanes>,
    plain: usize,
    /// Some body can be moved no more.
    pub stale: bool,
}

/// The bodies that a lone element moves, as they are; none at an end that it does not.
type Ends = [Option<Seen>; 2];

impl Worker {
    /// Takes a piece through the step: elements with these indices, whose rows are these from the first one on.
    pub(crate) fn solve(
        &mut self,
        step: &Step,
        lone: &[u32],
        (first, rows): (usize, &mut [ElementRow]),
        bodies: &[BodyRow],
        ways: &mut [Way],
        sight: &impl Sight,
    ) {
        self.stale = false;
        for (at, element) in lone.iter().enumerate() {
            let row = &mut rows[*element as usize - first];
            let mut way = Way::default();
            way.route = match self.read(step, at, row, bodies, &mut way, sight) {
                Ok(()) => Route::Solved,
                Err(route) => route,
            };
            ways[at] = way;
            if self.pending.len() == BATCH {
                self.finish(step, lone, (first, rows), ways);
            }
        }
        self.finish(step, lone, (first, rows), ways);
    }

    /// Reads an element, if it is an ordinary one.
    #[inline(always)]
    fn read(
        &mut self,
        step: &Step,
        at: usize,
        row: &mut ElementRow,
        bodies: &[BodyRow],
        way: &mut Way,
        sight: &impl Sight,
    ) -> Result<(), Route> {
        if row.has(ElementFlags::HELD) {
            return Err(Route::None);
        }
        let seen = self.find_bodies(step, row, bodies, way, sight)?;
        let mut points = [FreePoint::default(); 2];
        for (end, point) in points.iter_mut().enumerate() {
            *point = match (&seen[end], row.movable(end)) {
                (Some(seen), _) if seen.is_locked => return Err(Route::General),
                (Some(seen), Some(body)) => bodies[body].point(seen),
                _ => {
                    let [from, to] = step.path(&row.rare.held[end], sight);
                    FreePoint {
                        position: from,
                        velocity: (to - from) / step.plan.time,
                        ..FreePoint::default()
                    }
                }
            };
        }
        let has_moved = step.has_moved(row, sight);
        let Some((pair, start)) = pair_of(row, &points, has_moved) else {
            return Err(Route::GeneralOnce);
        };
        way.disturbed = has_moved || row.has(ElementFlags::CHANGED);
        let omega = (row.slope() * pair.inverse_mass).sqrt() as f32;
        for (end, seen) in seen.iter().enumerate() {
            if let Some(seen) = seen {
                way.slow[end] = step.is_slow(seen, omega);
                way.can_touch[end] = seen.can_touch;
            }
        }
        row.flags.insert(ElementFlags::ACTIVE);
        row.trouble.set_passing(None);
        row.inverse_mass = pair.inverse_mass;
        // What is lost is what its damper took: exact for a linear one at any damping.
        let damped = row.is_damped();
        let energy = damped.then(|| row.energy_of(&pair, &start, row.length));
        let plain = self.put_in_lane(step, row, &pair, &start);
        self.pending.push(Pending {
            at,
            points,
            moves: seen.map(|seen| seen.map(|seen| seen.more_substeps)),
            pair,
            start,
            energy,
            plain,
        });
        Ok(())
    }

    /// The bodies that an element moves, if all of them are awake.
    #[inline(always)]
    fn find_bodies(
        &mut self,
        step: &Step,
        row: &mut ElementRow,
        bodies: &[BodyRow],
        way: &mut Way,
        sight: &impl Sight,
    ) -> Result<Ends, Route> {
        let on = [0, 1].map(|end| row.movable(end).map(|body| &bodies[body]));
        if step.quiet && row.has(ElementFlags::DOZES) {
            let sleeps = |body: &BodyRow| sight.is_asleep(body.id);
            if on.into_iter().flatten().all(sleeps) {
                return Err(Route::Asleep);
            }
        }
        let mut sleepers = 0;
        let mut found = [None; 2];
        for (found, body) in found.iter_mut().zip(on) {
            let Some(body) = body else { continue };
            let Some(seen) = step.movable(sight, body.id, &mut self.stale) else {
                row.flags.remove(ElementFlags::ACTIVE);
                return Err(Route::Gone);
            };
            sleepers += usize::from(seen.is_asleep);
            way.disturbed |= body.has(BodyFlags::DISTURBED);
            *found = Some(seen);
        }
        row.flags.remove(ElementFlags::DOZES);
        if sleepers == 0 {
            return Ok(found);
        }
        let disturbed = way.disturbed || row.has(ElementFlags::CHANGED);
        if sleepers < row.moves() || disturbed || step.has_moved(row, sight) {
            return Err(Route::GeneralOnce);
        }
        let known = row.moves() == 2 && !row.is_any_watched();
        row.flags.set(ElementFlags::DOZES, known);
        row.flags.remove(ElementFlags::ACTIVE);
        Err(Route::Asleep)
    }

    /// Has a linear element solved in a lane beside others, if it is plain; says whether.
    #[inline(always)]
    fn put_in_lane(
        &mut self,
        step: &Step,
        row: &mut ElementRow,
        pair: &Pair,
        start: &Separation,
    ) -> bool {
        let count = step.accuracy.plain();
        let Some(count) = count.filter(|_| row.law.is_none()) else {
            return false;
        };
        let micro = step.plan.time / f64::from(count);
        if !pair.is_plain(micro) {
            return false;
        }
        let (at, lane) = (self.plain / LANES, self.plain % LANES);
        if self.lanes.len() <= at {
            self.lanes.push(Lanes::default());
        }
        self.lanes[at].take_in(lane, pair, start, micro, &mut row.memo);
        self.plain += 1;
        true
    }

    /// Solves what has been read.
    fn finish(
        &mut self,
        step: &Step,
        lone: &[u32],
        (first, rows): (usize, &mut [ElementRow]),
        ways: &mut [Way],
    ) {
        if let Some(count) = step.accuracy.plain() {
            for lanes in &mut self.lanes[..self.plain.div_ceil(LANES)] {
                lanes.run(step.plan.time, count);
            }
        }
        let mut plain = 0;
        for pending in &self.pending {
            let row = &mut rows[lone[pending.at] as usize - first];
            let together = pending.plain.then(|| {
                let (at, lane) = (plain / LANES, plain % LANES);
                plain += 1;
                self.lanes[at].state(lane)
            });
            let (outcome, end, length) = match together.flatten() {
                Some((end, length)) => (Outcome::plain(&step.accuracy), end, length),
                None => {
                    let (outcome, end) = alone(step, row, pending);
                    (outcome, end, end.d.length())
                }
            };
            let way = &mut ways[pending.at];
            let sound = end.d.is_finite() && end.v.is_finite();
            if !(sound && arrive(step, row, pending, &end, way)) {
                way.route = Route::GeneralOnce;
                continue;
            }
            row.set_direction(end.direction);
            row.solved = Solved {
                method: Method::ClosedForm,
                ..outcome.into()
            };
            if let Some(before) = pending.energy {
                row.ledger.dissipated += before - row.energy_of(&pending.pair, &end, length);
            }
        }
        self.pending.clear();
        self.plain = 0;
    }
}

/// The element and its motion; none where its direction or its law means nothing. Captures its rest length if need be.
#[inline(always)]
fn pair_of(
    row: &mut ElementRow,
    [a, b]: &[FreePoint; 2],
    has_moved: bool,
) -> Option<(Pair, Separation)> {
    let (d, v) = (b.position - a.position, b.velocity - a.velocity);
    let rounding = rounding(a.position, b.position);
    let rest_length = row.numbers.rest_length.map(f64::from);
    let coincide = d.length_squared() <= rounding * rounding;
    if coincide && row.direction().is_none() && rest_length != Some(0.0) {
        return None;
    }
    let length = d.length();
    if has_moved {
        row.account_for_leap(length);
    }
    row.length = length;
    if !row.is_sound(v, d) {
        return None;
    }
    let rest_length = rest_length.unwrap_or_else(|| {
        row.numbers.rest_length = Some(length as f32);
        row.flags.insert(ElementFlags::CAPTURED);
        f64::from(length as f32)
    });
    let pair = Pair {
        stiffness: f64::from(row.numbers.stiffness),
        damping: f64::from(row.numbers.damping),
        rest_length,
        inverse_mass: a.inverse_mass + b.inverse_mass,
        outside: b.acceleration - a.acceleration,
        rounding,
    };
    Some((pair, Separation::new(d, v, row.direction())))
}

/// Solves one by itself.
fn alone(step: &Step, row: &mut ElementRow, pending: &Pending) -> (Outcome, Separation) {
    let time = step.plan.time;
    let Pending { pair, start, .. } = pending;
    let controller = &mut row.rare.controller;
    match &row.law {
        None => {
            let mut moving = Moving::new(pair, *start, &mut row.memo);
            let outcome = controller.drive(&mut moving, time, step.accuracy);
            (outcome, moving.state)
        }
        Some(law) => {
            let mut moving = NonlinearPair::new(pair, law, *start, &mut row.memo);
            let outcome = controller.drive(&mut moving, time, step.accuracy);
            (outcome, moving.state)
        }
    }
}

/// Finds what both bodies are to be given; false if one of them would fly faster than the engine lets it.
#[inline(always)]
fn arrive(
    step: &Step,
    row: &mut ElementRow,
    pending: &Pending,
    end: &Separation,
    way: &mut Way,
) -> bool {
    let time = step.plan.time;
    let Pending { pair, start, .. } = pending;
    // What the element adds to the free motion of the separation.
    let moved = end.d - start.d - time * (start.v + 0.5 * time * pair.outside);
    let sped = end.v - start.v - time * pair.outside;
    let mut work = 0.0;
    for (end, point) in pending.points.iter().enumerate() {
        let sign = if end == 0 { -1.0 } else { 1.0 };
        let Some(more) = pending.moves[end] else {
            // What holds this end moves it against what the other end is given.
            work -= (sign / pair.inverse_mass * sped).dot(point.velocity);
            continue;
        };
        let share = sign * point.inverse_mass / pair.inverse_mass;
        let pulled = time * point.acceleration;
        let flight = Flight {
            moved: time * (point.velocity + 0.5 * pulled) + share * moved,
            velocity: point.velocity + pulled + share * sped,
        };
        if !is_within(flight.moved, flight.velocity, step.plan.fastest, time) {
            return false;
        }
        let push = step.push_point(more, point, &flight);
        way.given[end] = Given {
            velocity: push.velocity.unwrap_or_default(),
            force: push.share.force,
        };
        way.second_substep |= push.second_substep;
    }
    row.ledger.work += work;
    true
}
