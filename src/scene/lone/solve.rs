//! Reads lone elements and solves them. Only their own rows and results are written.

use super::by_itself::Alone;
use super::{LonePair, Route, Way};
use crate::backend::Sight;
use crate::dynamics::kick::Memo;
use crate::dynamics::lanes::{LANES, Lanes, Stride, widest};
use crate::dynamics::micro::Micro;
use crate::dynamics::points::FreePoint;
use crate::dynamics::poles::Poles;
use crate::dynamics::tolerance::{Method, Outcome};
use crate::input::check::Numbers;
use crate::scene::push::Given;
use crate::scene::rows::{BodyFlags, BodyRow, Cut, ElementFlags, ElementRow, Solved};
use crate::scene::step::Step;
use pulp::{Simd, WithSimd};

/// Number of groups of lanes that are filled before the first group is solved. Numbers that were just written one by one
/// cannot be loaded as a vector at once. Pinned by the benchmark `own/isolated`.
const GROUPS: usize = 2;

/// Number of elements that are read before they are solved.
const BATCH: usize = GROUPS * LANES;

/// An element in a lane beside others.
#[derive(Clone, Copy)]
struct InLane {
    /// Index among the elements of the worker's piece.
    at: u32,
    /// Whether the element moves the body at each end.
    moves: [bool; 2],
}

/// Reads and solves a piece of all lone elements. It is kept from step to step.
#[derive(Default)]
pub(crate) struct Worker {
    lanes: [Lanes; GROUPS],
    /// The elements in its lanes.
    taken: Vec<InLane>,
    /// Coefficients of half micro-steps, where steps are extrapolated. Equal elements share them.
    half: Memo,
    /// Whether some body can no longer be moved.
    pub stale: bool,
}

/// Data of a step that is the same for all lanes.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    pub(super) stride: Stride,
    micro: Micro,
    solved: Solved,
}

/// State of an end of a lone element: of a body that it moves, or of a point that it does not move.
#[derive(Clone, Copy, Default)]
struct Found {
    point: FreePoint,
    /// Number of extra substeps for which the body asks; none for a point that the element does not move.
    more: Option<usize>,
    is_asleep: bool,
    is_locked: bool,
    can_touch: bool,
    is_disturbed: bool,
    speed_square: f32,
    /// Largest coordinate of its position, m.
    place: f32,
}

/// A piece of all lone elements.
pub(crate) struct Piece<'a, S> {
    pub lone: &'a [LonePair],
    /// Rows that include those of the piece.
    pub rows: Cut<'a, ElementRow>,
    pub bodies: &'a [BodyRow],
    pub ways: &'a mut [Way],
    pub sight: &'a S,
}

impl Worker {
    /// Takes a piece through the step.
    pub(crate) fn solve(&mut self, step: &Step, piece: Piece<impl Sight>) {
        self.stale = false;
        widest(Going(self, step, piece));
    }

    #[inline(always)]
    fn go<S: Simd>(&mut self, simd: S, step: &Step, mut piece: Piece<impl Sight>) {
        let pace = step.pace();
        for at in 0..piece.lone.len() {
            piece.ways[at].route = match self.take(step, pace.as_ref(), at, &mut piece) {
                Ok(()) => Route::Solved,
                Err(route) => route,
            };
            if let Some(pace) = &pace
                && self.taken.len() == BATCH
            {
                self.finish(simd, step, pace, &mut piece);
            }
        }
        if let Some(pace) = &pace {
            self.finish(simd, step, pace, &mut piece);
        }
    }

