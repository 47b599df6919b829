//! How much faster springs can make bodies within a step: what has to know its contacts ahead has to know that too.

use crate::backend::Sight;
use crate::backend::rapier::held::write::Solver;
use crate::scene::rows::{BodyRow, ElementRow, Held, Members};
use crate::scene::step::Step;

impl Solver {
    /// Finds how much faster springs can make each body of a component in a step, m/s.
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
        let elements = members.elements.iter().map(|e| &elements[*e]);
        for row in elements.filter(|row| !row.companion.guide.is_twist()) {
            if row.parameters.rest_length.is_none() {
                continue;
            }
            let [a, b] = [0, 1].map(|end| match row.held[end] {
                Held::Body { body, local, .. } if row.on[end].is_some() => {
                    sight.see(body).map_or(local, |body| body.point(local).0)
                }
                ref held => step.path(held, sight)[0],
            });
            let force = row.elastic(a.distance(b)).force.abs();
            for body in row.on.iter().flatten() {
                let of = &bodies[*body as usize];
                if let Some(body) = sight.see(of.id) {
                    let inverse_mass = f64::from(body.inverse_mass);
                    self.pushes[of.slot] += (force * inverse_mass * step.plan.time) as f32;
                }
            }
        }
    }
}
