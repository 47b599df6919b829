//! The step: components, integration, delivery.

use super::body::{Engine, FARTHEST_TURN, deliver, is_movable, point_after, point_of, read};
use super::check::Fault;
use super::forces::{SpringLoad, release};
use super::group::{Group, Groups};
use super::held::{self, Expected, Ground, Support};
use super::jointed;
use super::scene::{BodyRow, ElementRow, Held, Scene};
use super::sleep::{is_restless, is_set_moving, keep_awake};
use super::timestep::Plan;
use crate::dynamics::body::Body;
use crate::dynamics::element::{Element, End};
use crate::dynamics::step::Component;
use crate::plugin::CoiloverSettings;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::ColliderSet;

/// What of a Rapier context the step needs.
type ContextParts<'a> = (
    &'a RapierContextSimulation,
    &'a RapierContextColliders,
    &'a RapierContextJoints,
    &'a RapierConfiguration,
    &'a SimulationToRenderTime,
);

/// Loads of bodies, also of disabled ones: their share must be taken back too.
type Loads<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static mut SpringLoad,
        Option<&'static mut ExternalForce>,
        Option<&'static RapierRigidBodyHandle>,
        Option<&'static RapierContextEntityLink>,
    ),
    Allow<Disabled>,
>;

/// Buffers kept from tick to tick.
#[derive(Default)]
pub(crate) struct Work {
    groups: Groups,
    component: Component,
    /// The component's bodies at the start of the step, with their full mass.
    start: Vec<Body>,
    /// Index of each of the scene's bodies within its component.
    slots: Vec<usize>,
}

/// Computes and delivers every element's force for the coming engine step.
pub(crate) fn solve(
    mut scene: ResMut<Scene>,
    settings: Res<CoiloverSettings>,
    mode: Res<TimestepMode>,
    time: Res<Time>,
    contexts: Query<ContextParts>,
    mut sets: Query<&mut RapierRigidBodySet>,
    mut loads: Loads,
    mut work: Local<Work>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    for (_, mut load, component, ..) in &mut loads {
        if let Some(component) = component {
            let changed = component.is_changed();
            if changed {
                load.read_user(&component, changed);
            }
        }
    }
    let index = &scene.index;
    release(
        &mut loads,
        &mut sets,
        |e| index.contains_key(&e),
        &mut commands,
    );

    scene.time = 0.0;
    let mut ground = (Entity::PLACEHOLDER, Ground::default());
    let Work {
        groups,
        component,
        start,
        slots,
    } = &mut *work;
    groups.find(scene);
    slots.clear();
    slots.resize(scene.bodies.len(), usize::MAX);
    for group in groups.iter() {
        let Some(context) = group.bodies.first().map(|b| scene.bodies[*b].context) else {
            continue;
        };
        let Ok((simulation, colliders, joints, configuration, lag)) = contexts.get(context) else {
            continue;
        };
        let plan = Plan::new(*mode, time.delta_secs(), lag.diff);
        if plan.time <= 0.0 || !configuration.physics_pipeline_active {
            continue;
        }
        scene.time = plan.time;
        if ground.0 != context {
            ground = (context, Ground::default());
        }
        let Ok(mut set) = sets.get_mut(context) else {
            continue;
        };
        let parameters = &simulation.integration_parameters;
        for (slot, body) in group.bodies.iter().enumerate() {
            slots[*body] = slot;
        }
        let step = Step {
            plan,
            engine: Engine {
                iterations: parameters.num_solver_iterations,
                fastest: f64::from(parameters.max_linear_velocity()),
                farthest_turn: FARTHEST_TURN * f64::from(plan.pipeline_steps),
                length_unit: parameters.length_unit,
                gravity: configuration.gravity,
            },
            joints,
            colliders: &colliders.colliders,
            ground: &ground.1,
            settings: &settings,
        };
        step.run(scene, group, slots, component, start, &mut set, &mut loads);
    }
    // Without a movable body nothing is stepped, but the readouts still want the time.
    if scene.time == 0.0 {
        for (.., configuration, lag) in &contexts {
            if configuration.physics_pipeline_active {
                scene.time = Plan::new(*mode, time.delta_secs(), lag.diff).time;
            }
        }
    }
}

