//! Solves networks in which no body turns: cloths, lattices, chains.
//!
//! The result equals that of [`super::network`] except for rounding. Here a body is a point mass, so that thousands of
//! them fit into the processor's cache. [`kick`] contains the step of its elements ([`mod@bar`]), [`solve`] its linear system,
//! [`parts`] the division among threads, [`free_points`] the transition from one step to the next, and [`survey`] the energy.

mod bar;
mod free_points;
mod kick;
mod parts;
mod solve;
mod state;
mod survey;
mod wire;

use super::body::{Body, Spin};
use super::element::{Element, End};
use super::excited::spread;
use super::guide::Guide;
use super::network::shares;
use super::resolution::network_steps;
use super::thresholds::converges;
use super::tolerance::{Least, Steppable, velocity_counts};
use crate::threads::{copy, each};
use bar::{Bar, Load};
use bevy::math::DVec3;
pub(crate) use free_points::{FreePoint, PointStep};
use parts::Parts;
use solve::Solver;
use state::State;
use survey::Survey;
use wire::{Line, Wire};

/// Heat of an element's damper, and work of its ends with prescribed motion, so far in this step, J.
#[derive(Clone, Copy, Debug, Default)]
struct Exchanged {
    heat: f64,
    work: f64,
}

/// A state that can be restored.
#[derive(Clone, Default)]
struct Saved {
    points: State,
    wires: Vec<Wire>,
    exchanged: Vec<Exchanged>,
}

/// A network of points, kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Points {
    points: State,
    /// Positions (m) and velocities (m/s) of all points at the start of the step.
    start: [Vec<DVec3>; 2],
    wires: Vec<Wire>,
    /// Heat and work of each element.
    exchanged: Vec<Exchanged>,
    /// For each point, stiffness (1/s²) and damping (1/s) of its elements over its mass; see [`super::network::Network`].
    sums: Vec<[f64; 2]>,
    /// The largest stiffness and damping of these.
    largest: [f64; 2],
    /// (ω h)² of the stiffest mode in a micro-step.
    pub(super) stiffest: f64,
    parts: Parts,
    bars: Vec<Bar>,
    loads: Vec<Load>,
    impulses: Vec<DVec3>,
    solver: Solver,
    budget: u32,
    converged: bool,
    saved: [Saved; 3],
    /// Partial surveys, one for each piece of points and of elements.
    surveys: Vec<Survey>,
}

impl Points {
    /// Whether a network can be solved as points: its bodies move freely along all axes and do not turn, and its elements
    /// are linear and held at the centres of mass.
    pub(super) fn can_be(elements: &[Element], bodies: &[Body]) -> bool {
        bodies.iter().all(|body| {
            body.spin == Spin::Ignored && body.inverse_mass.x > 0.0 && body.moves_alike()
        }) && elements.iter().all(|element| {
            element.guide == Guide::Centres
                && element.law.is_none()
                && element.ends.iter().all(End::is_central)
        })
    }

    /// Loads a network in its present state.
    pub(super) fn load_from(&mut self, elements: &[Element], bodies: &[Body], budget: u32) {
        let ends = elements.iter().flat_map(|element| &element.ends);
        let prescribed = ends.filter(|end| end.is_path()).count();
        self.points.load(bodies, prescribed);
        self.wires.clear();
        self.wires.reserve_exact(elements.len());
        self.exchanged.clear();
        self.exchanged.reserve_exact(elements.len());
        for element in elements {
            let ends = element.ends.map(|end| match end {
                End::Body { index, .. } => index as u32,
                End::Path(path) => self.points.push(path.position, path.velocity),
            });
            self.wires.push(Wire {
                ends,
                stiffness: element.stiffness,
                damping: element.damping,
                rest_length: element.rest_length,
                side: element.direction.unwrap_or(DVec3::ZERO),
                stiff_damper: element.stiff_damper,
            });
            self.exchanged.push(Exchanged {
                heat: element.heat,
                work: element.work,
            });
        }
        self.parts.find(&self.wires, bodies.len());
        let pairs = self.wires.iter();
        let pairs = pairs.map(|wire| wire.ends.map(|end| end as usize));
        self.solver.join(bodies.len(), pairs);
        self.add_up();
        self.begin(budget);
    }

    /// Writes the result of the step into elements and bodies.
    pub(super) fn store_into(&mut self, elements: &mut [Element], bodies: &mut [Body]) {
        for (i, body) in bodies.iter_mut().enumerate() {
            body.position = self.points.positions[i];
            body.velocity = self.points.velocities[i];
            body.given.0 = self.points.given[i];
        }
        let wires = self.wires.iter().zip(&self.exchanged);
        for (element, (wire, exchanged)) in elements.iter_mut().zip(wires) {
            for (end, index) in element.ends.iter_mut().zip(wire.ends) {
                if let End::Path(path) = end {
                    path.position = self.points.positions[index as usize];
                }
            }
            element.direction = wire.side.try_normalize();
            element.stiff_damper = wire.stiff_damper;
            (element.heat, element.work) = (exchanged.heat, exchanged.work);
        }
    }

