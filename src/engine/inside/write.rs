//! Into the engine: joints, substeps, and what a body needs besides them.

use super::linkage::Holding;
use super::plan::Plan;
use crate::compat;
use crate::dynamics::soft::Fineness;
use crate::dynamics::tolerance::Outcome;
use crate::engine::body::Push;
use crate::engine::group::Groups;
use crate::engine::held::Inside;
use crate::engine::held::Wanted;
use crate::engine::rows::{BodyRow, ElementRow, Held, Members};
use crate::engine::step::Step;
use bevy::math::Vec3;
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{
    IslandManager, RigidBody as RapierBody, RigidBodyBuilder, RigidBodyHandle, RigidBodySet,
};
use bevy_rapier3d::rapier::geometry::{ColliderSet, NarrowPhase};
use std::sync::atomic::Ordering;

/// Least substeps of a step. With Rapier's own four, contacts of a wheel that rolls at 12 m/s are off by a twentieth of
/// what it carries. Pinned by `ground::rolling`.
const LEAST: u32 = 16;

/// What of a Rapier context is written.
pub(in crate::engine) struct Engine<'a> {
    pub bodies: &'a mut RigidBodySet,
    pub joints: &'a mut RapierContextJoints,
    pub islands: &'a mut IslandManager,
    pub colliders: &'a mut ColliderSet,
}

/// The components of a context that the engine solves.
#[derive(Default)]
pub(in crate::engine) struct Solver {
    plans: Vec<Plan>,
    used: usize,
    wanted: Vec<Option<Wanted>>,
    /// Sweeps over all joints and contacts that a substep needs.
    sweeps: usize,
    /// How much faster springs can make each body of the component that is looked at, m/s.
    pub(in crate::engine) pushes: Vec<f32>,
}

impl Inside {
    /// Takes all that it has out of the engine.
    pub(in crate::engine) fn remove(&mut self, engine: &mut Engine) {
        self.joints.remove(&mut engine.joints.impulse_joints);
        for handle in self.hidden.iter_mut().filter_map(Option::take) {
            compat::remove(
                handle,
                engine.bodies,
                engine.islands,
                engine.colliders,
                engine.joints,
            );
        }
        self.active = false;
    }

    /// The body of the engine at an end.
    fn holder(&mut self, end: usize, held: &Held, engine: &mut Engine) -> RigidBodyHandle {
        let (from, to) = match *held {
            Held::Body { handle, .. } => return handle,
            Held::Path { from, to } => (from.as_vec3(), to.as_vec3()),
        };
        let known = self.hidden[end].filter(|handle| engine.bodies.contains(*handle));
        let handle = known.unwrap_or_else(|| {
            let body = RigidBodyBuilder::kinematic_position_based().translation(from);
            engine.bodies.insert(body)
        });
        self.hidden[end] = Some(handle);
        if let Some(body) = engine.bodies.get_mut(handle) {
            if body.translation() != from {
                body.set_translation(from, true);
            }
            if to != from {
                body.set_next_kinematic_translation(to);
            }
        }
        handle
    }
}

impl Solver {
    pub(in crate::engine) fn clear(&mut self) {
        (self.used, self.sweeps) = (0, 1);
    }

    /// Sweeps over all joints and contacts that a substep of what has been written needs.
    pub(in crate::engine) fn sweeps(&self) -> usize {
        self.sweeps
    }

    /// Reads a component that is held; says whether it is awake.
    pub(in crate::engine) fn read(
        &mut self,
        step: &Step,
        group: usize,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut Engine,
        narrow: &NarrowPhase,
        stale: &mut bool,
    ) -> bool {
        if self.plans.len() <= self.used {
            self.plans.push(Plan::default());
        }
        let plan = &mut self.plans[self.used];
        plan.group = group;
        let all = Holding {
            contacts: true,
            bodies: engine.bodies,
            joints: engine.joints,
            colliders: engine.colliders,
            narrow,
        };
        let there = plan.read(step, members, elements, bodies, all, stale);
        let (omega, disturbed) = (plan.omega as f32, plan.disturbed);
        let set = &mut *engine.bodies;
        let awake = there && step.is_awake(bodies, members.bodies, omega, set, disturbed);
        for e in members.elements {
            elements[*e].active = awake;
        }
        self.used += usize::from(awake);
        awake
    }

