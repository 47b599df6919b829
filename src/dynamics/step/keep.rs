//! Prevents energy gain: takes the step of a network of points, checks the energy after every step, and corrects a step
//! that gained too much.

use super::{Component, Memory};
use crate::dynamics::body::{Body, is_within};
use crate::dynamics::bound::Bound;
use crate::dynamics::energy::Energy;
use crate::dynamics::points::Points;
use crate::dynamics::system::DIRECT;
use crate::dynamics::tolerance::{Accuracy, Method, Motion, Outcome};

/// Number of attempts, each with half the motion of the previous one. After them nothing moves at all.
const HALVINGS: i32 = 12;

/// (ω h)² of the stiffest mode below which the matrix is so well conditioned that a few iterations solve it.
const SOFT: f64 = 9.0;

impl Component {
    /// Whether the component is solved as points: no body turns, and iterations are cheaper than a factorisation. They
    /// are if the network is large, or so soft that they converge soon. In that case the points have been loaded.
    pub(super) fn is_of_points(&mut self, time: f64) -> bool {
        if self.elements.len() < 2 || !Points::can_be(&self.elements, &self.bodies) {
            return false;
        }
        let Memory {
            points,
            max_iterations,
            ..
        } = &mut self.memory;
        points.load_from(&self.elements, &self.bodies, *max_iterations);
        3 * self.bodies.len() > DIRECT || points.bounds(time).0 < SOFT
    }

    /// Takes the step of a network of points.
    pub(super) fn advance_points(
        &mut self,
        time: f64,
        accuracy: Accuracy,
        drive: impl FnOnce(&mut Points) -> Outcome,
    ) -> Outcome {
        let Memory { points, bound, .. } = &mut self.memory;
        let start = points.survey();
        let now = start.energy.sum();
        bound.start(now, start.rounding, start.power, self.perturbed);
        let mut outcome = drive(points);
        outcome.method = Method::Iterative;
        outcome.capped |= !points.converged();
        let end = points.survey();
        bound.see(points.stiffest);
        let within = self
            .farthest_move
            .is_none_or(|farthest| points.are_within(farthest, time));
        let kept = bound.is_kept(&end.energy, end.power, time) && within;
        if kept {
            bound.finish(&end.energy, time);
            self.memory.carriable = Some(time);
            if self.is_warm {
                return outcome;
            }
        } else {
            self.put_down();
            let start = &mut self.memory.saved[0];
            start.bodies.clone_from(&self.bodies);
            start.elements.clone_from(&self.elements);
        }
        self.memory
            .points
            .store_into(&mut self.elements, &mut self.bodies);
        if !kept {
            self.hold_back(time);
            self.keep_bound(time, accuracy, &mut outcome);
        }
        outcome
    }

    /// Removes gained energy from the motion. If there is not enough motion for that, the step is repeated: with finer
    /// micro-steps, or else by the method that only loses energy. If there is no energy at all, because a law gave no number,
    /// the step is repeated without its element.
    pub(super) fn keep_bound(&mut self, time: f64, accuracy: Accuracy, outcome: &mut Outcome) {
        let mut bound = std::mem::take(&mut self.memory.bound);
        let mut kept = bound.hold(&self.elements, &mut self.bodies, time);
        let count = outcome.microsteps.max(1);
        while kept.is_none() && !self.has_energy() && self.leave_out_unsound(time, count) {
            outcome.microsteps += count;
            kept = bound.hold(&self.elements, &mut self.bodies, time);
        }
        let kept = kept.or_else(|| self.retake(time, accuracy, outcome, &mut bound));
        let energy = kept.unwrap_or_else(|| {
            self.load(0);
            self.settle(time, &mut bound);
            Energy::of(&self.elements, &self.bodies)
        });
        bound.end(&energy, &self.bodies, time);
        self.memory.bound = bound;
    }

    /// Whether some body has moved faster than the engine allows.
    pub(super) fn is_beyond(&self, time: f64) -> bool {
        let fastest = self.farthest_move.unwrap_or(f64::INFINITY) / time;
        let start = &self.memory.saved[0].bodies;
        self.bodies.iter().zip(start).any(|(body, start)| {
            !is_within(body.position - start.position, body.velocity, fastest, time)
        })
    }

    /// Limits the motion of each body to what the engine allows. Otherwise the engine's state would differ from the
    /// integrator's.
    pub(super) fn hold_back(&mut self, time: f64) {
        let farthest = self.farthest_move.unwrap_or(f64::INFINITY);
        let mut any = false;
        for (body, start) in self.bodies.iter_mut().zip(&self.memory.saved[0].bodies) {
            if body.hold_back(start, farthest, time) {
                body.receive(start, time);
                any = true;
            }
        }
        if any {
            // Reset the elements to the start of the step. They may have counted turns and heat on a path that is not
            // taken.
            let start = &self.memory.saved[0].elements;
            for (element, start) in self.elements.iter_mut().zip(start) {
                (element.angle, element.direction) = (start.angle, start.direction);
                (element.heat, element.work) = (start.heat, start.work);
            }
            self.aim(time);
        }
    }

    fn settle(&mut self, time: f64, bound: &mut Bound) {
        let budget = self.memory.max_iterations;
        let network = &mut self.memory.network;
        let motion = network.settle(&self.elements, &self.bodies, time, budget);
        self.yield_to(&motion, time, bound);
        self.memory.network.give_back(motion);
    }

    /// Moves the bodies with the velocities of `motion`, as far as the stored energy allows.
    fn yield_to(&mut self, motion: &[Body], time: f64, bound: &mut Bound) {
        for half in 0..=HALVINGS {
            // The last attempt does not move the bodies at all. Then their velocities must be zero too.
            let share = if half < HALVINGS {
                0.5_f64.powi(half)
            } else {
                0.0
            };
            for (body, moved) in self.bodies.iter_mut().zip(motion) {
                body.slow_to(moved, share);
            }
            self.drift(time);
            self.hold_back(time);
            self.aim(time);
            if share == 0.0 || bound.allows(&self.elements, &self.bodies, time) {
                break;
            }
            self.load(0);
        }
        bound.slow(&self.elements, &mut self.bodies, time);
        for (body, start) in self.bodies.iter_mut().zip(&self.memory.saved[0].bodies) {
            body.receive(start, time);
        }
    }
}
