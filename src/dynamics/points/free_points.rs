//! Continues a network of points from one step to the next without loading it again. If only the engine has moved it
//! since, only the state of its points must be read.

use super::{Exchanged, Point, Points, Wire};
use crate::dynamics::body::{Body, is_within};
use crate::dynamics::element::{Element, End};
use crate::threads::{PIECE, all, copy, each};
use bevy::math::DVec3;

/// The centre of mass of a body before a step, or an end that elements do not move.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FreePoint {
    pub position: DVec3,
    pub velocity: DVec3,
    /// Acceleration from everything but elements, m/s².
    pub acceleration: DVec3,
    /// Inverse mass, 1/kg; 0 if elements cannot move the point.
    pub inverse_mass: f64,
}

/// Motion of a body over a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flight {
    /// Displacement, m.
    pub moved: DVec3,
    /// Velocity at the end of the step, m/s.
    pub velocity: DVec3,
}

impl Point {
    /// Places a body. Returns whether its mass is unchanged and its state is finite.
    fn place(&mut self, at: &FreePoint) -> bool {
        let is_same = self.inverse_mass == at.inverse_mass;
        *self = Self {
            acceleration: at.acceleration,
            inverse_mass: at.inverse_mass,
            ..Self::prescribed(at.position, at.velocity)
        };
        is_same && (at.position + at.velocity + at.acceleration).is_finite()
    }
}

impl Points {
    /// Accelerations from which the iterations of the next solve start.
    pub(in crate::dynamics) fn solution(&self) -> &[DVec3] {
        &self.solver.solution
    }

    /// Makes the next iterations start from zero.
    pub(in crate::dynamics) fn forget_solution(&mut self) {
        self.solver.solution.clear();
    }

    /// Makes the next iterations start from `solution`, if it is finite.
    pub(in crate::dynamics) fn start_from(&mut self, solution: &[DVec3]) {
        if solution.iter().all(|x| x.is_finite()) {
            self.solver.solution.clear();
            self.solver.solution.extend_from_slice(solution);
        }
    }

    /// Prepares a newly loaded network for its step.
    pub(in crate::dynamics) fn begin(&mut self, budget: u32) {
        self.budget = budget;
        self.converged = true;
        copy(&mut self.start, &self.points);
    }

    /// Prepares a network that continues from the last step for its next step.
    pub(in crate::dynamics) fn go_on(&mut self, budget: u32) {
        each(&mut self.exchanged, |_, exchanged| {
            *exchanged = Exchanged::default();
        });
        self.begin(budget);
    }

    /// Places all bodies where the engine has moved them. Returns whether all masses are unchanged and all states are
    /// finite.
    pub(crate) fn place<'a>(&mut self, at: impl Fn(usize) -> &'a FreePoint + Sync) -> bool {
        let pieces = self.points[..self.bodies].chunks_mut(PIECE).enumerate();
        all(pieces, |(piece, points)| {
            let first = piece * PIECE;
            let mut places = points.iter_mut().zip(first..);
            places.all(|(point, body)| point.place(at(body)))
        })
    }

    /// Places an end that elements cannot move. `end` counts these ends in the order of the elements.
    pub(crate) fn place_end(&mut self, end: usize, position: DVec3, velocity: DVec3) {
        let index = self.bodies + end;
        self.points[index] = Point::prescribed(position, velocity);
    }

    /// State of a body at the start of the step.
    pub(crate) fn origin(&self, body: usize) -> FreePoint {
        let start = &self.start[body];
        FreePoint {
            position: start.position,
            velocity: start.velocity,
            acceleration: start.acceleration,
            inverse_mass: start.inverse_mass,
        }
    }

    /// Motion of a body over the step.
    pub(crate) fn flight(&self, body: usize) -> Flight {
        let (start, end) = (&self.start[body], &self.points[body]);
        Flight {
            moved: end.position - start.position,
            velocity: end.velocity,
        }
    }

    /// Direction of an element, and its heat and work in the step, J.
    pub(crate) fn result(&self, element: usize) -> (Option<DVec3>, f64, f64) {
        let Exchanged { heat, work } = self.exchanged[element];
        (self.wires[element].side.try_normalize(), heat, work)
    }

    /// Whether the engine can move all bodies as the step did, if it moves none farther than `farthest` (m) in `time`
    /// seconds.
    pub(in crate::dynamics) fn are_within(&self, farthest: f64, time: f64) -> bool {
        let bodies = self.points[..self.bodies].chunks(PIECE);
        all(bodies.zip(self.start.chunks(PIECE)), |(bodies, start)| {
            bodies.iter().zip(start).all(|(end, start)| {
                let by = end.position - start.position;
                is_within(by, end.velocity, farthest / time, time)
            })
        })
    }

    pub(in crate::dynamics) fn are_finite(&self) -> bool {
        let finite = |point: &Point| (point.position + point.velocity).is_finite();
        let bodies = self.points[..self.bodies].chunks(PIECE);
        all(bodies, |bodies| bodies.iter().all(finite))
    }

    /// Resets bodies and elements to the start of the step. Steps on the points alone have left them out of date.
    pub(in crate::dynamics) fn restore(&self, elements: &mut [Element], bodies: &mut [Body]) {
        for (body, point) in bodies.iter_mut().zip(&self.start) {
            body.position = point.position;
            body.velocity = point.velocity;
            body.acceleration = point.acceleration;
            body.given = (DVec3::ZERO, DVec3::ZERO);
        }
        for (element, wire) in elements.iter_mut().zip(&self.wires) {
            self.restore_element(element, wire);
        }
    }

    fn restore_element(&self, element: &mut Element, wire: &Wire) {
        for (end, index) in element.ends.iter_mut().zip(wire.ends) {
            if let End::Path(path) = end {
                let start = &self.start[index as usize];
                (path.position, path.velocity) = (start.position, start.velocity);
            }
        }
        // The direction at the start of the step.
        element.direction = wire.aimed(wire.of(&self.start)).try_normalize();
        (element.heat, element.work) = (0.0, 0.0);
    }
}
