//! A lone element on bodies that it does not turn: read, solve and deliver in one go.
//!
//! Most elements of most scenes are of this kind. Whatever is out of the ordinary about one (contacts,
//! joints, locked axes, ends that coincide, a sleeping end) is left to [`super::assembly`].

use super::point::{Flight, FreePoint};
use super::scene::{BodyRow, ElementRow, Held};
use super::step::Step;
use crate::dynamics::element::rounding;
use crate::dynamics::guide::Guide;
use crate::dynamics::pair::{Moving, Pair, Separation};
use crate::dynamics::shock::Shock;
use crate::dynamics::tolerance::{Method, Outcome};
use bevy_rapier3d::rapier::dynamics::{RigidBodyHandle, RigidBodySet};

/// What became of a lone element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Handled {
    Done,
    /// Asleep; and if so, only these, its bodies, can wake it.
    Asleep(Option<[RigidBodyHandle; 2]>),
    /// Out of the ordinary in this step.
    No,
    /// Out of the ordinary for as long as can be seen.
    Never,
}

impl Step<'_> {
    /// Takes the element through the step, if it is an ordinary one.
    pub(super) fn lone(
        &self,
        row: &mut ElementRow,
        bodies: &mut [BodyRow],
        members: &[usize],
        set: &mut RigidBodySet,
        stale: &mut bool,
    ) -> Handled {
        if row.companion.guide != Guide::Centres {
            return Handled::Never;
        }
        let time = self.plan.time;
        let mut sleepers = 0;
        let mut found = [None; 2];
        for (found, b) in found.iter_mut().zip(members) {
            let Some(body) = self.movable(set, bodies[*b].handle, stale) else {
                row.active = false;
                return Handled::Done;
            };
            sleepers += usize::from(body.is_sleeping());
            *found = Some((*b, body));
        }
        if sleepers > 0 {
            let disturbed = row.changed || members.iter().any(|b| bodies[*b].disturbed);
            if sleepers < members.len() || disturbed || self.has_moved(row, set) {
                return Handled::No;
            }
            row.active = false;
            return Handled::Asleep(match found {
                [Some((a, _)), Some((b, _))] if row.watched == [false; 2] => {
                    Some([bodies[a].handle, bodies[b].handle])
                }
                _ => None,
            });
        }
        let mut points = [FreePoint::default(); 2];
        for (point_at, held) in points.iter_mut().zip(&row.held) {
            let found = match *held {
                Held::Body {
                    movable: Some(index),
                    ..
                } => found
                    .iter()
                    .flatten()
                    .find(|(b, _)| *b == index)
                    .ok_or(Handled::No)
                    .and_then(|(_, body)| FreePoint::of(&bodies[index], body, self)),
                _ => {
                    let (from, to) = self.path(held, set);
                    Ok(FreePoint {
                        position: from,
                        velocity: (to - from) / time,
                        ..FreePoint::default()
                    })
                }
            };
            match found {
                Ok(point) => *point_at = point,
                Err(reason) => return reason,
            }
        }
        let [a, b] = points;
        let d = b.position - a.position;
        let rounding = rounding(a.position, b.position);
        let rest_length = row.parameters.rest_length.map(f64::from);
        let coincide = d.length_squared() <= rounding * rounding;
        if coincide && row.memory.direction.is_none() && rest_length != Some(0.0) {
            return Handled::No;
        }
        row.memory.length = d.length();
        if !row.is_sound(b.velocity - a.velocity, d) {
            return Handled::No;
        }
        let inverse_mass = a.inverse_mass + b.inverse_mass;
        let omega = (row.slope() * inverse_mass).sqrt();
        let mut restless = row.changed || self.has_moved(row, set);
        for (b, body) in found.into_iter().flatten() {
            restless |= std::mem::take(&mut bodies[b].disturbed);
            restless |= self.is_restless(&mut bodies[b], body, omega as f32);
        }
        row.active = true;
        row.passing = None;
        row.inverse_mass = inverse_mass;
        let rest_length = rest_length.unwrap_or_else(|| {
            let length = d.length() as f32;
            row.parameters.rest_length = Some(length);
            row.captured = true;
            f64::from(length)
        });
        let pair = Pair {
            stiffness: f64::from(row.parameters.stiffness),
            damping: f64::from(row.parameters.damping),
            rest_length,
            inverse_mass,
            outside: b.acceleration - a.acceleration,
            rounding,
        };
        let start = Separation::new(d, b.velocity - a.velocity, row.memory.direction);
        // What is lost is what its damper took: exact for a linear one at any damping.
        let damped = match &row.companion.law {
            Some(law) => law.damps(),
            None => row.parameters.damping > 0.0,
        };
        let before = if damped {
            row.energy_of(&pair, &start)
        } else {
            0.0
        };
        let memory = &mut row.memory;
        let (outcome, end) = match &row.companion.law {
            None => {
                let mut moving = Moving::new(&pair, start, &mut memory.memo);
                let outcome = memory.controller.drive(&mut moving, time, self.accuracy);
                (outcome, moving.state)
            }
            Some(law) => {
                let mut moving = Shock::new(&pair, law, start, &mut memory.memo);
                let outcome = memory.controller.drive(&mut moving, time, self.accuracy);
                (outcome, moving.state)
            }
        };
        if !(end.d.is_finite() && end.v.is_finite()) {
            return Handled::No;
        }
        row.memory.direction = end.direction;
        row.outcome = Outcome {
            method: Method::ClosedForm,
            ..outcome
        };
        // What the element adds to the free motion of the separation.
        let moved = end.d - start.d - time * (start.v + 0.5 * time * pair.outside);
        let sped = end.v - start.v - time * pair.outside;
        if damped {
            row.ledger.dissipated += before - row.energy_of(&pair, &end);
        }
        let movable = row.held.each_ref().map(Held::movable);
        for ((point, movable), sign) in points.iter().zip(movable).zip([-1.0, 1.0]) {
            let Some(index) = movable else {
                // What holds this end moves it against what the other end is given.
                row.ledger.work -= sign / inverse_mass * sped.dot(point.velocity);
                continue;
            };
            let share = sign * point.inverse_mass / inverse_mass;
            let pulled = time * point.acceleration;
            let flight = Flight {
                moved: time * (point.velocity + 0.5 * pulled) + share * moved,
                velocity: point.velocity + pulled + share * sped,
                given: sign / inverse_mass * sped,
            };
            self.deliver_point(&mut bodies[index], point, &flight, restless, set);
        }
        Handled::Done
    }
}
