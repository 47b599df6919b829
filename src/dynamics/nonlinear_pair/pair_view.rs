//! Converts a lone element with a force law to the separation of its ends, and the result back to its bodies.

use super::NonlinearPair;
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::element::{Element, End, rounding};
use crate::dynamics::guide::Guide;
use crate::dynamics::kick::Memo;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::tolerance::{Method, Outcome};
use bevy::math::DVec3;

/// The ends of an element as two points, and their separation.
pub(crate) struct PairView {
    pair: Pair,
    start: Separation,
    /// Inverse mass of each end, 1/kg.
    shares: [f64; 2],
}

impl PairView {
    /// Returns the view of an element with a law, if no other element holds its bodies and it does not turn them.
    pub(crate) fn of(element: &Element, bodies: &[Body]) -> Option<Self> {
        element.law.as_ref()?;
        let free = |body: &Body| body.spin == Spin::Ignored && body.moves_alike();
        let held = element.ends.iter().filter(|end| !end.is_path()).count();
        // If the component has more bodies, those of inert elements, they would not be moved.
        let complete = held == bodies.len() && bodies.iter().all(free);
        let central = element.ends.iter().all(End::is_central);
        if element.guide != Guide::Centres || !complete || !central {
            return None;
        }
        let [a, b] = element.ends.map(|end| match end {
            End::Path(path) => (path.position, path.velocity, DVec3::ZERO, 0.0),
            End::Body { index, .. } => {
                let body = &bodies[index];
                let w = body.inverse_mass.x;
                (body.position, body.velocity, body.acceleration, w)
            }
        });
        let start = Separation::new(b.0 - a.0, b.1 - a.1, element.direction);
        let pair = Pair {
            stiffness: 0.0,
            damping: 0.0,
            rest_length: element.rest_length,
            inverse_mass: a.3 + b.3,
            outside: b.2 - a.2,
            rounding: rounding(a.0, b.0),
        };
        (pair.inverse_mass > 0.0).then_some(Self {
            pair,
            start,
            shares: [a.3, b.3],
        })
    }

    /// Advances the element and its bodies by a step, which `drive` takes.
    pub(crate) fn advance(
        &self,
        element: &mut Element,
        bodies: &mut [Body],
        memo: &mut Memo,
        drive: impl FnOnce(&mut NonlinearPair) -> Outcome,
    ) -> Outcome {
        let Some(law) = element.law.clone() else {
            return Outcome::default();
        };
        let mut moving = NonlinearPair::new(&self.pair, &law, self.start, memo);
        let before = moving.energy();
        let outcome = drive(&mut moving);
        let (end, time) = (moving.state, moving.time);
        element.direction = end.direction;
        if law.damps() {
            element.heat += before - moving.energy();
        }
        let moved = end.d - self.start.d - time * (self.start.v + 0.5 * time * self.pair.outside);
        let sped = end.v - self.start.v - time * self.pair.outside;
        for ((held, share), sign) in element.ends.iter().zip(self.shares).zip([-1.0, 1.0]) {
            let given = sign / self.pair.inverse_mass * sped;
            match *held {
                End::Path(path) => element.work -= given.dot(path.velocity),
                End::Body { index, .. } => {
                    let body = &mut bodies[index];
                    let share = sign * share / self.pair.inverse_mass;
                    body.position +=
                        time * (body.velocity + 0.5 * time * body.acceleration) + share * moved;
                    body.velocity += time * body.acceleration + share * sped;
                    body.given.0 += given;
                }
            }
        }
        Outcome {
            method: Method::ClosedForm,
            ..outcome
        }
    }
}
