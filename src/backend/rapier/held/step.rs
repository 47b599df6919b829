//! Takes the held components of a context through the step: finds them, and has Rapier's solver solve them.

use super::ahead::look_ahead;
use super::touch::any_joints;
use crate::backend::rapier::body::{handle, id};
use crate::backend::rapier::held::near::{Outlook, is_clear};
use crate::backend::rapier::held::touch::{Crowd, Surroundings};
use crate::backend::rapier::held::write::{Engine, Solver};
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Searched};
use crate::scene::state::Scene;
use crate::scene::step::Step;
use bevy::prelude::Entity;
use bevy_rapier3d::rapier::dynamics::RigidBody;
use bevy_rapier3d::rapier::geometry::{DefaultBroadPhase, NarrowPhase};
use std::mem::take;

/// The contacts of a context.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub context: Entity,
    pub narrow: &'a NarrowPhase,
    pub broad: &'a DefaultBroadPhase,
}

impl Scene {
    /// Finds the components that contacts or joints hold, and makes the engine solve them. Returns whether all of them are
    /// asleep. `finest` is the greatest number of additional solver iterations that the user gave to any body.
    pub(crate) fn step_held(
        &mut self,
        view: View,
        step: &mut Step,
        engine: &mut Engine,
        finest: usize,
        solver: &mut Solver,
    ) -> bool {
        solver.clear();
        if !self.changed.is_empty() || self.renewed {
            add_up(&self.elements, &mut self.bodies);
        }
        let any_joints = any_joints(engine.joints);
        self.find_tangible(any_joints);
        let tangible = take(&mut self.tangible);
        let any_new = tangible
            .iter()
            .any(|g| self.is_new(*g as usize, view.context));
        let crowd = any_new.then(|| Crowd::new(engine.colliders));
        let mut all_asleep = true;
        for g in tangible.iter().map(|g| *g as usize) {
            let group = &self.groups.list()[g];
            if group.context != view.context {
                continue;
            }
            let members = self.groups.members(group);
            let (elements, bodies) = (&self.elements, &self.bodies);
            if group.inside
                && group.is_asleep
                && step.quiet
                && step.is_left_alone(&members, elements, bodies, &engine.sight())
            {
                continue;
            }
            all_asleep &= self.step_group(g, view, step, engine, crowd.as_ref(), solver);
        }
        self.tangible = tangible;
        let Self {
            elements,
            bodies,
            groups,
            ..
        } = self;
        self.noting |= solver.is_any();
        solver.write(step, groups, elements, bodies, engine, finest);
        let links = engine.joints.multibody_joints.multibodies().next();
        step.alike = links.map(|_| {
            let awake = engine.bodies.iter().map(|(_, body)| body);
            let awake = awake.filter(|body| !(body.is_fixed() || body.is_sleeping()));
            awake
                .map(RigidBody::additional_solver_iterations)
                .max()
                .unwrap_or(0)
        });
        all_asleep
    }

    /// Whether a component is in `context` and has a body that the engine has not stepped yet.
    fn is_new(&self, group: usize, context: Entity) -> bool {
        let group = &self.groups.list()[group];
        let mut bodies = self.groups.members(group).bodies.iter();
        let is_new = |b: &u32| self.bodies[*b as usize].has(BodyFlags::NEW);
        group.context == context && bodies.any(is_new)
    }

    /// Reads a component if it is held, and releases it if it no longer is. Returns whether Rapier's solver has nothing to do for
    /// it.
    fn step_group(
        &mut self,
        g: usize,
        view: View,
        step: &Step,
        engine: &mut Engine,
        crowd: Option<&Crowd>,
        solver: &mut Solver,
    ) -> bool {
        let held = self.is_held(g, view, step, engine, crowd, solver);
        let Self {
            elements,
            bodies,
            groups,
            assemblies,
            stale,
            ..
        } = self;
        let members = groups.members(&groups.list()[g]);
        let held = held && !members.elements.is_empty();
        if !(held || groups.list()[g].inside) {
            groups.set_held(g, false, elements);
            return true;
        }
        let narrow = view.narrow;
        let awake = solver.read(step, g, &members, elements, bodies, engine, narrow, stale);
        if !held && awake {
            solver.release(step, groups, elements, bodies, engine);
        }
        if let Some(index) = groups.list()[g].assembly {
            assemblies[index as usize].forget();
        }
        groups.set_held(g, held || !awake, elements);
        groups.at(g).is_asleep = !awake;
        !awake || !held
    }

