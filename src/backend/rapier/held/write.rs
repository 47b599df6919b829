//! Writes held components into Rapier: joints, substeps, and the initial velocities of bodies.

use super::lend::raise;
use super::stagger::{absorb_jumps, stagger};
use super::stand_in::{holder, remove};
use crate::backend::rapier::body::{Bodies, handle};
use crate::backend::rapier::held::linkage::Holding;
use crate::backend::rapier::held::plan::Plan;
use crate::backend::{self, Push};
use crate::dynamics::soft::Fineness;
use crate::scene::group::Groups;
use crate::scene::held::{Inside, WantedJoints};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Members, Solved};
use crate::scene::sleep::rouse;
use crate::scene::step::Step;
use bevy::math::Vec3;
use bevy_rapier3d::prelude::RapierContextJoints;
use bevy_rapier3d::rapier::dynamics::{IslandManager, RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{ColliderSet, ContactPair, NarrowPhase};
use std::sync::atomic::Ordering;

/// Least number of substeps per tick. With Rapier's own four, the contact forces of a wheel that rolls at 12 m/s are wrong by a
/// twentieth of its load. Pinned by `ground::rolling`.
const LEAST: u32 = 16;

/// The parts of a Rapier context that are written.
pub(crate) struct Engine<'a> {
    pub bodies: &'a mut RigidBodySet,
    pub joints: &'a mut RapierContextJoints,
    pub islands: &'a mut IslandManager,
    pub colliders: &'a mut ColliderSet,
    /// Gravity, m/s².
    pub gravity: Vec3,
}

impl Engine<'_> {
    /// Read access to the bodies for code that does not know Rapier.
    pub(crate) fn sight(&self) -> Bodies<&RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }

    /// Write access to the bodies for code that does not know Rapier.
    fn world(&mut self) -> Bodies<&mut RigidBodySet> {
        Bodies {
            set: self.bodies,
            gravity: self.gravity,
        }
    }
}

/// The held components of a context in this step, and reusable buffers.
#[derive(Default)]
pub(crate) struct Solver {
    plans: Vec<Plan>,
    used: usize,
    wanted: Vec<Option<WantedJoints>>,
    /// Number of sweeps over all joints and contacts per substep.
    sweeps: usize,
    /// Whether something in the world touches something else. Only found if a component needs it.
    touching: Option<bool>,
    /// Speed that springs can add to each body of the present component in the step, m/s.
    pub(crate) pushes: Vec<f32>,
}

/// Tells a body that the engine solves its elements, with `more` additional iterations and substeps of `substep` seconds.
fn enter(row: &mut BodyRow, substep: f64, more: usize, engine: &mut Engine) {
    row.rare.substep = substep;
    row.flags.insert(BodyFlags::FRESH);
    row.flags.remove(BodyFlags::IS_ALONE);
    if let Some(body) = engine.bodies.get_mut(handle(row.id)) {
        raise(&mut row.rare.raised, body, more);
    }
}

impl Solver {
    pub(crate) fn clear(&mut self) {
        (self.used, self.sweeps, self.touching) = (0, 1, None);
    }

    /// Whether there are components to write.
    pub(crate) fn is_any(&self) -> bool {
        self.used > 0
    }

    /// Number of sweeps over all joints and contacts per substep that the written components need.
    pub(crate) fn sweeps(&self) -> usize {
        self.sweeps
    }

    /// Reads a component. Returns whether it is awake.
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
        if plan.jointed {
            // What rests on a jointed body may be many joints away from the component.
            let any = || {
                narrow
                    .contact_pairs()
                    .any(ContactPair::has_any_active_contact)
            };
            self.touching.get_or_insert_with(any);
        }
        let (omega, disturbed) = (plan.omega as f32, plan.disturbed);
        let world = &mut engine.world();
        let (awake, must_rouse) = if there {
            step.is_awake(bodies, members.bodies, true, omega, world, disturbed)
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

    /// Gives the engine what it needs to solve all components that have been read. `finest` is the greatest number of additional
    /// solver iterations that the user gave to any body.
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
                // A body that touches it may have more iterations, and then the engine solves both with that number.
                chosen = most;
            }
            let group = &groups.list()[plan.group];
            let members = groups.members(group);
            let h = substep(chosen);
            let substeps = chosen as u32 * calls;
            let touching = self.touching == Some(true);
            self.sweeps = self.sweeps.max(plan.sweeps(h, touching));
            if group.inside {
                absorb_jumps(plan, h, step, &members, elements, bodies, engine);
            } else {
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
                enter(&mut bodies[*b as usize], h, chosen - own, engine);
            }
            take_back_shares(&members, bodies, step.tick, &mut engine.world());
            groups.at(plan.group).inside = true;
            step.delivered.store(true, Ordering::Relaxed);
        }
        self.used = 0;
    }

    /// Takes the component that was read last out of the engine's solver again.
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

/// Removes from bodies the force and torque that a step with the crate's own integrator gave them.
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

/// Removes the joints of a component from the engine, and restores the solver iterations of its bodies.
fn leave(
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

/// Returns whether every element has joints of the wanted kinds. If not, removes all joints of the component. Joints of
/// elements that do not act are removed in any case.
fn leave_misfits(
    plan: &Plan,
    wanted: &[Option<WantedJoints>],
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

/// Creates the joints of a component, or updates them.
fn join(
    plan: &mut Plan,
    wanted: &mut Vec<Option<WantedJoints>>,
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
        let holders = [0, 1].map(|end| holder(inside, end, &held[end], engine, time));
        wanted.push(order.joints(row, holders, &plan.bodies, [substep, time]));
        if let Some(inside) = &mut row.inside {
            inside.active = true;
            inside.turn = order.turn;
        }
    }
    let fit = leave_misfits(plan, wanted, members, elements, engine);
    let set = &mut engine.joints.impulse_joints;
    let mut each = |act: &mut dyn FnMut(&mut Inside, &WantedJoints)| {
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
    let fixed = |wanted: &WantedJoints| {
        let mut bodies = wanted.bodies().into_iter().flatten();
        bodies.any(|body| {
            let body = engine.bodies.get(handle(body));
            body.is_none_or(RapierBody::is_fixed)
        })
    };
    // Rapier first solves joints between two bodies that are not fixed, in the order of insertion, and then joints with a
    // fixed body, in reverse order. Dampers must be solved first in both groups: pinned by `ground::hinge`.
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
