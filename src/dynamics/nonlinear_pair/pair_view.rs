//! A law's lone element among the bodies of a component: to the separation of its ends, and back.

use super::NonlinearPair;
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::element::{Element, End};
use crate::dynamics::guide::Guide;
use crate::dynamics::kick::Memo;
use crate::dynamics::pair::{Pair, Separation};
use crate::dynamics::tolerance::{Method, Outcome};
use bevy::math::DVec3;

/// Both ends as points that come apart.
pub(crate) struct PairView {
    pair: Pair,
    start: Separation,
    /// Inverse mass of each end.
    shares: [f64; 2],
}

impl PairView {
    /// For an element with a law on bodies that nothing else holds and that it does not turn.
    pub(crate) fn of(element: &Element, bodies: &[Body]) -> Option<Self> {
        element.law.as_ref()?;
        let free = |body: &Body| {
            let w = body.inverse_mass;
            body.spin == Spin::Ignored && w.x == w.y && w.y == w.z
        };
        let held = element.ends.iter().filter(|end| !end.is_path()).count();
        // Bodies of elements that take no part would be left where they are.
        let complete = held == bodies.len() && bodies.iter().all(free);
        if element.guide != Guide::Centres || !complete {
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
        let scale = a.0.abs().max(b.0.abs()).max_element();
        let start = Separation::new(b.0 - a.0, b.1 - a.1, element.direction);
        let pair = Pair {
            stiffness: 0.0,
            damping: 0.0,
            rest_length: element.rest_length,
            inverse_mass: a.3 + b.3,
            outside: b.2 - a.2,
            rounding: 1e-9 * scale.max(1e-3),
        };
        (pair.inverse_mass > 0.0).then_some(Self {
            pair,
            start,
            shares: [a.3, b.3],
        })
    }

    /// Takes it through a step as `drive` says.
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
