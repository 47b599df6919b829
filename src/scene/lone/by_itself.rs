//! Solves a lone element that cannot be solved in a lane: one with a force law, a stiff spring or a strong damper, without a
//! captured rest length, with ends that meet, or under a tolerance.

use super::Way;
use crate::dynamics::body::is_within;
use crate::dynamics::element::rounding;
use crate::dynamics::moving::Moving;
use crate::dynamics::nonlinear_pair::NonlinearPair;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::points::{FreePoint, PointStep};
use crate::dynamics::tolerance::{Method, Outcome};
use crate::scene::rows::{ElementFlags, ElementRow, Solved};
use crate::scene::step::Step;

/// A lone element before it is solved by itself.
pub(super) struct Alone {
    pub points: [FreePoint; 2],
    /// Number of extra substeps for which the body at each end asks; none at an end that the element does not move.
    pub more: [Option<usize>; 2],
}

impl Alone {
    /// Takes an element through the step. Captures its rest length if there is none. Returns false if the general solver is
    /// needed: its direction or law is undefined, or a body would be faster than the engine allows.
    pub(super) fn solve(&self, step: &Step, row: &mut ElementRow, way: &mut Way) -> bool {
        let Some((pair, start)) = pair_of(row, &self.points) else {
            return false;
        };
        row.inverse_mass = pair.inverse_mass;
        // The energy that is lost is the heat of the damper. For a linear damper that is exact at any damping.
        let damped = row.is_damped();
        let before = damped.then(|| row.energy_of(&pair, &start, row.length));
        let (outcome, end) = drive(step, row, &pair, start);
        let sound = end.d.is_finite() && end.v.is_finite();
        if !(sound && self.arrive(step, row, [&start, &end], &pair, way)) {
            return false;
        }
        row.set_direction(end.direction);
        row.solved = Solved {
            method: Method::ClosedForm,
            ..outcome.into()
        };
        if let Some(before) = before {
            let heat = before - row.energy_of(&pair, &end, end.d.length());
            if heat.is_finite() {
                row.ledger.dissipated += heat;
            }
        }
        true
    }

    /// Computes the pushes of both bodies. Returns false if one of them would be faster than the engine allows.
    fn arrive(
        &self,
        step: &Step,
        row: &mut ElementRow,
        [start, end]: [&Separation; 2],
        pair: &Pair,
        way: &mut Way,
    ) -> bool {
        let time = step.plan.time;
        // Change of the separation and of its rate by the element, beyond free motion.
        let moved = end.d - start.d - time * (start.v + 0.5 * time * pair.outside);
        let sped = end.v - start.v - time * pair.outside;
        let mass = pair.inverse_mass.recip();
        let mut work = 0.0;
        for (end, point) in self.points.iter().enumerate() {
            let sign = if end == 0 { -1.0 } else { 1.0 };
            let Some(more) = self.more[end] else {
                // The motion of this end does work against the impulse that the other end gets.
                work -= (sign * mass * sped).dot(point.velocity);
                continue;
            };
            let share = sign * point.inverse_mass * mass;
            let pulled = time * point.acceleration;
            let moved = PointStep {
                by: time * (point.velocity + 0.5 * pulled) + share * moved,
                velocity: point.velocity + pulled + share * sped,
            };
            if !is_within(moved.by, moved.velocity, step.plan.fastest, time) {
                return false;
            }
            let push = step.push_point(more, point, &moved);
            way.given[end] = push.into();
            way.second_substep |= push.second_substep;
        }
        row.ledger.work += work;
        true
    }
}

/// Returns the element and its relative motion; none if its direction or its law is undefined.
fn pair_of(row: &mut ElementRow, [a, b]: &[FreePoint; 2]) -> Option<(Pair, Separation)> {
    let (d, v) = (b.position - a.position, b.velocity - a.velocity);
    let rounding = rounding(a.position, b.position);
    let rest_length = row.numbers.rest_length.map(f64::from);
    let coincide = d.length_squared() <= rounding * rounding;
    if coincide && row.direction().is_none() && rest_length != Some(0.0) {
        return None;
    }
    let length = d.length();
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

/// Integrates over the step.
fn drive(
    step: &Step,
    row: &mut ElementRow,
    pair: &Pair,
    start: Separation,
) -> (Outcome, Separation) {
    let time = step.plan.time;
    let mut controller = row.rare.controller();
    let driven = match &row.law {
        None => {
            let mut moving = Moving::new(pair, start, &mut row.memo);
            let outcome = controller.drive(&mut moving, time, step.accuracy);
            (outcome, moving.state)
        }
        Some(law) => {
            let mut moving = NonlinearPair::new(pair, law, start, &mut row.memo);
            let outcome = controller.drive(&mut moving, time, step.accuracy);
            (outcome, moving.state)
        }
    };
    row.rare.set_controller(controller);
    driven
}
