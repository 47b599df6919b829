//! In the engine's solver, velocities belong to a time half a substep before the positions. So they are shifted in time when the
//! engine begins and ends to solve a component, and when the game changes a force at once.

use super::write::Engine;
use crate::backend::Sight;
use crate::backend::rapier::body::handle;
use crate::backend::rapier::held::order::Order;
use crate::backend::rapier::held::plan::Plan;
use crate::dynamics::body::Body;
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Members};
use crate::scene::step::Step;

/// (ω h)² of a substep up to which a spring is followed within it. Of the force of a stiffer one, the engine applies only a part.
/// Pinned by `ground::winch`.
const ABSORBED: f64 = 1.0;

/// Shifts the velocities of a component in time by `by` seconds (half a substep, either sign). Velocities stay within the engine's
/// caps. Bodies under contact pressure are left out, because only the engine knows the forces on them.
pub(crate) fn stagger(
    plan: &Plan,
    by: f64,
    step: &Step,
    members: &Members,
    bodies: &[BodyRow],
    engine: &mut Engine,
) {
    let mut moved = plan.bodies.clone();
    for body in &mut moved {
        body.apply_external(by);
    }
    for order in &plan.orders {
        let rate = order.line.motion(&order.element, &plan.bodies, 0.0).axial;
        let tension = order
            .pieces
            .tension(order.line.distance(), lasting(order, by) * rate);
        let impulse = -by * tension * order.line.direction;
        order.line.impulse(&mut moved, impulse);
    }
    set_velocities(&moved, step, members, bodies, engine);
}

/// Takes back half of the impulse that a change of force by the game gives in the next substep, of `substep` seconds. In the half
/// substep before the change, the force was still the old one. With the whole impulse, a load that a winch lowers would fall too
/// far, and the winch would do work that no ledger has. Pinned by `ground::winch`.
pub(crate) fn absorb_jumps(
    plan: &Plan,
    substep: f64,
    step: &Step,
    members: &Members,
    elements: &[ElementRow],
    bodies: &[BodyRow],
    engine: &mut Engine,
) {
    let by = 0.5 * substep;
    let mut moved = None;
    for order in &plan.orders {
        let row = &elements[order.row];
        if !row.has(ElementFlags::JUMPED) {
            continue;
        }
        let stiffness: f64 = order.pieces.iter().map(|p| p.tangent.stiffness).sum();
        if stiffness * order.line.inverse_mass * substep * substep > ABSORBED {
            continue;
        }
        let moved = moved.get_or_insert_with(|| plan.bodies.clone());
        let impulse = by * lasting(order, by) * row.rare.jump.by * order.line.direction;
        order.line.impulse(moved, impulse);
    }
    if let Some(moved) = moved {
        set_velocities(&moved, step, members, bodies, engine);
    }
}

/// Share of a rate that lasts for a time of `by` seconds: a strong damper has reduced it within the substep.
fn lasting(order: &Order, by: f64) -> f64 {
    let damping: f64 = order.pieces.iter().map(|p| p.tangent.damping).sum();
    (1.0 + 2.0 * by.abs() * damping * order.line.inverse_mass).powi(-2)
}

fn set_velocities(
    moved: &[Body],
    step: &Step,
    members: &Members,
    bodies: &[BodyRow],
    engine: &mut Engine,
) {
    for (b, moved) in members.bodies.iter().zip(moved) {
        let row = &bodies[*b as usize];
        let free = !row.has(BodyFlags::PRESSED);
        let seen = engine.sight().see(row.id).filter(|_| free);
        let (Some(seen), Some(body)) = (seen, engine.bodies.get_mut(handle(row.id))) else {
            continue;
        };
        let velocity = moved.velocity.clamp_length_max(step.plan.fastest);
        let fastest_spin = step.farthest_turn(&seen) / step.plan.time;
        let spin = moved.angular_velocity();
        let spin = spin.clamp_length_max(fastest_spin.min(f64::from(f32::MAX)));
        if (velocity + spin).is_finite() {
            body.set_linvel(velocity.as_vec3(), false);
            body.set_angvel(spin.as_vec3(), false);
        }
    }
}
