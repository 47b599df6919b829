//! Advances a component, the bodies and elements that must be solved together, by one engine step.

use super::body::{Body, Spin, shortest, turn};
use super::bound::Bound;
use super::element::{Element, End};
use super::excited::spread;
use super::guide::Guide;
use super::kick::{self, Memo};
use super::network::Network;
use super::nonlinear_pair::PairView;
use super::points::Points;
use super::resolution::{lone_steps, network_steps};
use super::thresholds::converges;
use super::tolerance::{
    Accuracy, Controller, Least, Method, Outcome, Steppable, VELOCITY_COUNTS, velocity_counts,
};
use bevy::math::DVec3;

mod alone;
mod keep;
mod kinks;
mod remember;
mod retake;
mod unsound;
mod warm_start;

use kinks::Kinks;
pub(crate) use remember::Remembered;
use retake::Caution;

/// Bodies that elements connect, and those elements. They must be solved together. The owner keeps the component from
/// step to step to reuse its memory.
#[derive(Clone, Default)]
pub(crate) struct Component {
    pub bodies: Vec<Body>,
    pub elements: Vec<Element>,
    /// Whether anything but its elements may have changed its energy since the last step.
    pub perturbed: bool,
    /// Greatest distance that the engine moves a body in a step, m; none if there is no limit.
    pub farthest_move: Option<f64>,
    /// Whether it is a network of points that continues from the last step. Then `bodies` and `elements` are out of date.
    pub is_warm: bool,
    /// Indices of the elements that the last step left out, because their law gave no number.
    pub unsound: Vec<usize>,
    pub(super) memory: Memory,
}

/// Data kept from step to step.
#[derive(Clone, Default)]
pub(super) struct Memory {
    memo: Memo,
    /// None until it is first needed, as by a component of several elements.
    network: Option<Box<Network>>,
    /// None until it is first needed, as by a network in which no body turns.
    points: Option<Box<Points>>,
    /// Length of the last step if the points can continue from it, s.
    carriable: Option<f64>,
    controller: Controller,
    kinks: Kinks,
    caution: Caution,
    bound: Bound,
    /// States of this step. Unless they are [lent](Component::swap_copies), they are kept to the next one.
    saved: Vec<Saved>,
    max_iterations: u32,
}

/// Memory for copies of the state within a step. Components that are stepped one after the other can share it.
#[derive(Default)]
pub(crate) struct Copies(Vec<Saved>);

/// A copy of the state.
#[derive(Clone, Default)]
struct Saved {
    bodies: Vec<Body>,
    elements: Vec<Element>,
}

impl Component {
    /// Advances by one engine step of `time` seconds.
    pub(crate) fn advance(&mut self, time: f64, accuracy: Accuracy) -> Outcome {
        self.memory.max_iterations = accuracy.max_iterations.max(1);
        self.memory.carriable = None;
        self.unsound.clear();
        let alone = self.is_alone();
        let mut controller = std::mem::take(&mut self.memory.controller);
        let apart = match self.elements.as_slice() {
            [element] => PairView::of(element, &self.bodies),
            _ => None,
        };
        if let Some(apart) = apart {
            self.save(0);
            let Memory { memo, bound, .. } = &mut self.memory;
            bound.forget();
            let element = &mut self.elements[0];
            let outcome = apart.advance(element, &mut self.bodies, memo, |motion| {
                controller.drive(motion, time, accuracy)
            });
            if !self.is_beyond(time) {
                self.memory.controller = controller;
                return outcome;
            }
            // The engine will limit the motion of a body. Repeat the step below, where the energy is checked.
            self.load(0);
        }
        let accuracy = self.memory.caution.pass(time, accuracy);
        let is_shared = self.elements.len() > 1;
        if self.is_warm || is_shared && Points::can_be(&self.elements, &self.bodies) {
            self.fill_points();
            let outcome = self.advance_points(time, accuracy, |motion| {
                controller.drive(motion, time, accuracy)
            });
            self.memory.controller = controller;
            return outcome;
        }
        let bound = &mut self.memory.bound;
        bound.begin(&self.elements, &self.bodies, self.perturbed);
        self.save(0);
        let mut outcome = controller.drive(self, time, accuracy);
        self.memory.controller = controller;
        outcome.method = Method::ClosedForm;
        self.hold_back(time);
        self.keep_bound(time, accuracy, &mut outcome);
        if alone {
            return outcome;
        }
        let network = self.memory.network.get_or_insert_default();
        let (iterates, converged) = network.take_effort();
        outcome.method = if iterates {
            Method::Iterative
        } else {
            Method::Direct
        };
        outcome.capped |= !converged;
        outcome
    }