/// What holds for every component of a context in this step.
struct Step<'a> {
    plan: Plan,
    engine: Engine,
    joints: &'a RapierContextJoints,
    colliders: &'a ColliderSet,
    ground: &'a Ground,
    settings: &'a CoiloverSettings,
}

impl Step<'_> {
    fn run(
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
            disturbed |= row.changed
                || ends.iter().any(|end| {
                    matches!(end, End::Path { velocity, .. } if velocity.length_squared() > 0.0)
                });
            if let Some(element) = element(row, ends, &component.bodies) {
                component.elements.push(element);
            }
        }
        if !self.is_awake(scene, group, component, set, loads, disturbed) {
            return;
        }
        for (slot, b) in group.bodies.iter().enumerate() {
            let row = scene.bodies[*b];
            if let (Some(body), Ok((_, load, ..))) =
                (set.bodies.get(row.handle), loads.get(row.entity))
            {
                let support = match load.support {
                    Support::Unknown => {
                        self.first_support(&row, body, &load.user, component.load_on(slot), set)
                    }
                    known => known,
                };
                if support != Support::None {
                    let (force, _) = component.load_on(slot);
                    let mobility = held::mobility(load, support, &start[slot], force);
                    component.bodies[slot] = held::held(&start[slot], mobility);
                }
            }
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
            load.before = Some((body.linvel(), body.angvel()));
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

    /// A sleeping body is no wall: where the step would set it moving, it and the others wake.
    fn wake_the_moved(
        &self,
        scene: &Scene,
        group: Group,
        start: &[Body],
        end: &[Body],
        set: &mut RapierRigidBodySet,
    ) {
        let bodies = || group.bodies.iter().map(|b| scene.bodies[*b].handle);
        let moved = bodies()
            .zip(start.iter().zip(end))
            .any(|(handle, (start, end))| {
                set.bodies.get(handle).is_some_and(RapierBody::is_sleeping)
                    && is_set_moving(start, end, self.plan.time, self.engine.length_unit)
            });
        if moved {
            for handle in bodies() {
                if let Some(body) = set.bodies.get_mut(handle) {
                    body.wake_up(true);
                }
            }
        }
    }

    /// Wakes, keeps awake or lets sleep; says whether there is anything to do.
    fn is_awake(
        &self,
        scene: &Scene,
        group: Group,
        component: &Component,
        set: &mut RapierRigidBodySet,
        loads: &mut Loads,
        mut disturbed: bool,
    ) -> bool {
        let mut all_asleep = true;
        let mut restless = false;
        let omega = component
            .elements
            .iter()
            .filter_map(|e| Some(e.stiffness * e.line(&component.bodies)?.inverse_mass))
            .fold(0.0, f64::max)
            .sqrt() as f32;
        // A damper alone has no period; a second stands in for it.
        let omega = if omega == 0.0 { 1.0 } else { omega };
        for b in group.bodies {
            let row = scene.bodies[*b];
            let (Some(body), Ok((_, mut load, ..))) =
                (set.bodies.get(row.handle), loads.get_mut(row.entity))
            else {
                continue;
            };
            disturbed |= load.disturbed || load.signature != row.signature;
            load.disturbed = false;
            load.signature = row.signature;
            if !body.is_sleeping() && is_movable(body) {
                all_asleep = false;
                restless |= is_restless(
                    &load,
                    body,
                    omega,
                    self.plan.time as f32,
                    self.engine.length_unit,
                );
            }
        }
        if all_asleep && !disturbed {
            return false;
        }
        if disturbed || restless {
            for b in group.bodies {
                if let Some(body) = set.bodies.get_mut(scene.bodies[*b].handle) {
                    if body.is_sleeping() {
                        body.wake_up(true);
                    }
                    keep_awake(body);
                }
            }
        }
        true
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
