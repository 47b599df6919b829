//! One component through one step: gather, wake, integrate, deliver.

use super::body::{Engine, deliver, point_after, point_of, read};
use super::check::Fault;
use super::forces::SpringLoad;
use super::group::Group;
use super::held::{self, Expected, Ground, Support};
use super::jointed;
use super::scene::{BodyRow, ElementRow, Held, Scene};
use super::solve::Loads;
use super::timestep::Plan;
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End};
use crate::dynamics::step::Component;
use crate::settings::CoiloverSettings;
use bevy::math::DVec3;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::ColliderSet;

/// What holds for every component of a context in this step.
pub(super) struct Step<'a> {
    pub plan: Plan,
    pub engine: Engine,
    pub joints: &'a RapierContextJoints,
    pub colliders: &'a ColliderSet,
    pub ground: &'a Ground,
    pub settings: &'a CoiloverSettings,
}

impl Step<'_> {
    /// Reads the component's bodies, advances them, and gives the engine what takes them there.
    pub(super) fn run(
        &self,
        scene: &mut Scene,
        group: Group,
        slots: &[usize],
        component: &mut Component,
        start: &mut Vec<Body>,
        set: &mut RapierRigidBodySet,
        loads: &mut Loads,
    ) {
        component.bodies.clear();
        component.elements.clear();
        start.clear();
        for b in group.bodies {
            let row = scene.bodies[*b];
            let user = loads
                .get(row.entity)
                .map(|(_, load, ..)| load.user)
                .unwrap_or_default();
            let Some(body) = set.bodies.get(row.handle) else {
                return;
            };
            let free = read(body, self.engine.gravity, &user, row.turns);
            component.bodies.push(free);
            start.push(free);
        }
        let sound = component.bodies.iter().all(Body::is_finite);
        let mut disturbed = false;
        for e in group.elements {
            let row = &mut scene.elements[*e];
            let ends = row.held.map(|held| self.end(held, slots, set));
            disturbed |= row.changed || self.has_moved(row, &ends, set);
            if let Some(element) = element(row, ends, &component.bodies) {
                component.elements.push(element);
            }
        }
        if !self.is_awake(scene, group, component, set, loads, disturbed) {
            return;
        }
        for (slot, b) in group.bodies.iter().enumerate() {
            let row = scene.bodies[*b];
            let (Some(body), Ok((_, load, ..))) =
                (set.bodies.get(row.handle), loads.get(row.entity))
            else {
                continue;
            };
            if load.support == Support::None {
                continue;
            }
            let elements = component.load_on(slot);
            let support = match load.support {
                Support::Unknown => self.first_support(&row, body, &load.user, elements, set),
                known => known,
            };
            let mobility = held::mobility(load, support, &start[slot], elements.0);
            component.bodies[slot] = held::held(&start[slot], mobility);
        }
        if sound && !component.elements.is_empty() {
            component.advance(self.plan.time, self.settings.accuracy());
        }
        let sound = sound && component.bodies.iter().all(Body::is_finite);
        if sound {
            self.wake_the_moved(scene, group, start, &component.bodies, set);
        }
        for (slot, b) in group.bodies.iter().enumerate() {
            let row = scene.bodies[*b];
            let (Some(body), Ok((_, mut load, mut force, ..))) =
                (set.bodies.get_mut(row.handle), loads.get_mut(row.entity))
            else {
                continue;
            };
            if body.is_sleeping() {
                continue;
            }
            let mut share = ExternalForce::default();
            if sound && !component.elements.is_empty() {
                share = self.deliver(
                    row.handle,
                    body,
                    &start[slot],
                    &component.bodies[slot],
                    &mut load,
                );
            }
            load.write(share, body, force.as_mut());
        }
        let mut solved = component.elements.iter();
        for e in group.elements {
            if scene.elements[*e].fault.is_none()
                && let Some(element) = solved.next()
            {
                scene.elements[*e].direction = element.direction;
            }
        }
    }

    /// What is known of a body that the engine has not stepped yet.
    fn first_support(
        &self,
        row: &BodyRow,
        body: &RapierBody,
        user: &ExternalForce,
        load: (DVec3, DVec3),
        set: &RapierRigidBodySet,
    ) -> Support {
        let free = read(body, self.engine.gravity, user, true);
        match jointed::share(row.handle, &free, load, &set.bodies, self.joints) {
            Some(share) => Support::Tied(share),
            None => self.ground.under(body, &set.bodies, self.colliders),
        }
    }

    /// Sets a body's velocities and returns the force of its elements.
    fn deliver(
        &self,
        handle: RigidBodyHandle,
        body: &mut RapierBody,
        start: &Body,
        end: &Body,
        load: &mut SpringLoad,
    ) -> ExternalForce {
        let multibody = self.joints.multibody_joints.rigid_body_link(handle);
        let takes_impulses = multibody.is_none();
        if self.engine.iterations * self.plan.pipeline_steps as usize == 1
            && body.additional_solver_iterations() == 0
        {
            // One substep has room for a force or an impulse, not for both.
            body.set_additional_solver_iterations(1);
            load.raised_iterations = true;
        }
        let iterations = self.engine.iterations + body.additional_solver_iterations();
        let schedule = self.plan.schedule(iterations);
        load.expected = Some(Expected::new(start, end, self.plan.time));
        if end.mobility < 1.0 {
            held::deliver(body, start, end.given, &schedule, takes_impulses)
        } else {
            deliver(body, start, end, &schedule, &self.engine, takes_impulses)
        }
    }

    /// Whether an end moves, or is not where it was after the last step.
    fn has_moved(&self, row: &ElementRow, ends: &[End; 2], set: &RapierRigidBodySet) -> bool {
        row.held
            .iter()
            .zip(ends)
            .zip(row.remembered)
            .any(|((held, end), before)| {
                let now = match (*held, *end) {
                    (_, End::Path { velocity, .. }) if velocity != DVec3::ZERO => return true,
                    (
                        Held::Body {
                            local,
                            movable: Some(_),
                            ..
                        },
                        _,
                    ) => local,
                    (Held::Body { handle, local, .. }, _) => set
                        .bodies
                        .get(handle)
                        .map_or(DVec3::ZERO, |body| point_of(body, local).0),
                    (Held::Path { to, .. }, _) => to,
                };
                before.is_some_and(|before| before != now)
            })
    }

    fn end(&self, held: Held, slots: &[usize], set: &RapierRigidBodySet) -> End {
        let path = |from: DVec3, to: DVec3| End::Path {
            position: from,
            velocity: (to - from) / self.plan.time,
        };
        match held {
            Held::Path { from, to } => path(from, to),
            Held::Body {
                handle,
                local,
                movable,
                ..
            } => match (movable, set.bodies.get(handle)) {
                (Some(index), Some(body)) => End::Body {
                    index: slots[index],
                    arm: local - body.local_center_of_mass().as_dvec3(),
                },
                (None, Some(body)) => path(
                    point_of(body, local).0,
                    point_after(body, local, self.plan.time),
                ),
                (_, None) => path(local, local),
            },
        }
    }
}

/// The integrator's element, its rest length captured if need be; or none, with the fault noted.
fn element(row: &mut ElementRow, ends: [End; 2], bodies: &[Body]) -> Option<Element> {
    let p = &mut row.parameters;
    let mut element = Element {
        ends,
        stiffness: f64::from(p.stiffness),
        damping: f64::from(p.damping),
        rest_length: f64::from(p.rest_length.unwrap_or(0.0)),
        direction: row.direction,
        stiff_damper: false,
    };
    if p.rest_length.is_none() {
        let length = element.line(bodies).map_or(0.0, |line| line.length.abs());
        p.rest_length = Some(length as f32);
        element.rest_length = f64::from(length as f32);
        row.captured = true;
    }
    if element.line(bodies).is_none() {
        row.fault = Some(Fault::new(
            p.names.ends[1],
            "coincides with body_a, so nothing says which way to push; move one or set Anchors",
        ));
        return None;
    }
    Some(element)
}
