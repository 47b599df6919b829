//! Estimates the speed that springs can add to bodies within a step. The search for coming contacts needs it.

use crate::backend::Sight;
use crate::backend::rapier::held::write::Solver;
use crate::scene::rows::{BodyRow, ElementRow, Held, Members};
use crate::scene::step::Step;

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
            let [a, b] = [0, 1].map(|end| match row.rare.held[end] {
                Held::Body { body, local, .. } if row.movable(end).is_some() => {
                    sight.see(body).map_or(local, |body| body.point(local).0)
                }
                ref held => step.path(held, sight)[0],
            });
            let force = row.elastic(a.distance(b)).force.abs();
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
