//! Into the engine: joints, substeps, and what a body needs besides them.

use super::lend::raise;
use super::stand_in::{holder, remove};
use crate::backend::rapier::body::{Bodies, handle};
use crate::backend::rapier::held::linkage::Holding;
use crate::backend::rapier::held::plan::Plan;
use crate::backend::{self, Push, Sight};
use crate::dynamics::soft::Fineness;
use crate::scene::group::Groups;
use crate::scene::held::{Inside, Wanted};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Members, Solved};
use crate::scene::sleep::rouse;
use crate::scene::step::Step;
use bevy::math::Vec3;
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{IslandManager, RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, NarrowPhase};
use std::sync::atomic::Ordering;

/// Least substeps of a step. With Rapier's own four, contacts of a wheel that rolls at 12 m/s are off by a twentieth of
/// what it carries. Pinned by `ground::rolling`.
const LEAST: u32 = 16;

/// What of a Rapier context is written.
pub(crate) struct Engine<'a> {
    pub bodies: &'a mut RigidBodySet,
    pub joints: &'a mut RapierContextJoints,
    pub islands: &'a mut IslandManager,
    pub colliders: &'a mut ColliderSet,
    /// m/s².
    pub gravity: Vec3,
}

impl Engine<'_> {
    /// Its bodies as all else sees them.
    pub(crate) fn sight(&self) -> Bodies<&RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }

    /// Its bodies as all else moves them.
    fn world(&mut self) -> Bodies<&mut RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }
}

/// The components of a context that the engine solves.
#[derive(Default)]
pub(crate) struct Solver {
    plans: Vec<Plan>,
    used: usize,
    wanted: Vec<Option<Wanted>>,
    /// Sweeps over all joints and contacts that a substep needs.
    sweeps: usize,
    /// How much faster springs can make each body of the component that is looked at, m/s.
    pub(crate) pushes: Vec<f32>,
}

impl Solver {
    pub(crate) fn clear(&mut self) {
        (self.used, self.sweeps) = (0, 1);
    }

    /// Whether there is anything to write.
    pub(crate) fn is_any(&self) -> bool {
        self.used > 0
    }

    /// Sweeps over all joints and contacts that a substep of what has been written needs.
    pub(crate) fn sweeps(&self) -> usize {
        self.sweeps
    }

    /// Reads a component that is held; says whether it is awake.
    pub(crate) fn read(
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
            gravity: engine.gravity,
        };
        let there = plan.read(step, members, elements, bodies, all, stale);
        let (omega, disturbed) = (plan.omega as f32, plan.disturbed);
        let world = &mut engine.world();
        let (awake, must_rouse) = if there {
            step.is_awake(bodies, members.bodies, omega, world, disturbed)
        } else {
            (false, false)
        };
        if must_rouse {
            rouse(bodies, members.bodies, world);
        }
        for e in members.elements {
            let flags = &mut elements[*e as usize].flags;
            flags.set(ElementFlags::ACTIVE, awake);
        }
        self.used += usize::from(awake);
        awake
    }

    /// Gives the engine what it needs to solve all components that have been read. `finest` are the most iterations that
    /// any body has by its user.
    pub(crate) fn write(
        &mut self,
        step: &Step,
        groups: &mut Groups,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut Engine,
        finest: usize,
    ) {
        let (time, calls) = (step.plan.time, step.plan.calls.max(1));
        let own = step.plan.substeps;
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
                stagger(plan, -0.5 * h, step, &members, bodies, engine);
            }
            let wanted = &mut self.wanted;
            join(plan, wanted, &members, elements, engine, [h, time]);
            for e in members.elements {
                let row = &mut elements[*e as usize];
                let acts = row.inside.as_ref().is_some_and(|inside| inside.active);
                row.solved = if acts {
                    fineness.outcome(substeps).into()
                } else {
                    Solved::default()
                };
            }
            for b in members.bodies {
                let row = &mut bodies[*b as usize];
                row.rare.substep = h;
                row.flags.insert(BodyFlags::FRESH);
                row.flags.remove(BodyFlags::IS_ALONE);
                if let Some(body) = engine.bodies.get_mut(handle(row.id)) {
                    raise(&mut row.rare.raised, body, chosen - own);
                }
            }
            take_back_shares(&members, bodies, step.tick, &mut engine.world());
            groups.at(plan.group).inside = true;
            step.delivered.store(true, Ordering::Relaxed);
        }
        self.used = 0;
    }

    /// Takes a component out of the engine's solver again; it has been read last.
    pub(crate) fn release(
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
        let substep = members
            .bodies
            .first()
            .map_or(0.0, |b| bodies[*b as usize].rare.substep);
        stagger(plan, 0.5 * substep, step, &members, bodies, engine);
        leave(&members, elements, bodies, engine);
        groups.at(plan.group).inside = false;
    }
}

/// Takes back what bodies have from steps that were solved here.
fn take_back_shares(
    members: &Members,
    bodies: &mut [BodyRow],
    tick: u32,
    engine: &mut impl backend::Engine,
) {
    for b in members.bodies {
        let row = &mut bodies[*b as usize];
        if row.has(BodyFlags::CARRIES_SHARE) {
            row.give(&Push::default(), tick, engine);
            row.flags.remove(BodyFlags::CARRIES_SHARE);
        }
    }
}

/// Takes the joints of a component out of the engine, and gives back what its bodies had.
pub(crate) fn leave(
    members: &Members,
    elements: &mut [ElementRow],
    bodies: &mut [BodyRow],
    engine: &mut Engine,
) {
    for e in members.elements {
        if let Some(mut inside) = elements[*e as usize].inside.take() {
            remove(&mut inside, engine);
        }
    }
    for b in members.bodies {
        let row = &mut bodies[*b as usize];
        if let Some(body) = engine.bodies.get_mut(handle(row.id)) {
            raise(&mut row.rare.raised, body, 0);
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
    engine: &mut Engine,
) {
    let mut moved = plan.bodies.clone();
    for body in &mut moved {
        let inverse_inertia = body.inverse_inertia();
        body.apply_external(by, inverse_inertia);
    }
    for order in &plan.orders {
        let rate = order.line.motion(&order.element, &plan.bodies, 0.0).axial;
        let damping: f64 = order.pieces.iter().map(|p| p.tangent.damping).sum();
        // What a firm damper stops in a substep, it has stopped then.
        let lasting = (1.0 + 2.0 * by.abs() * damping * order.line.inverse_mass).powi(-2);
        let tension = order.pieces.tension(order.line.distance(), lasting * rate);
        let impulse = -by * tension * order.line.direction;
        order.line.impulse(&mut moved, impulse);
    }
    for (b, moved) in members.bodies.iter().zip(&moved) {
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
        if let Some(inside) = &mut elements[*e as usize].inside
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
        if let Some(inside) = &mut elements[*e as usize].inside {
            inside.active = false;
        }
    }
    wanted.clear();
    for order in &mut plan.orders {
        let row = &mut elements[order.row];
        let held = row.rare.held;
        let inside = row.inside.get_or_insert_default();
        let holders = [0, 1].map(|end| holder(inside, end, &held[end], engine));
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
        bodies.any(|body| {
            let body = engine.bodies.get(handle(body));
            body.is_none_or(RapierBody::is_fixed)
        })
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
