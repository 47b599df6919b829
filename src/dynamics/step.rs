//! From one engine step to the next: micro-steps, and the fourth-order combination of two step sizes.

use super::body::{Body, Spin, turn};
use super::element::Element;
use super::guard::Guard;
use super::kick::{self, Map, Memo};
use super::network::{Network, RESOLVED};
use bevy::math::DVec3;

/// Phase per coarse step up to which the fourth-order combination converges.
const EXTRAPOLATION_LIMIT: f64 = 1.5;

/// Most that a network steps finer by itself to resolve a stiff mode.
const EXTRA_STEPS: u32 = 4;

/// How finely to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Accuracy {
    pub microsteps: u32,
    pub extrapolate: bool,
}

/// How a component was solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Method {
    #[default]
    None,
    Free,
    ClosedForm,
    Direct,
    Iterative,
}

/// What a step took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    pub method: Method,
    /// Kicks actually made.
    pub microsteps: u32,
    pub extrapolated: bool,
    pub error: Option<f64>,
    pub iterations: u32,
    pub capped: bool,
}

/// Bodies that elements connect, with those elements: what has to be solved together.
#[derive(Clone, Default)]
pub(crate) struct Component {
    pub bodies: Vec<Body>,
    pub elements: Vec<Element>,
    pub memo: Memo,
    pub(super) network: Network,
    /// Velocities are not mapped to the true ones and back: what delivers the motion can order only the
    /// stepped ones.
    pub stepped: bool,
}

impl Component {
    /// Advances by one engine step of `time` seconds.
    pub(crate) fn advance(&mut self, time: f64, accuracy: Accuracy) -> Outcome {
        self.advance_old(time, accuracy);
        Outcome::default()
    }

    fn advance_old(&mut self, time: f64, accuracy: Accuracy) {
        let count = accuracy.microsteps.max(1);
        if !accuracy.extrapolate {
            return self.microsteps(time, count);
        }
        if !self.resolved(time / f64::from(count)) {
            // The same three kicks, spent on plain micro-steps, which never diverge.
            return self.microsteps(time, 3 * count);
        }
        let mut coarse = self.clone();
        coarse.microsteps(time, count);
        self.microsteps(time, 2 * count);
        // Even powers only, so a third of the difference is the leading error.
        for (fine, coarse) in self.bodies.iter_mut().zip(&coarse.bodies) {
            fine.position += (fine.position - coarse.position) / 3.0;
            fine.velocity += (fine.velocity - coarse.velocity) / 3.0;
            let apart = (fine.rotation * coarse.rotation.inverse()).to_scaled_axis();
            match (&mut fine.spin, coarse.spin) {
                (Spin::Free { momentum: f }, Spin::Free { momentum: c })
                | (Spin::Locked { velocity: f }, Spin::Locked { velocity: c }) => {
                    *f += (*f - c) / 3.0;
                    fine.rotation = (turn(apart / 3.0) * fine.rotation).normalize();
                }
                _ => {}
            }
        }
    }

    /// Force (N) and torque (N m) of all elements on a body as they stand.
    pub(crate) fn load_on(&self, body: usize) -> (DVec3, DVec3) {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for element in &self.elements {
            let Some(line) = element.line(&self.bodies) else {
                continue;
            };
            let rate = line.motion(element, &self.bodies, 0.0).axial;
            let stretch = line.length - element.rest_length;
            let tension = element.stiffness * stretch + element.damping * rate;
            for (hold, sign) in line.holds.iter().zip([1.0, -1.0]) {
                if hold.body == Some(body) {
                    let force = sign * tension * line.direction;
                    sum.0 += force;
                    sum.1 += hold.arm.cross(force);
                }
            }
        }
        sum
    }

    fn resolved(&mut self, step: f64) -> bool {
        if self.is_alone() {
            return kick::resolved(&self.elements[0], &self.bodies, step, EXTRAPOLATION_LIMIT);
        }
        let (z, g) = self.network.bounds(&self.elements, &self.bodies, step);
        z < EXTRAPOLATION_LIMIT * EXTRAPOLATION_LIMIT && g < EXTRAPOLATION_LIMIT
    }

    /// How many times finer a network has to step for its stiffest mode to need no damping; once where
    /// that is out of reach.
    fn extra_steps(&mut self, step: f64) -> u32 {
        if self.is_alone() {
            return 1;
        }
        let (z, _) = self.network.bounds(&self.elements, &self.bodies, step);
        let finer = (z / RESOLVED).sqrt().ceil();
        if finer <= f64::from(EXTRA_STEPS) {
            finer.max(1.0) as u32
        } else {
            1
        }
    }

    fn microsteps(&mut self, time: f64, count: u32) {
        let count = count * self.extra_steps(time / f64::from(count));
        let step = time / f64::from(count);
        let alone = self.is_alone();
        self.aim(step);
        let guard = alone
            .then(|| Guard::begin(&self.elements[0], &self.bodies, step))
            .flatten();
        let budget = 200;
        let mapped = alone && !self.stepped;
        if mapped {
            kick::map_velocity(
                &self.elements[0],
                &mut self.bodies,
                step,
                Map::ToStepped,
                &mut self.memo,
            );
        }
        for _ in 0..count {
            self.drift(step / 2.0);
            if alone {
                kick::kick(&self.elements[0], &mut self.bodies, step, &mut self.memo);
            } else {
                self.network
                    .kick(&self.elements, &mut self.bodies, step, budget);
            }
            self.drift(step / 2.0);
            self.aim(step);
        }
        if mapped {
            kick::map_velocity(
                &self.elements[0],
                &mut self.bodies,
                step,
                Map::ToTrue,
                &mut self.memo,
            );
        }
        if let Some(guard) = guard {
            guard.end(&self.elements[0], &mut self.bodies, time);
        }
    }

    /// Whether the closed form holds: one element on its own bodies (a component can have more of them
    /// where other elements are inert), with one direction that matters. An isotropic spring on a turning
    /// body has three.
    fn is_alone(&self) -> bool {
        let [element] = self.elements.as_slice() else {
            return false;
        };
        let turns = self.bodies.iter().any(|body| body.spin != Spin::Still);
        self.bodies.len() <= 2 && !(element.rest_length == 0.0 && turns)
    }

    fn aim(&mut self, step: f64) {
        for element in &mut self.elements {
            element.aim(&self.bodies, step);
        }
    }

    fn drift(&mut self, time: f64) {
        for body in &mut self.bodies {
            body.drift(time);
        }
        for element in &mut self.elements {
            for end in &mut element.ends {
                end.drift(time);
            }
        }
    }
}
