//! From one step into the next without being taken apart: where only the engine has moved a network since,
//! nothing but its points' places has to be read again.

use super::{Point, Points, Wire};
use crate::dynamics::body::{Body, is_within};
use crate::dynamics::element::{Element, End};
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

impl Points {
    /// What iterations of the next solve start from.
    pub(in crate::dynamics) fn solution(&self) -> &[DVec3] {
        &self.solver.solution
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
        self.start.clone_from(&self.points);
    }

    /// Moves a body to where the engine has taken it; says whether it is the same mass still.
    pub(crate) fn place(&mut self, body: usize, at: &FreePoint) -> bool {
        let point = &mut self.points[body];
        let is_same = point.inverse_mass == at.inverse_mass;
        *point = Point {
            acceleration: at.acceleration,
            inverse_mass: at.inverse_mass,
            ..Point::prescribed(at.position, at.velocity)
        };
        is_same && (at.position + at.velocity + at.acceleration).is_finite()
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

    /// Of each element in turn its direction, and the heat and the work of the step, which are forgotten with
    /// this.
    pub(crate) fn take_results(&mut self) -> impl Iterator<Item = (Option<DVec3>, f64, f64)> {
        self.wires.iter_mut().map(|wire| {
            let (heat, work) = (
                std::mem::take(&mut wire.heat),
                std::mem::take(&mut wire.work),
            );
            (wire.side.try_normalize(), heat, work)
        })
    }

    /// Whether the engine takes all of them along, if it flies none further than so far in such a time.
    pub(in crate::dynamics) fn are_within(&self, farthest: f64, time: f64) -> bool {
        let mut moves = self.points.iter().zip(&self.start).take(self.bodies);
        moves.all(|(end, start)| {
            let by = end.position - start.position;
            is_within(by, end.velocity, farthest / time, time)
        })
    }

    pub(in crate::dynamics) fn are_finite(&self) -> bool {
        self.points[..self.bodies]
            .iter()
            .all(|point| (point.position + point.velocity).is_finite())
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