    /// Whether the last solve needed no iterations.
    pub(super) fn is_direct(&self) -> bool {
        self.solver.is_direct()
    }

    /// Whether all solves of this step have converged.
    pub(super) fn converged(&self) -> bool {
        self.converged
    }

    /// Sums up stiffness and damping over mass for every point.
    fn add_up(&mut self) {
        self.sums.clear();
        self.sums.resize(self.points.len(), [0.0; 2]);
        for wire in &self.wires {
            let shares = shares(wire.inverse_masses(&self.points));
            for (end, share) in wire.ends.iter().zip(shares) {
                let [stiffness, damping] = &mut self.sums[*end as usize];
                *stiffness += wire.stiffness * share;
                *damping += wire.damping * share;
            }
        }
        let largest = |of: usize| self.sums.iter().map(|sums| sums[of]).fold(0.0, f64::max);
        self.largest = [largest(0), largest(1)];
    }

    /// Upper bounds on (ω h)² of the stiffest mode, and on 2γh of the most damped mode.
    pub(super) fn bounds(&self, step: f64) -> (f64, f64) {
        let [stiffness, damping] = self.largest;
        (step * step * stiffness, step * damping)
    }

    /// See [`Element::aim`].
    fn aim(&mut self, step: f64) {
        let points = &self.points;
        each(&mut self.wires, |_, wire| wire.aim(points, step));
    }

    /// Time over which the velocity differences from `other` count as position errors, s.
    fn velocity_counts(&self, other: &State) -> f64 {
        let faster = |i: usize| self.points.velocities[i] - other.velocities[i];
        let (mut motion, mut stiffened) = (0.0, 0.0);
        for (i, inverse_mass) in self.points.inverse_masses.iter().enumerate() {
            motion += faster(i).length_squared() / inverse_mass;
        }
        for wire in &self.wires {
            let [a, b] = wire.ends.map(|end| faster(end as usize));
            let along = wire.side.normalize_or_zero();
            stiffened += wire.stiffness * (b - a).dot(along).powi(2);
        }
        velocity_counts(motion, stiffened)
    }

    fn drift(&mut self, time: f64) {
        let velocities = &self.points.velocities;
        each(&mut self.points.positions, |at, position| {
            *position += time * velocities[at];
        });
    }
}

impl Steppable for Points {
    fn save(&mut self, slot: usize) {
        let saved = &mut self.saved[slot];
        saved.points.copy_from(&self.points);
        copy(&mut saved.wires, &self.wires);
        copy(&mut saved.exchanged, &self.exchanged);
    }

    fn load(&mut self, slot: usize) {
        let saved = &self.saved[slot];
        self.points.copy_from(&saved.points);
        copy(&mut self.wires, &saved.wires);
        copy(&mut self.exchanged, &saved.exchanged);
    }

    fn least(&mut self, time: f64, most: u32) -> Least {
        let (z, _) = self.bounds(time);
        let least = network_steps(z, self.wires.len(), most);
        self.stiffest = least.in_each(z);
        least
    }

    fn run(&mut self, time: f64, count: u32) {
        let step = time / f64::from(count);
        self.aim(step);
        for _ in 0..count {
            self.drift(step / 2.0);
            self.kick(step);
            self.aim(step);
        }
    }

    fn distance(&self, slot: usize) -> f64 {
        let (now, other) = (&self.points, &self.saved[slot].points);
        let counts = self.velocity_counts(other);
        let apart = |i: usize| {
            now.positions[i].distance(other.positions[i])
                + counts * now.velocities[i].distance(other.velocities[i])
        };
        (0..now.len()).map(apart).fold(0.0, f64::max)
    }

    fn travelled(&self, slot: usize) -> f64 {
        fn change(now: &[DVec3], before: &[DVec3]) -> f64 {
            spread(now.iter().zip(before).map(|(now, was)| now - was))
        }
        let (now, before) = (&self.points, &self.saved[slot].points);
        change(&now.positions, &before.positions)
            + self.velocity_counts(before) * change(&now.velocities, &before.velocities)
    }

    fn extrapolate(&mut self, slot: usize) {
        let saved = &self.saved[slot];
        for (fine, coarse) in self.exchanged.iter_mut().zip(&saved.exchanged) {
            fine.heat += (fine.heat - coarse.heat) / 3.0;
            fine.work += (fine.work - coarse.work) / 3.0;
        }
        let (now, saved) = (&mut self.points, &saved.points);
        for (fine, coarse) in [
            (&mut now.positions, &saved.positions),
            (&mut now.velocities, &saved.velocities),
            (&mut now.given, &saved.given),
        ] {
            for (fine, coarse) in fine.iter_mut().zip(coarse) {
                *fine += (*fine - coarse) / 3.0;
            }
        }
    }

    fn is_resolved(&mut self, step: f64) -> bool {
        let (z, g) = self.bounds(step);
        converges(z, g)
    }
}

#[cfg(test)]
mod tests;
