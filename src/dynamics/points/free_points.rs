//! Continues a network of points from one step to the next without loading it again. If only the engine has moved it
//! since, only the state of its points must be read.

use super::{Exchanged, Points, State, Wire};
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
pub(crate) struct PointStep {
    /// Displacement, m.
    pub by: DVec3,
    /// Velocity at the end of the step, m/s.
    pub velocity: DVec3,
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
        let [positions, velocities] = &mut self.start;
        copy(positions, &self.points.positions);
        copy(velocities, &self.points.velocities);
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
        let State {
            bodies,
            positions,
            velocities,
            accelerations,
            inverse_masses,
            given,
        } = &mut self.points;
        let moving = positions[..*bodies].chunks_mut(PIECE);
        let moving = moving.zip(velocities[..*bodies].chunks_mut(PIECE));
        let others = accelerations.chunks_mut(PIECE);
        let others = others.zip(inverse_masses.chunks_mut(PIECE));
        let pieces = moving.zip(others).zip(given.chunks_mut(PIECE)).enumerate();
        all(pieces, |(piece, ((moving, others), given))| {
            let ((positions, velocities), (accelerations, inverse_masses)) = (moving, others);
            let mut sound = true;
            for (i, given) in given.iter_mut().enumerate() {
                let at = at(piece * PIECE + i);
                sound &= inverse_masses[i] == at.inverse_mass
                    && (at.position + at.velocity + at.acceleration).is_finite();
                positions[i] = at.position;
                velocities[i] = at.velocity;
                accelerations[i] = at.acceleration;
                inverse_masses[i] = at.inverse_mass;
                *given = DVec3::ZERO;
            }
            sound
        })
    }

    /// Places an end that elements cannot move. `end` counts these ends in the order of the elements.
    pub(crate) fn place_end(&mut self, end: usize, position: DVec3, velocity: DVec3) {
        let index = self.points.bodies + end;
        self.points.positions[index] = position;
        self.points.velocities[index] = velocity;
    }

    /// State of a body at the start of the step.
    #[inline(always)]
    pub(crate) fn origin(&self, body: usize) -> FreePoint {
        let [positions, velocities] = &self.start;
        FreePoint {
            position: positions[body],
            velocity: velocities[body],
            acceleration: self.points.accelerations[body],
            inverse_mass: self.points.inverse_masses[body],
        }
    }

    /// Motion of a body over the step.
    #[inline(always)]
    pub(crate) fn step_of(&self, body: usize) -> PointStep {
        PointStep {
            by: self.points.positions[body] - self.start[0][body],
            velocity: self.points.velocities[body],
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
        let (points, bodies) = (&self.points, self.points.bodies);
        let places = points.positions[..bodies].chunks(PIECE);
        let places = places.zip(self.start[0].chunks(PIECE));
        let pieces = places.zip(points.velocities[..bodies].chunks(PIECE));
        all(pieces, |((positions, start), velocities)| {
            let mut moves = positions.iter().zip(start).zip(velocities);
            moves.all(|((position, start), velocity)| {
                is_within(*position - *start, *velocity, farthest / time, time)
            })
        })
    }

    pub(in crate::dynamics) fn are_finite(&self) -> bool {
        let (points, bodies) = (&self.points, self.points.bodies);
        let positions = points.positions[..bodies].chunks(PIECE);
        all(
            positions.zip(points.velocities[..bodies].chunks(PIECE)),
            |(positions, velocities)| {
                let mut states = positions.iter().zip(velocities);
                states.all(|(position, velocity)| (*position + *velocity).is_finite())
            },
        )
    }

    /// Resets bodies and elements to the start of the step. Steps on the points alone have left them out of date.
    pub(in crate::dynamics) fn restore(&self, elements: &mut [Element], bodies: &mut [Body]) {
        for (i, body) in bodies.iter_mut().enumerate() {
            let start = self.origin(i);
            body.position = start.position;
            body.velocity = start.velocity;
            body.acceleration = start.acceleration;
            body.given = (DVec3::ZERO, DVec3::ZERO);
        }
        for (element, wire) in elements.iter_mut().zip(&self.wires) {
            self.restore_element(element, wire);
        }
    }

    fn restore_element(&self, element: &mut Element, wire: &Wire) {
        let [positions, velocities] = &self.start;
        for (end, index) in element.ends.iter_mut().zip(wire.ends) {
            if let End::Path(path) = end {
                let index = index as usize;
                (path.position, path.velocity) = (positions[index], velocities[index]);
            }
        }
        // The direction at the start of the step.
        element.direction = wire.aimed(wire.of(positions)).try_normalize();
        (element.heat, element.work) = (0.0, 0.0);
    }
}
