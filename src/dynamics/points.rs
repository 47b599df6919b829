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
mod survey;

use super::body::{Body, Spin};
use super::element::{Element, End, rounding};
use super::excited::spread;
use super::guide::Guide;
use super::resolution::{EXTRAPOLATION_LIMIT, network_steps};
use super::tolerance::{Least, Motion, velocity_counts};
use crate::threads::{copy, each};
use bar::{Bar, Load};
use bevy::math::DVec3;
pub(crate) use free_points::{Flight, FreePoint};
use parts::Parts;
use solve::Solver;
use survey::Survey;

/// The centre of mass of a body, or an end with prescribed motion.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    position: DVec3,
    velocity: DVec3,
    /// Acceleration from everything but elements, m/s².
    acceleration: DVec3,
    /// Impulse from elements so far in this step, N s.
    given: DVec3,
    /// Inverse mass, 1/kg; 0 if elements cannot move the point.
    inverse_mass: f64,
}

/// One element.
#[derive(Clone, Copy, Debug)]
struct Wire {
    ends: [u32; 2],
    stiffness: f64,
    damping: f64,
    rest_length: f64,
    /// Vector towards end B at the start of the micro-step, of any length; zero if it is unknown.
    side: DVec3,
    /// See [`Element::stiff_damper`].
    stiff_damper: bool,
}

/// Heat of an element's damper, and work of its ends with prescribed motion, so far in this step, J.
#[derive(Clone, Copy, Debug, Default)]
struct Exchanged {
    heat: f64,
    work: f64,
}

/// A state that can be restored.
#[derive(Clone, Default)]
struct Saved {
    points: Vec<Point>,
    wires: Vec<Wire>,
    exchanged: Vec<Exchanged>,
}

/// A network of points, kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Points {
    points: Vec<Point>,
    /// Points at the start of the step.
    start: Vec<Point>,
    /// Number of points that are bodies. They come first; the ends with prescribed motion come after them.
    bodies: usize,
    wires: Vec<Wire>,
    /// Heat and work of each element.
    exchanged: Vec<Exchanged>,
    /// For each point, the stiffness of its elements over its mass, 1/s²; see [`super::network::Network`].
    stiffness: Vec<f64>,
    /// For each point, the damping of its elements over its mass, 1/s.
    damping: Vec<f64>,
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

/// Direction and length of a line; see [`Element::line`].
#[derive(Clone, Copy)]
struct Line {
    direction: DVec3,
    length: f64,
}

impl Point {
    fn of(body: &Body) -> Self {
        Self {
            position: body.position,
            velocity: body.velocity,
            acceleration: body.acceleration,
            given: body.given.0,
            inverse_mass: body.inverse_mass.x,
        }
    }

    fn prescribed(position: DVec3, velocity: DVec3) -> Self {
        Self {
            position,
            velocity,
            acceleration: DVec3::ZERO,
            given: DVec3::ZERO,
            inverse_mass: 0.0,
        }
    }
}

impl Wire {
    fn tension(&self, length: f64, rate: f64) -> f64 {
        self.stiffness * (length - self.rest_length) + self.damping * rate
    }

    fn of<'a>(&self, points: &'a [Point]) -> [&'a Point; 2] {
        self.ends.map(|end| &points[end as usize])
    }

    /// Shares of its stiffness and damping that count at its two ends, 1/kg.
    fn shares(&self, ends: [&Point; 2]) -> [f64; 2] {
        let w = ends.map(|end| end.inverse_mass.sqrt());
        w.map(|own| own * (w[0] + w[1]))
    }

    /// Vector from end A to end B, or the last known one if the ends coincide.
    fn aimed(&self, [a, b]: [&Point; 2]) -> DVec3 {
        let d = b.position - a.position;
        if d.length_squared() > noise(a, b) {
            d
        } else {
            self.side
        }
    }

    /// See [`Element::aim`].
    #[inline(always)]
    fn aim(&mut self, ends: [&Point; 2], step: f64) {
        self.side = self.aimed(ends);
        self.stiff_damper = false;
        if self.damping > 0.0 && self.rest_length == 0.0 {
            let inverse_mass = ends[0].inverse_mass + ends[1].inverse_mass;
            let resolved = self.stiffness * inverse_mass * step * step < 4.0;
            self.stiff_damper = resolved && self.damping * inverse_mass * step > 0.5;
        }
    }

    #[inline(always)]
    fn line(&self, [a, b]: [&Point; 2]) -> Option<Line> {
        let d = b.position - a.position;
        let square = d.length_squared();
        if square > noise(a, b) {
            let distance = square.sqrt();
            let length = if d.dot(self.side) < 0.0 {
                -distance
            } else {
                distance
            };
            let direction = d / length;
            return Some(Line { direction, length });
        }
        let direction = if self.side != DVec3::ZERO {
            self.side.normalize()
        } else if self.rest_length == 0.0 {
            let hint = (b.velocity - a.velocity) + (b.acceleration - a.acceleration);
            hint.try_normalize().unwrap_or(DVec3::Y)
        } else {
            return None;
        };
        let length = d.dot(direction);
        Some(Line { direction, length })
    }
}