    /// Copies the state into the points that are solved in its place, unless they still have it.
    fn fill_points(&mut self) {
        let Memory {
            points,
            max_iterations,
            ..
        } = &mut self.memory;
        let points = points.get_or_insert_default();
        if self.is_warm {
            points.go_on(*max_iterations);
        } else {
            points.load_from(&self.elements, &self.bodies, *max_iterations);
        }
    }

    /// Exchanges the memory for copies of the state with that of the owner: before a step to lend it, and after the step to take
    /// it back.
    pub(crate) fn swap_copies(&mut self, copies: &mut Copies) {
        std::mem::swap(&mut self.memory.saved, &mut copies.0);
    }

    /// Whether the state after a step is finite.
    pub(crate) fn is_finite(&self) -> bool {
        match &self.memory.points {
            Some(points) if self.is_warm => points.are_finite(),
            _ => self.bodies.iter().all(Body::is_finite),
        }
    }

    #[cfg(test)]
    pub(super) fn memory_for_test(&mut self, max_iterations: u32) {
        self.memory.max_iterations = max_iterations;
    }

    /// Takes `count` micro-steps of elements that share bodies.
    fn run_network(&mut self, step: f64, count: u32) {
        for _ in 0..count {
            self.drift(step / 2.0);
            self.kick_network(step);
            self.drift(step / 2.0);
            self.aim(step);
        }
    }

    fn kick_network(&mut self, step: f64) {
        let Memory {
            network,
            max_iterations,
            kinks,
            ..
        } = &mut self.memory;
        let kinks = kinks.keep_energy();
        let network = network.get_or_insert_default();
        let (elements, bodies) = (&mut self.elements, &mut self.bodies);
        network.kick(elements, bodies, step, *max_iterations, kinks);
    }

    /// Whether the closed form applies: there is one linear element on its own bodies, and it acts along one direction.
    /// An isotropic spring on a turning body acts along three. A component can have more bodies than those of its element
    /// if other elements are inert.
    fn is_alone(&self) -> bool {
        let [element] = self.elements.as_slice() else {
            return false;
        };
        let isotropic = element.rest_length == 0.0 && element.guide == Guide::Centres;
        self.bodies.len() <= 2 && element.law.is_none() && !(isotropic && self.turns())
    }

    /// Whether elements turn one of its bodies.
    fn turns(&self) -> bool {
        self.bodies.iter().any(|body| body.spin != Spin::Ignored)
    }

