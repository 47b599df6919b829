//! Prevents energy gain: takes the step of a network of points, checks the energy after every step, and corrects a step
//! that gained too much.

use super::{Component, Memory};
use crate::dynamics::body::{Body, is_within};
use crate::dynamics::bound::{Bound, Common, slow_beside};
use crate::dynamics::energy::Energy;
use crate::dynamics::points::Points;
use crate::dynamics::tolerance::{Accuracy, Method, Outcome, Steppable};

/// Number of attempts, each with half the motion of the previous one. After them nothing moves but the common centre of mass of a
/// free network. Pinned by `keep::tests::a_network_stretches_as_far_as_its_energy_allows`.
const HALVINGS: i32 = 12;

impl Component {
    /// Takes the step of a network of points, which has been loaded.
    pub(super) fn advance_points(
        &mut self,
        time: f64,
        accuracy: Accuracy,
        drive: impl FnOnce(&mut Points) -> Outcome,
    ) -> Outcome {
        let Memory { points, bound, .. } = &mut self.memory;
        let points: &mut Points = points.get_or_insert_default();
        let start = points.survey();
        let now = start.energy.sum();
        bound.start(now, start.rounding, start.power, self.perturbed);
        let mut outcome = drive(points);
        outcome.method = if points.is_direct() {
            Method::Direct
        } else {
            Method::Iterative
        };
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
        }
        self.save(0);
        if let Some(points) = &mut self.memory.points {
            points.store_into(&mut self.elements, &mut self.bodies);
        }
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
        let network = self.memory.network.get_or_insert_default();
        let motion = network.settle(&self.elements, &self.bodies, time, budget);
        self.yield_to(&motion, time, bound);
        if let Some(network) = &mut self.memory.network {
            network.give_back(motion);
        }
    }

    /// Moves the bodies with the velocities of `motion`, as far as the stored energy allows. The motion of the common centre of
    /// mass of a free network is kept.
    fn yield_to(&mut self, motion: &[Body], time: f64, bound: &mut Bound) {
        let common = Common::of(&self.elements, motion).velocity;
        for half in 0..=HALVINGS {
            // The last attempt does not move the bodies against each other. Then their velocities must be equal too.
            let share = if half < HALVINGS {
                0.5_f64.powi(half)
            } else {
                0.0
            };
            for (body, moved) in self.bodies.iter_mut().zip(motion) {
                if share == 1.0 {
                    body.slow_to(moved, share);
                } else {
                    slow_beside(common, body, moved, share);
                }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::element::End;
    use crate::dynamics::tests::{element, point};
    use bevy::math::DVec3;

    /// Two bodies of 1 kg on a spring of 1 kN/m at its rest length of 1 m. They fly, and move apart at `speed` each. They are to
    /// move apart at 10 m/s for 0.1 s. Returns them before and after.
    fn parted(flight: DVec3, speed: f64) -> [[Body; 2]; 2] {
        let bodies = [0.0, 1.0].map(|x| {
            let mut body = point(1.0, DVec3::X * x, DVec3::ZERO);
            body.velocity = flight + DVec3::X * speed * (2.0 * x - 1.0);
            body
        });
        let [a, b] = [0, 1].map(|index| End::Body {
            index,
            arm: DVec3::ZERO,
        });
        let mut pair = Component {
            bodies: bodies.to_vec(),
            elements: vec![element(a, b, 1e3, 0.0, 1.0)],
            ..Component::default()
        };
        pair.save(0);
        let mut bound = Bound::default();
        bound.begin(&pair.elements, &pair.bodies, false);
        let mut apart = bodies;
        apart[0].velocity -= DVec3::X * 10.0;
        apart[1].velocity += DVec3::X * 10.0;
        pair.yield_to(&apart, 0.1, &mut bound);
        [bodies, [pair.bodies[0], pair.bodies[1]]]
    }

    #[test]
    fn a_network_stretches_as_far_as_its_energy_allows() {
        let [_, [a, b]] = parted(DVec3::ZERO, 0.5);
        // 0.25 J stretch it by √(2·0.25/1000) m. A share that is halved each time reaches at least half of that.
        let stretch = b.position.x - a.position.x - 1.0;
        assert!((0.0111..=0.0224).contains(&stretch), "{stretch} m");
    }

    #[test]
    fn a_free_network_that_must_not_stretch_flies_on() {
        let flight = DVec3::Y * 5.0;
        // At any share of the motion that is not tiny, the spring would store more than the pair has beside its flight.
        let [bodies, now] = parted(flight, 0.0);
        for (body, start) in now.iter().zip(&bodies) {
            assert!(body.velocity.distance(flight) < 0.1, "{}", body.velocity);
            let way = body.position - start.position;
            assert!(way.distance(0.1 * flight) < 0.01, "{way}");
        }
    }
}
