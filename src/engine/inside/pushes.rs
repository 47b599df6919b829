//! How much faster springs can make bodies within a step: what has to know its contacts ahead has to know that too.

use super::write::Solver;
use crate::engine::body::point_of;
use crate::engine::rows::{BodyRow, ElementRow, Held, Members};
use crate::engine::step::Step;
use bevy_rapier3d::rapier::dynamics::RigidBodySet;

impl Solver {
    /// Finds how much faster springs can make each body of a component in a step, m/s.
    pub(in crate::engine) fn find_pushes(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &[ElementRow],
        bodies: &[BodyRow],
        set: &RigidBodySet,
    ) {
        self.pushes.clear();
        self.pushes.resize(members.bodies.len(), 0.0);
        let elements = members.elements.iter().map(|e| &elements[*e]);
        for row in elements.filter(|row| !row.companion.guide.is_twist()) {
            if row.parameters.rest_length.is_none() {
                continue;
            }
            let [a, b] = [0, 1].map(|end| match row.held[end] {
                Held::Body { handle, local, .. } if row.on[end].is_some() => set
                    .get(handle)
                    .map_or(local, |body| point_of(body, local).0),
                ref held => step.path(held, set).0,
            });
            let force = row.elastic(a.distance(b)).force.abs();
            for body in row.on.iter().flatten() {
                let of = &bodies[*body as usize];
                if let Some(body) = set.get(of.handle) {
                    let inverse_mass = f64::from(body.mass_properties().local_mprops.inv_mass);
                    self.pushes[of.slot] += (force * inverse_mass * step.plan.time) as f32;
                }
            }
        }
    }
}
