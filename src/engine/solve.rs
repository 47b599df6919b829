//! The step's system: the user's shares, then component by component.

use super::body::{Engine, FARTHEST_TURN};
use super::component::Step;
use super::forces::{SpringLoad, release};
use super::group::Groups;
use super::held::Ground;
use super::scene::Scene;
use super::timestep::Plan;
use crate::dynamics::body::Body;
use crate::dynamics::step::Component;
use crate::settings::CoiloverSettings;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// What of a Rapier context the step needs.
type ContextParts<'a> = (
    &'a RapierContextSimulation,
    &'a RapierContextColliders,
    &'a RapierContextJoints,
    &'a RapierConfiguration,
    &'a SimulationToRenderTime,
);

/// Loads of bodies, also of disabled ones: their share must be taken back too.
pub(super) type Loads<'w, 's> = Query<
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
        if let Some(component) = component.filter(Mut::is_changed) {
            load.read_user(&component);
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