    /// Whether contacts or joints hold some body of a component, or may hold one within the step. It is long because one loop finds
    /// all that decides it.
    fn is_held(
        &mut self,
        g: usize,
        view: View,
        step: &Step,
        engine: &mut Engine,
        crowd: Option<&Crowd>,
        solver: &mut Solver,
    ) -> bool {
        let Self {
            elements,
            bodies,
            groups,
            changed,
            touch_changed,
            ..
        } = self;
        let members = groups.members(&groups.list()[g]);
        // A new body may already touch something, which the engine does not know before the body's first step.
        let any_new = members.bodies.iter().any(|b| {
            let row = &bodies[*b as usize];
            row.has(BodyFlags::NEW)
        });
        if any_new {
            solver.find_pushes(step, &members, elements, bodies, &engine.sight());
        }
        let around = Surroundings::new(view.narrow, engine.joints, engine.colliders, crowd);
        let time = step.plan.time / f64::from(step.plan.calls.max(1));
        let (mut held, mut stiff, mut clear) = (false, false, u8::MAX);
        for (slot, b) in members.bodies.iter().enumerate() {
            let row = &mut bodies[*b as usize];
            clear = clear.min(row.clear);
            let push = if any_new { solver.pushes[slot] } else { 0.0 };
            let tangible = BodyFlags::CAN_TOUCH | BodyFlags::LINGERS;
            if (row.flags.intersects(tangible) || around.any_joints)
                && let Some(body) = engine.bodies.get_mut(handle(row.id))
            {
                *touch_changed |= row.notice_colliders(!body.colliders().is_empty());
                held |= around.look(row, body, step.plan.time, push);
                stiff |= look_ahead(row, body, time);
                if clear > 0 && !is_clear(row, body, step.plan.time as f32) {
                    clear = 0;
                }
            }
        }
        // With new parameters the elements may push the bodies elsewhere.
        let is_changed = !changed.is_empty()
            && members
                .elements
                .iter()
                .any(|e| elements[*e as usize].has(ElementFlags::CHANGED));
        if is_changed {
            clear = 0;
        }
        if stiff && !held && clear == 0 {
            if !any_new {
                solver.find_pushes(step, &members, elements, bodies, &engine.sight());
            }
            return self.meets_soon(g, view, step, engine, &solver.pushes);
        }
        count_down(clear, members.bodies, bodies);
        held
    }

    /// Returns whether a component may hit something within the step. Stores in its bodies for how many further steps it cannot.
    fn meets_soon(
        &mut self,
        g: usize,
        view: View,
        step: &Step,
        engine: &Engine,
        pushes: &[f32],
    ) -> bool {
        let outlook = Outlook {
            broad: view.broad,
            bodies: engine.bodies,
            colliders: engine.colliders,
            time: step.plan.time as f32,
        };
        let (bodies, handles) = (&self.bodies, &self.handles);
        let members = self.groups.members(&self.groups.list()[g]);
        let rows: Vec<_> = members
            .bodies
            .iter()
            .map(|b| &bodies[*b as usize])
            .collect();
        let clear = outlook.look(&rows, pushes, |handle| {
            let row = handles.row(view.context, id(handle), bodies);
            row.is_some_and(|row| row.rare.group == g as u32)
        });
        for b in members.bodies {
            let row = &mut self.bodies[*b as usize];
            row.clear = clear.as_ref().map_or(0, |clear| clear.steps);
            if let (Some(clear), Some(body)) = (&clear, engine.bodies.get(handle(row.id))) {
                row.rare.searched = Searched {
                    at: body.center_of_mass(),
                    way: clear.way,
                };
            }
        }
        clear.is_none()
    }
}

/// Computes for each body the total stiffness of its elements, N/m. Torsion elements do not count.
pub(crate) fn add_up(elements: &[ElementRow], bodies: &mut [BodyRow]) {
    for row in bodies.iter_mut() {
        row.rare.stiffness = 0.0;
    }
    for row in elements.iter().filter(|row| !row.rare.guide.is_twist()) {
        for body in row.all_movable() {
            let stiffness = match row.law {
                // At a kink of the law the slope may be arbitrarily large.
                Some(_) => f64::INFINITY,
                None => f64::from(row.numbers.stiffness),
            };
            bodies[body].rare.stiffness += stiffness;
        }
    }
}

/// Counts the steps for which bodies can hit nothing: one fewer than `clear`.
fn count_down(clear: u8, members: &[u32], bodies: &mut [BodyRow]) {
    let left = clear.saturating_sub(1);
    for b in members {
        // The counter is mostly zero already, and a row that is not written need not go back to memory.
        let row = &mut bodies[*b as usize];
        if row.clear != left {
            row.clear = left;
        }
    }
}