    /// Reads an element, and solves it or puts it into a lane. If neither is possible, returns its route. It is
    /// long because it is one decision after the other about the same data.
    #[inline(always)]
    fn take(
        &mut self,
        step: &Step,
        pace: Option<&Pace>,
        at: usize,
        piece: &mut Piece<impl Sight>,
    ) -> Result<(), Route> {
        let (bodies, sight) = (piece.bodies, piece.sight);
        let pair = &piece.lone[at];
        let row = &mut piece.rows[pair.element as usize];
        let way = &mut piece.ways[at];
        if row.has(ElementFlags::HELD) {
            return Err(Route::None);
        }
        if step.quiet && row.has(ElementFlags::DOZES) && sleeps(row, bodies, sight) {
            return Err(Route::Asleep);
        }
        let found = [
            self.find(step, row, pair, 0, bodies, sight)?,
            self.find(step, row, pair, 1, bodies, sight)?,
        ];
        let [a, b] = &found;
        row.flags.remove(ElementFlags::DOZES);
        way.disturbed = a.is_disturbed | b.is_disturbed | row.has(ElementFlags::CHANGED);
        if a.is_asleep | b.is_asleep {
            return Err(rests(step, row, &found, way.disturbed, sight));
        }
        if a.is_locked | b.is_locked {
            return Err(Route::General);
        }
        if step.has_moved(row, sight) {
            way.disturbed = true;
            row.account_for_leap((b.point.position - a.point.position).length());
        }
        row.flags.insert(ElementFlags::ACTIVE);
        row.trouble.set_passing(None);
        let inverse_mass = a.point.inverse_mass + b.point.inverse_mass;
        let omega_square = (row.slope() * inverse_mass) as f32;
        for (end, found) in [a, b].into_iter().enumerate() {
            way.slow[end] = step.may_rest(found.speed_square, found.place, omega_square);
            way.can_touch[end] = found.can_touch;
        }
        way.second_substep = false;
        let points = [a.point, b.point];
        let more = [a.more, b.more];
        if let Some(pace) = pace.filter(|_| more.iter().flatten().all(|more| *more == 0))
            && let Some((numbers, poles)) = plain(row, inverse_mass, pace, &mut self.half)
        {
            row.inverse_mass = inverse_mass;
            let (group, lane) = (self.taken.len() / LANES, self.taken.len() % LANES);
            self.lanes[group].take_in(lane, &points, numbers, &poles);
            self.taken.push(InLane {
                at: at as u32,
                moves: more.map(|more| more.is_some()),
            });
            return Ok(());
        }
        let alone = Alone { points, more };
        if alone.solve(step, row, way) {
            Ok(())
        } else {
            Err(Route::GeneralOnce)
        }
    }

    /// Reads an end of an element.
    #[inline(always)]
    fn find(
        &mut self,
        step: &Step,
        row: &mut ElementRow,
        pair: &LonePair,
        end: usize,
        bodies: &[BodyRow],
        sight: &impl Sight,
    ) -> Result<Found, Route> {
        let Some((body, id)) = pair.movable(end) else {
            let [from, to] = step.path(&row.rare.held[end], sight);
            let point = FreePoint {
                position: from,
                velocity: (to - from) / step.plan.time,
                ..FreePoint::default()
            };
            // A point that the element does not move counts as slow at any speed.
            return Ok(Found {
                point,
                ..Found::default()
            });
        };
        let body = &bodies[body];
        let Some(seen) = step.movable(sight, id, &mut self.stale) else {
            row.flags.remove(ElementFlags::ACTIVE);
            return Err(Route::Gone);
        };
        self.stale |= seen.has_shifted(pair.centers[end]);
        Ok(Found {
            point: body.point(&seen),
            more: Some(seen.more_substeps),
            is_asleep: seen.is_asleep,
            is_locked: seen.is_locked,
            can_touch: seen.can_touch,
            is_disturbed: body.has(BodyFlags::DISTURBED),
            speed_square: seen.velocity.length_squared(),
            place: seen.origin.abs().max_element(),
        })
    }