/// Square of the distance up to which two points may coincide but for rounding of the engine's f32, m².
fn noise(a: &Point, b: &Point) -> f64 {
    rounding(a.position, b.position).powi(2)
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
        self.points.clear();
        self.points.reserve_exact(bodies.len() + prescribed);
        self.points.extend(bodies.iter().map(Point::of));
        self.bodies = bodies.len();
        self.wires.clear();
        self.wires.reserve_exact(elements.len());
        self.exchanged.clear();
        self.exchanged.reserve_exact(elements.len());
        for element in elements {
            let ends = element.ends.map(|end| match end {
                End::Body { index, .. } => index as u32,
                End::Path(path) => {
                    let point = Point::prescribed(path.position, path.velocity);
                    self.points.push(point);
                    self.points.len() as u32 - 1
                }
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
        self.parts.find(&self.wires, self.bodies);
        self.add_up();
        self.begin(budget);
    }

    /// Writes the result of the step into elements and bodies.
    pub(super) fn store_into(&mut self, elements: &mut [Element], bodies: &mut [Body]) {
        for (body, point) in bodies.iter_mut().zip(&self.points) {
            body.position = point.position;
            body.velocity = point.velocity;
            body.given.0 = point.given;
        }
        let wires = self.wires.iter().zip(&self.exchanged);
        for (element, (wire, exchanged)) in elements.iter_mut().zip(wires) {
            for (end, index) in element.ends.iter_mut().zip(wire.ends) {
                if let End::Path(path) = end {
                    path.position = self.points[index as usize].position;
                }
            }
            element.direction = wire.side.try_normalize();
            element.stiff_damper = wire.stiff_damper;
            (element.heat, element.work) = (exchanged.heat, exchanged.work);
        }
    }

    /// Whether all solves of this step have converged.
    pub(super) fn converged(&self) -> bool {
        self.converged
    }

    /// Sums up stiffness and damping over mass for every point.
    fn add_up(&mut self) {
        for sums in [&mut self.stiffness, &mut self.damping] {
            sums.clear();
            sums.resize(self.points.len(), 0.0);
        }
        for wire in &self.wires {
            let shares = wire.shares(wire.of(&self.points));
            for (end, share) in wire.ends.iter().zip(shares) {
                self.stiffness[*end as usize] += wire.stiffness * share;
                self.damping[*end as usize] += wire.damping * share;
            }
        }
    }

    /// Upper bounds on (ω h)² of the stiffest mode, and on 2γh of the most damped mode.
    pub(super) fn bounds(&self, step: f64) -> (f64, f64) {
        let largest = |sums: &[f64]| sums.iter().copied().fold(0.0, f64::max);
        (
            step * step * largest(&self.stiffness),
            step * largest(&self.damping),
        )
    }

    /// See [`Element::aim`].
    fn aim(&mut self, step: f64) {
        let points = &self.points;
        each(&mut self.wires, |_, wire| wire.aim(wire.of(points), step));
    }

    /// Time over which the velocity differences from `other` count as position errors, s.
    fn velocity_counts(&self, other: &[Point]) -> f64 {
        let faster = |i: usize| self.points[i].velocity - other[i].velocity;
        let (mut motion, mut stiffened) = (0.0, 0.0);
        for (i, point) in self.points[..self.bodies].iter().enumerate() {
            motion += faster(i).length_squared() / point.inverse_mass;
        }
        for wire in &self.wires {
            let [a, b] = wire.ends.map(|end| faster(end as usize));
            let along = wire.side.normalize_or_zero();
            stiffened += wire.stiffness * (b - a).dot(along).powi(2);
        }
        velocity_counts(motion, stiffened)
    }

    fn drift(&mut self, time: f64) {
        each(&mut self.points, |_, point| {
            point.position += time * point.velocity;
        });
    }
}

impl Motion for Points {
    fn save(&mut self, slot: usize) {
        let saved = &mut self.saved[slot];
        copy(&mut saved.points, &self.points);
        copy(&mut saved.wires, &self.wires);
        copy(&mut saved.exchanged, &self.exchanged);
    }

    fn load(&mut self, slot: usize) {
        let saved = &self.saved[slot];
        copy(&mut self.points, &saved.points);
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
            self.drift(step / 2.0);
            self.aim(step);
        }
    }

    fn distance(&self, slot: usize) -> f64 {
        let other = &self.saved[slot].points;
        let counts = self.velocity_counts(other);
        let apart = |(a, b): (&Point, &Point)| {
            a.position.distance(b.position) + counts * a.velocity.distance(b.velocity)
        };
        self.points.iter().zip(other).map(apart).fold(0.0, f64::max)
    }

    fn travelled(&self, slot: usize) -> f64 {
        let before = &self.saved[slot].points;
        let moved = self.points.iter().zip(before);
        spread(moved.clone().map(|(now, was)| now.position - was.position))
            + self.velocity_counts(before)
                * spread(moved.map(|(now, was)| now.velocity - was.velocity))
    }

    fn extrapolate(&mut self, slot: usize) {
        let saved = &self.saved[slot];
        for (fine, coarse) in self.exchanged.iter_mut().zip(&saved.exchanged) {
            fine.heat += (fine.heat - coarse.heat) / 3.0;
            fine.work += (fine.work - coarse.work) / 3.0;
        }
        for (fine, coarse) in self.points.iter_mut().zip(&saved.points) {
            fine.position += (fine.position - coarse.position) / 3.0;
            fine.velocity += (fine.velocity - coarse.velocity) / 3.0;
            fine.given += (fine.given - coarse.given) / 3.0;
        }
    }

    fn is_resolved(&mut self, step: f64) -> bool {
        let (z, g) = self.bounds(step);
        z < EXTRAPOLATION_LIMIT * EXTRAPOLATION_LIMIT && g < EXTRAPOLATION_LIMIT
    }
}

#[cfg(test)]
mod tests;