    /// Time over which the velocity differences from `other` count as position errors, s.
    fn velocity_counts(&self, other: &[Body]) -> f64 {
        if self.turns() {
            return VELOCITY_COUNTS;
        }
        let faster = |i: usize| self.bodies[i].velocity - other[i].velocity;
        let motion = (0..other.len()).map(|i| (self.bodies[i].mass() * faster(i)).dot(faster(i)));
        let stiffened = self.elements.iter().filter(|e| e.law.is_none()).map(|e| {
            let [a, b] = e.ends.map(|end| match end {
                End::Body { index, .. } => faster(index),
                End::Path(_) => DVec3::ZERO,
            });
            let along = e.direction.unwrap_or(DVec3::ZERO);
            e.stiffness * (b - a).dot(along).powi(2)
        });
        velocity_counts(motion.sum(), stiffened.sum())
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

/// Makes `to` a copy of `from` without spare capacity. A vector that grows begins with a capacity of four, but most
/// components have one element and two bodies.
fn copy<T: Clone>(to: &mut Vec<T>, from: &[T]) {
    to.clear();
    to.reserve_exact(from.len());
    to.extend_from_slice(from);
}

impl Steppable for Component {
    fn save(&mut self, slot: usize) {
        let saved = &mut self.memory.saved;
        if saved.len() <= slot {
            saved.resize_with(slot + 1, Saved::default);
        }
        copy(&mut saved[slot].bodies, &self.bodies);
        copy(&mut saved[slot].elements, &self.elements);
    }

    fn load(&mut self, slot: usize) {
        let saved = &self.memory.saved[slot];
        self.bodies.clone_from(&saved.bodies);
        self.elements.clone_from(&saved.elements);
    }

    /// Returns the micro-steps that resolve the stiffest mode, and impacts at kinks of a law. Where they are out of
    /// reach, returns one.
    fn least(&mut self, time: f64, most: u32) -> Least {
        if self.is_alone() {
            let element = &self.elements[0];
            let line = element.line(&self.bodies);
            let z = line.map_or(0.0, |line| {
                element.stiffness * line.inverse_mass * time * time
            });
            return lone_steps(z, most, self.turns() && element.damping == 0.0);
        }
        let network = self.memory.network.get_or_insert_default();
        let (z, _) = network.bounds(&self.elements, &self.bodies, time);
        let mut least = network_steps(z, self.elements.len(), most);
        least.count = least.count.max(self.steps_at_bends(z, time));
        self.memory.bound.see(least.in_each(z));
        least
    }

    fn run(&mut self, time: f64, count: u32) {
        let step = time / f64::from(count);
        self.aim(step);
        if self.is_alone() {
            self.run_alone(step, count);
        } else {
            self.run_network(step, count);
        }
    }

    fn distance(&self, slot: usize) -> f64 {
        let mut worst = 0.0_f64;
        let other = &self.memory.saved[slot].bodies;
        let counts = self.velocity_counts(other);
        for (a, b) in self.bodies.iter().zip(other) {
            let mut apart =
                (a.position - b.position).length() + counts * (a.velocity - b.velocity).length();
            if a.spin != Spin::Ignored {
                let radius = (a.inertia.max_element() * a.inverse_mass.max_element()).sqrt();
                let turned = (a.rotation * b.rotation.inverse()).to_scaled_axis();
                let spun = a.angular_velocity() - b.angular_velocity();
                apart += radius * (turned.length() + VELOCITY_COUNTS * spun.length());
            }
            worst = worst.max(apart);
        }
        worst
    }

    fn travelled(&self, slot: usize) -> f64 {
        let before = &self.memory.saved[slot].bodies;
        let mut ends = self.elements.iter().flat_map(|element| &element.ends);
        let held = ends.any(End::is_path).then_some(DVec3::ZERO);
        let moved = self.bodies.iter().zip(before);
        let way = moved.clone().map(|(now, was)| now.position - was.position);
        let gained = moved.map(|(now, was)| now.velocity - was.velocity);
        spread(way.chain(held)) + self.velocity_counts(before) * spread(gained.chain(held))
    }

    fn extrapolate(&mut self, slot: usize) {
        let saved = &self.memory.saved[slot];
        for (fine, coarse) in self.elements.iter_mut().zip(&saved.elements) {
            fine.heat += (fine.heat - coarse.heat) / 3.0;
            fine.work += (fine.work - coarse.work) / 3.0;
        }
        for (fine, coarse) in self.bodies.iter_mut().zip(&saved.bodies) {
            fine.position += (fine.position - coarse.position) / 3.0;
            fine.velocity += (fine.velocity - coarse.velocity) / 3.0;
            fine.given.0 += (fine.given.0 - coarse.given.0) / 3.0;
            fine.given.1 += (fine.given.1 - coarse.given.1) / 3.0;
            fine.torque_work += (fine.torque_work - coarse.torque_work) / 3.0;
            let apart = shortest(fine.rotation * coarse.rotation.inverse()).to_scaled_axis();
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

    fn is_resolved(&mut self, step: f64) -> bool {
        if self.is_alone() {
            return kick::resolved(&self.elements[0], &self.bodies, step);
        }
        let network = self.memory.network.get_or_insert_default();
        let (z, g) = network.bounds(&self.elements, &self.bodies, step);
        converges(z, g) && !self.memory.kinks.are_near()
    }
}