    /// Solves the elements in the lanes.
    #[inline(always)]
    fn finish<S: Simd>(
        &mut self,
        simd: S,
        step: &Step,
        pace: &Pace,
        piece: &mut Piece<impl Sight>,
    ) {
        let groups = self.taken.len().div_ceil(LANES);
        for lanes in &mut self.lanes[..groups] {
            lanes.run(simd, &pace.stride);
        }
        for (at, taken) in self.taken.iter().enumerate() {
            let (lanes, lane) = (&self.lanes[at / LANES], at % LANES);
            let at = taken.at as usize;
            let way = &mut piece.ways[at];
            let row = &mut piece.rows[piece.lone[at].element as usize];
            let Some(reached) = lanes.way(lane) else {
                let alone = Alone {
                    points: lanes.points(lane),
                    more: taken.moves.map(|moves| moves.then_some(0)),
                };
                if !alone.solve(step, row, way) {
                    way.route = Route::GeneralOnce;
                }
                continue;
            };
            row.set_direction(Some(reached.direction));
            row.length = reached.length;
            row.solved = pace.solved;
            if row.numbers.damping > 0.0 {
                row.ledger.dissipated += reached.heat;
            }
            for end in 0..2 {
                let push = lanes.push(lane, end);
                if taken.moves[end] {
                    way.given[end] = Given {
                        velocity: push.velocity,
                        force: push.force,
                    };
                } else {
                    // The motion of this end does work against the impulse that the other end gets.
                    row.ledger.work -= push.work;
                }
            }
        }
        self.taken.clear();
    }
}

/// A worker, the step and a piece, to be run with vector instructions.
struct Going<'a, 'b, V>(&'a mut Worker, &'a Step, Piece<'b, V>);

impl<V: Sight> WithSimd for Going<'_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.go(simd, self.1, self.2);
    }
}

impl Step {
    /// Data of the step for lanes; none if lanes cannot be used, because of a tolerance or other substeps than usual.
    pub(super) fn pace(&self) -> Option<Pace> {
        let count = self.accuracy.fixed()?;
        let extrapolates = self.accuracy.extrapolate;
        if self.alike.is_some() || self.terms(0).second_substep {
            return None;
        }
        Some(Pace {
            stride: Stride {
                schedule: self.schedule,
                count,
                extrapolates,
                fastest: self.plan.fastest,
            },
            micro: Micro {
                step: self.plan.time / f64::from(count),
                may_resolve: self.accuracy.resolve > 0,
                extrapolates,
            },
            solved: Solved {
                method: Method::ClosedForm,
                ..Outcome::fixed(&self.accuracy).into()
            },
        })
    }
}

/// Returns stiffness and rest length, and the poles, if a lane can solve the element; see [`Micro::poles`]. It must be linear,
/// with a rest length above zero. `half` is the memo of half micro-steps.
#[inline(always)]
pub(super) fn plain(
    row: &mut ElementRow,
    inverse_mass: f64,
    pace: &Pace,
    half: &mut Memo,
) -> Option<([f64; 2], [Poles; 2])> {
    let Numbers {
        stiffness,
        damping,
        rest_length,
    } = row.numbers;
    let rest_length = rest_length.filter(|rest| row.law.is_none() && *rest > 0.0)?;
    let [stiffness, damping, rest_length] = [stiffness, damping, rest_length].map(f64::from);
    let memos = [&mut row.memo, half];
    let poles = pace
        .micro
        .poles([stiffness, damping], inverse_mass, memos)?;
    Some(([stiffness, rest_length], poles))
}

/// Whether all bodies that an element moves are asleep.
fn sleeps(row: &ElementRow, bodies: &[BodyRow], sight: &impl Sight) -> bool {
    row.all_movable()
        .all(|body| sight.is_asleep(bodies[body].id))
}

/// Returns the route of an element with a body that is asleep.
#[cold]
fn rests(
    step: &Step,
    row: &mut ElementRow,
    found: &[Found; 2],
    disturbed: bool,
    sight: &impl Sight,
) -> Route {
    let awake = found.iter().any(|end| end.more.is_some() && !end.is_asleep);
    if awake || disturbed || step.has_moved(row, sight) {
        return Route::GeneralOnce;
    }
    let known = row.moves() == 2 && !row.is_any_watched();
    row.flags.set(ElementFlags::DOZES, known);
    row.flags.remove(ElementFlags::ACTIVE);
    Route::Asleep
}
