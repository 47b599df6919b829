//! Estimates the speed that springs can add to bodies within a step. The search for coming contacts needs it.

use crate::backend::Sight;
use crate::backend::rapier::held::write::Solver;
use crate::dynamics::guide::Guide;
use crate::scene::rows::{BodyRow, ElementRow, Held, Members};
use crate::scene::step::Step;
use bevy::math::{DQuat, DVec3};

impl Solver {
    /// Computes into `pushes` the speed that springs can add to each body of a component in a step, m/s.
    pub(crate) fn find_pushes(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &[ElementRow],
        bodies: &[BodyRow],
        sight: &impl Sight,
    ) {
        self.pushes.clear();
        self.pushes.resize(members.bodies.len(), 0.0);
        let elements = members.elements.iter().map(|e| &elements[*e as usize]);
        for row in elements.filter(|row| !row.rare.guide.is_twist()) {
            if row.numbers.rest_length.is_none() {
                continue;
            }
            let ends = [0, 1].map(|end| match row.rare.held[end] {
                Held::Body { body, local, .. } if row.movable(end).is_some() => {
                    sight.see(body).map_or(local, |body| body.point(local).0)
                }
                ref held => step.path(held, sight)[0],
            });
            let force = row.elastic(length(row, ends, sight)).force.abs();
            for body in row.all_movable() {
                let of = &bodies[body];
                if let Some(body) = sight.see(of.id) {
                    let inverse_mass = f64::from(body.inverse_mass);
                    self.pushes[of.rare.slot as usize] +=
                        (force * inverse_mass * step.plan.time) as f32;
                }
            }
        }
    }
}

/// Length of an element whose ends are at two points, m: along its axis if it has one.
fn length(row: &ElementRow, [a, b]: [DVec3; 2], sight: &impl Sight) -> f64 {
    match row.rare.guide {
        Guide::Centres | Guide::Twist(_) => a.distance(b),
        Guide::World(axis) => (b - a).dot(axis),
        Guide::OfA(axis) => {
            let facing = match row.rare.held[0] {
                Held::Body { body, .. } => sight.see(body).map(|body| body.facing()),
                Held::Path { .. } => None,
            };
            (b - a).dot(facing.unwrap_or(DQuat::IDENTITY) * axis)
        }
    }
}
