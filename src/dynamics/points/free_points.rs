//! From one step into the next without being taken apart: where only the engine has moved a network since,
//! nothing but its points' places has to be read again.

use super::{Exchanged, Point, Points, Wire};
use crate::dynamics::body::{Body, is_within};
use crate::dynamics::element::{Element, End};
use crate::threads::{PIECE, all, copy, each};
use bevy::math::DVec3;

/// A body before a step, as the point that its centre of mass is; or an end that nothing here moves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FreePoint {
    pub position: DVec3,
    pub velocity: DVec3,
    /// By everything but elements.
    pub acceleration: DVec3,
    /// 0 of one that elements cannot move.
    pub inverse_mass: f64,
}

/// What a step made of a body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flight {
    /// How far it went, m.
    pub moved: DVec3,
    /// At the end, m/s.
    pub velocity: DVec3,
}

impl Point {
    /// Moves a body there; says whether it is the same mass still.
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
    /// What iterations of the next solve start from.
    pub(in crate::dynamics) fn solution(&self) -> &[DVec3] {
        &self.solver.solution
    }

    /// Has them start from nothing.
    pub(in crate::dynamics) fn forget_solution(&mut self) {
        self.solver.solution.clear();
    }

    /// Has iterations start there, if that is a place.
    pub(in crate::dynamics) fn start_from(&mut self, solution: &[DVec3]) {
        if solution.iter().all(|x| x.is_finite()) {
            self.solver.solution.clear();
            self.solver.solution.extend_from_slice(solution);
        }
    }

    /// Readies what has been taken in for its step.
    pub(in crate::dynamics) fn begin(&mut self, budget: u32) {
        self.budget = budget;
        self.converged = true;
        copy(&mut self.start, &self.points);
    }

    /// Readies what goes on from the last step for its next.
    pub(in crate::dynamics) fn go_on(&mut self, budget: u32) {
        each(&mut self.exchanged, |_, exchanged| {
            *exchanged = Exchanged::default();
        });
        self.begin(budget);
    }

    /// Moves all bodies to where the engine has taken them; says whether they are the same masses still.
    pub(crate) fn place<'a>(&mut self, at: impl Fn(usize) -> &'a FreePoint + Sync) -> bool {
        let pieces = self.points[..self.bodies].chunks_mut(PIECE).enumerate();
        all(pieces, |(piece, points)| {
            let first = piece * PIECE;
            let mut places = points.iter_mut().zip(first..);
            places.all(|(point, body)| point.place(at(body)))
        })
    }

    /// Places an end that elements cannot move, counted in the order of the elements.
    pub(crate) fn place_end(&mut self, end: usize, position: DVec3, velocity: DVec3) {
        let index = self.bodies + end;
        self.points[index] = Point::prescribed(position, velocity);
    }

    /// Where a body began the step.
    pub(crate) fn origin(&self, body: usize) -> FreePoint {
        let start = &self.start[body];
        FreePoint {
            position: start.position,
            velocity: start.velocity,
            acceleration: start.acceleration,
            inverse_mass: start.inverse_mass,
        }
    }

    /// What the step made of a body.
    pub(crate) fn flight(&self, body: usize) -> Flight {
        let (start, end) = (&self.start[body], &self.points[body]);
        Flight {
            moved: end.position - start.position,
            velocity: end.velocity,
        }
    }

    /// Of an element its direction, and the heat and the work of the step.
    pub(crate) fn result(&self, element: usize) -> (Option<DVec3>, f64, f64) {
        let Exchanged { heat, work } = self.exchanged[element];
        (self.wires[element].side.try_normalize(), heat, work)
    }

    /// Whether the engine takes all of them along, if it flies none further than so far in such a time.
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

    /// Has bodies and elements that took no part since stand as at the start of the step.
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
        // As it was aimed when the step began.
        element.direction = wire.aimed(wire.of(&self.start)).try_normalize();
        (element.heat, element.work) = (0.0, 0.0);
    }
}
