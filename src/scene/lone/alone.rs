//! What no lane is for: force laws, stiff springs and strong dampers, accuracy by tolerance, rest lengths yet to be found, ends that
//! meet.

use super::Way;
use crate::dynamics::body::is_within;
use crate::dynamics::element::rounding;
use crate::dynamics::moving::Moving;
use crate::dynamics::nonlinear_pair::NonlinearPair;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::points::{Flight, FreePoint};
use crate::dynamics::tolerance::{Method, Outcome};
use crate::scene::rows::{ElementFlags, ElementRow, Solved};
use crate::scene::step::Step;

/// An element about to be solved by itself.
pub(super) struct Alone {
    pub points: [FreePoint; 2],
    /// Substeps beyond those of all of the bodies at both ends; none of an end that it does not move.
    pub more: [Option<usize>; 2],
}

impl Alone {
    /// Takes an element through the step; false if that is not for here: its direction or its law means nothing, or the
    /// engine would not fly a body so fast. Captures its rest length if need be.
    pub(super) fn solve(&self, step: &Step, row: &mut ElementRow, way: &mut Way) -> bool {
        let Some((pair, start)) = pair_of(row, &self.points) else {
            return false;
        };
        row.inverse_mass = pair.inverse_mass;
        // What is lost is what its damper took: exact for a linear one at any damping.
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
            row.ledger.dissipated += heat;
        }
        true
    }

    /// Finds what both bodies are to be given; false if one of them would fly faster than the engine lets it.
    fn arrive(
        &self,
        step: &Step,
        row: &mut ElementRow,
        [start, end]: [&Separation; 2],
        pair: &Pair,
        way: &mut Way,
    ) -> bool {
        let time = step.plan.time;
        // What the element adds to the free motion of the separation.
        let moved = end.d - start.d - time * (start.v + 0.5 * time * pair.outside);
        let sped = end.v - start.v - time * pair.outside;
        let mass = pair.inverse_mass.recip();
        let mut work = 0.0;
        for (end, point) in self.points.iter().enumerate() {
            let sign = if end == 0 { -1.0 } else { 1.0 };
            let Some(more) = self.more[end] else {
                // What holds this end moves it against what the other end is given.
                work -= (sign * mass * sped).dot(point.velocity);
                continue;
            };
            let share = sign * point.inverse_mass * mass;
            let pulled = time * point.acceleration;
            let flight = Flight {
                moved: time * (point.velocity + 0.5 * pulled) + share * moved,
                velocity: point.velocity + pulled + share * sped,
            };
            if !is_within(flight.moved, flight.velocity, step.plan.fastest, time) {
                return false;
            }
            let push = step.push_point(more, point, &flight);
            way.given[end] = push.into();
            way.second_substep |= push.second_substep;
        }
        row.ledger.work += work;
        true
    }
}

/// The element and its motion; none where its direction or its law means nothing.
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

/// Goes over the step.
fn drive(
    step: &Step,
    row: &mut ElementRow,
    pair: &Pair,
    start: Separation,
) -> (Outcome, Separation) {
    let time = step.plan.time;
    let controller = &mut row.rare.controller;
    match &row.law {
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
    }
}