    /// Gives the engine what it needs to solve all components that have been read. `finest` are the most iterations that
    /// any body has by its user.
    pub(in crate::engine) fn write(
        &mut self,
        step: &Step,
        groups: &mut Groups,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut Engine,
        finest: usize,
    ) {
        let (time, calls) = (step.plan.time, step.plan.pipeline_steps.max(1));
        let own = step.engine.iterations;
        let least = LEAST.saturating_mul(step.accuracy.fineness());
        let fineness: Vec<_> = self.plans[..self.used]
            .iter()
            .map(|plan| {
                let undamped = plan.undamped(time / f64::from(least));
                Fineness::of(plan.omega, undamped, time, least, step.most_substeps)
            })
            .collect();
        let iterations = |f: &Fineness| (f.substeps.div_ceil(calls) as usize).max(own);
        let most = fineness.iter().map(iterations).max().unwrap_or(own);
        let most = most.max(own + finest);
        let substep = |iterations: usize| time / (iterations as f64 * f64::from(calls));
        for (plan, fineness) in self.plans[..self.used].iter_mut().zip(fineness) {
            let mut chosen = iterations(&fineness);
            if chosen < most && !plan.stands_finer(substep(chosen), substep(most)) {
                // What it touches may be solved more finely than it is, and then it would be too.
                chosen = most;
            }
            let group = &groups.list()[plan.group];
            let members = groups.members(group);
            let h = substep(chosen);
            let substeps = chosen as u32 * calls;
            self.sweeps = self.sweeps.max(plan.sweeps(h));
            if !group.inside {
                stagger(plan, -0.5 * h, step, &members, bodies, engine.bodies);
            }
            let wanted = &mut self.wanted;
            join(plan, wanted, &members, elements, engine, [h, time]);
            for e in members.elements {
                let row = &mut elements[*e];
                let acts = row.inside.as_ref().is_some_and(|inside| inside.active);
                row.outcome = if acts {
                    fineness.outcome(substeps)
                } else {
                    Outcome::default()
                };
            }
            for b in members.bodies {
                let row = &mut bodies[*b];
                row.substep = h;
                (row.is_fresh, row.is_alone) = (true, false);
                if let Some(body) = engine.bodies.get_mut(row.handle) {
                    row.raised.raise(body, chosen - own);
                }
            }
            take_back_excess(plan, &members, bodies, engine.bodies);
            groups.at(plan.group).inside = true;
            step.delivered.store(true, Ordering::Relaxed);
        }
        self.used = 0;
    }

    /// Takes a component out of the engine's solver again; it has been read last.
    pub(in crate::engine) fn release(
        &mut self,
        step: &Step,
        groups: &mut Groups,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut Engine,
    ) {
        let Some(used) = self.used.checked_sub(1) else {
            return;
        };
        self.used = used;
        let plan = &mut self.plans[used];
        let members = groups.members(&groups.list()[plan.group]);
        let substep = members.bodies.first().map_or(0.0, |b| bodies[*b].substep);
        stagger(plan, 0.5 * substep, step, &members, bodies, engine.bodies);
        leave(&members, elements, bodies, engine);
        groups.at(plan.group).inside = false;
    }
}

/// Takes back by what Rapier's joints along axes of the world turn bodies too much.
fn take_back_excess(
    plan: &Plan,
    members: &Members,
    bodies: &mut [BodyRow],
    set: &mut RigidBodySet,
) {
    let excess = plan.orders.iter().filter_map(|o| o.excess_torque());
    for (slot, b) in members.bodies.iter().enumerate() {
        let row = &mut bodies[*b];
        let Some(body) = set.get_mut(row.handle) else {
            continue;
        };
        let too_much = excess.clone().filter(|(of, _)| *of == slot);
        let torque = -too_much.map(|(_, torque)| torque.as_vec3()).sum::<Vec3>();
        if torque != Vec3::ZERO || row.carries_share {
            let push = Push {
                share: [Vec3::ZERO, torque],
                ..Push::default()
            };
            row.give(&push, body);
            row.carries_share = torque != Vec3::ZERO;
        }
    }
}

/// Takes the joints of a component out of the engine, and gives back what its bodies had.
pub(in crate::engine) fn leave(
    members: &Members,
    elements: &mut [ElementRow],
    bodies: &mut [BodyRow],
    engine: &mut Engine,
) {
    for e in members.elements {
        if let Some(mut inside) = elements[*e].inside.take() {
            inside.remove(engine);
        }
    }
    for b in members.bodies {
        let row = &mut bodies[*b];
        if let Some(body) = engine.bodies.get_mut(row.handle) {
            row.raised.raise(body, 0);
        }
    }
}

