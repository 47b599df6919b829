//! How much faster springs can make bodies within a step: what has to know its contacts ahead has to know that too.

use super::write::Solver;
use crate::engine::body::point_of;
use crate::engine::rows::{BodyRow, ElementRow, Held, Members};
use crate::engine::step::Step;
use bevy_rapier3d::rapier::dynamics::RigidBodySet;

impl Solver {
    /// Looks how much faster springs can make each body of a component, where that matters: what is new may touch
    /// something already, and what is stiff may meet something within the step.
    pub(in crate::engine) fn look_at_pushes(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &[ElementRow],
        bodies: &[BodyRow],
        set: &RigidBodySet,
    ) {
        let time = step.plan.time / f64::from(step.plan.pipeline_steps.max(1));
        let matters = members.bodies.iter().map(|b| &bodies[*b]).any(|row| {
            let stiff = || {
                set.get(row.handle)
                    .is_some_and(|body| row.is_stiff(body, time))
            };
            row.is_new || (row.can_touch && stiff())
        });
        self.pushes.clear();
        self.pushes.resize(members.bodies.len(), 0.0);
        if matters {
            pushes(step, members, elements, bodies, set, &mut self.pushes);
        }
    }
}

/// How much faster springs can make each body of a component in a step, m/s.
fn pushes(
    step: &Step,
    members: &Members,
    elements: &[ElementRow],
    bodies: &[BodyRow],
    set: &RigidBodySet,
    out: &mut [f32],
) {
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
        for (slot, b) in members.bodies.iter().enumerate() {
            if row.on.contains(&Some(*b as u32))
                && let Some(body) = set.get(bodies[*b].handle)
            {
                let inverse_mass = f64::from(body.mass_properties().local_mprops.inv_mass);
                out[slot] += (force * inverse_mass * step.plan.time) as f32;
            }
        }
    }
}