/// In the engine's solver velocities are those of half a substep ago. Takes those of a component there, or back again, by
/// what acts on its bodies, as far as the engine lets them move; but for bodies that contacts press, of which only the
/// engine knows what acts.
fn stagger(
    plan: &Plan,
    by: f64,
    step: &Step,
    members: &Members,
    bodies: &[BodyRow],
    set: &mut RigidBodySet,
) {
    let mut moved = plan.bodies.clone();
    for body in &mut moved {
        let inverse_inertia = body.inverse_inertia();
        body.apply_external(by, inverse_inertia);
    }
    for order in &plan.orders {
        let rate = order.line.motion(&order.element, &plan.bodies, 0.0).axial;
        let tension = order.pieces.tension(order.line.distance(), rate);
        let impulse = -by * tension * order.line.direction;
        order.line.impulse(&mut moved, impulse);
    }
    for (b, moved) in members.bodies.iter().zip(&moved) {
        let row = &bodies[*b];
        let Some(body) = set.get_mut(row.handle).filter(|_| !row.pressed) else {
            continue;
        };
        let velocity = moved.velocity.clamp_length_max(step.engine.fastest);
        let fastest_spin = step.farthest_turn(body) / step.plan.time;
        let spin = moved.angular_velocity();
        let spin = spin.clamp_length_max(fastest_spin.min(f64::from(f32::MAX)));
        if (velocity + spin).is_finite() {
            body.set_linvel(velocity.as_vec3(), false);
            body.set_angvel(spin.as_vec3(), false);
        }
    }
}

/// Takes all joints of a component out, unless each is of the kind that is wanted; says whether they are.
fn leave_misfits(
    plan: &Plan,
    wanted: &[Option<Wanted>],
    members: &Members,
    elements: &mut [ElementRow],
    engine: &mut Engine,
) -> bool {
    let set = &mut engine.joints.impulse_joints;
    let mut fit = true;
    for (order, wanted) in plan.orders.iter().zip(wanted) {
        if let Some(inside) = &elements[order.row].inside {
            fit &= match wanted {
                Some(wanted) => inside.joints.fit(wanted, set),
                None => inside.joints.count() == 0,
            };
        }
    }
    for e in members.elements {
        if let Some(inside) = &mut elements[*e].inside
            && !(fit && inside.active)
        {
            inside.joints.remove(set);
        }
    }
    fit
}

/// Makes or changes the joints of a component.
fn join(
    plan: &mut Plan,
    wanted: &mut Vec<Option<Wanted>>,
    members: &Members,
    elements: &mut [ElementRow],
    engine: &mut Engine,
    [substep, time]: [f64; 2],
) {
    for e in members.elements {
        if let Some(inside) = &mut elements[*e].inside {
            inside.active = false;
        }
    }
    wanted.clear();
    for order in &mut plan.orders {
        let row = &mut elements[order.row];
        let held = row.held;
        let inside = row.inside.get_or_insert_default();
        let holders = [0, 1].map(|end| inside.holder(end, &held[end], engine));
        wanted.push(order.joints(row, holders, substep, time));
        if let Some(inside) = &mut row.inside {
            inside.active = true;
            inside.turn = order.turn;
        }
    }
    let fit = leave_misfits(plan, wanted, members, elements, engine);
    let set = &mut engine.joints.impulse_joints;
    let mut each = |act: &mut dyn FnMut(&mut Inside, &Wanted)| {
        for (order, wanted) in plan.orders.iter().zip(&*wanted) {
            if let (Some(inside), Some(wanted)) = (&mut elements[order.row].inside, wanted) {
                act(inside, wanted);
            }
        }
    };
    if fit {
        each(&mut |inside, wanted| inside.joints.update(wanted, set));
        return;
    }
    let fixed = |wanted: &Wanted| {
        let mut bodies = wanted.bodies().into_iter().flatten();
        bodies.any(|body| engine.bodies.get(body).is_none_or(RapierBody::is_fixed))
    };
    // Rapier solves joints of two bodies in the order in which they come, and then those to a fixed one in the reverse
    // order. Either way dampers are to go first: pinned by `ground::hinge`.
    let mut put = |damper: bool, to_fixed: bool| {
        each(&mut |inside, wanted| match () {
            () if fixed(wanted) != to_fixed => {}
            () if damper => inside.joints.put_damper(wanted, set),
            () => inside.joints.put_springs(wanted, to_fixed, set),
        });
    };
    put(true, false);
    put(false, false);
    put(false, true);
    put(true, true);
}
