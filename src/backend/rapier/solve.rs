//! The system that computes all elements before the engine's step: held components first, then free ones.

use super::body::{Bodies, handle, id, led};
use super::setup::Timesteps;
use super::timestep;
use crate::backend::StepPlan;
use crate::backend::rapier::forces::{self, Iterations, Loads};
use crate::backend::rapier::held::{EngineParts, Solver, View, give_back, remove};
use crate::scene::free;
use crate::scene::state::Scene;
use crate::scene::step::Step;
use crate::threads;
use bevy::ecs::entity::Entities;
use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::IntegrationParameters;

/// The components of a Rapier context that the step needs.
type ContextParts<'a> = (
    Entity,
    Option<&'a mut RapierRigidBodySet>,
    &'a mut RapierContextSimulation,
    &'a mut RapierContextColliders,
    &'a mut RapierContextJoints,
    &'a RapierConfiguration,
    &'a SimulationToRenderTime,
);

/// Buffers that are reused from step to step.
#[derive(Default)]
pub(crate) struct Spare {
    free: free::Spare,
    inside: Solver,
}

/// Computes the forces of all elements for the coming engine step and gives them to the engine. It is long because it is the list of
/// what is done in each context, and takes the context apart for that.
pub(crate) fn solve(
    mut scene: ResMut<Scene>,
    mut timesteps: Timesteps,
    time: Res<Time>,
    mut contexts: Query<ContextParts>,
    mut loads: Loads,
    users: Iterations,
    entities: &Entities,
    mut spare: Local<Spare>,
    _on_main_thread: NonSendMarker,
) {
    let _awake = threads::Awake::new();
    timesteps.check();
    let scene = &mut *scene;
    forces::read_users(scene, &mut loads);
    forces::read_iterations(scene, &users, &mut loads);
    scene.begin();
    scene.forget_worlds(|context| entities.contains(context));
    for (context, set, mut simulation, mut colliders, mut joints, configuration, lag) in
        &mut contexts
    {
        let parameters = &simulation.integration_parameters;
        let plan = timestep::plan(*timesteps.mode, time.delta_secs(), lag.diff, parameters);
        if plan.time <= 0.0 || !configuration.physics_pipeline_active {
            // Bodies may move while the context is not stepped, so its state is not known afterwards.
            scene.still.note(context, false);
            scene.stepped.some_rest = true;
            continue;
        }
        scene.note_step(context, plan.time);
        let Some(mut set) = set else { continue };
        scene.note_led(context, &plan, &set);
        let Some(quiet) = scene.is_to_step(context, &simulation, &set) else {
            continue;
        };
        let simulation = &mut *simulation;
        let mut step = Step::new(plan, &timesteps.settings, quiet, scene.tick);
        let mut engine = EngineParts {
            bodies: &mut set.bodies,
            joints: &mut joints,
            islands: &mut simulation.islands,
            colliders: &mut colliders.colliders,
            gravity: configuration.gravity,
        };
        scene.take_out_what_is_left(context, &mut engine, &users);
        let finest = users.iter().map(|(_, number)| number.0).max().unwrap_or(0);
        let spare = &mut *spare;
        let view = View {
            context,
            narrow: &simulation.narrow_phase,
            broad: &simulation.broad_phase,
        };
        let held_asleep = scene.step_held(view, &mut step, &mut engine, finest, &mut spare.inside);
        let mut bodies = Bodies {
            set: &mut *engine.bodies,
            gravity: configuration.gravity,
        };
        let free_asleep = scene.step_free(context, &step, &mut bodies, &mut spare.free);
        let all_asleep = held_asleep && free_asleep;
        let sweeps = spare.inside.sweeps();
        scene.raise_sweeps(context, &mut simulation.integration_parameters, sweeps);
        scene.still.note(context, all_asleep);
        scene.delivered |= step.delivered.into_inner();
    }
    forces::show(scene, &mut loads);
}

impl Scene {
    /// Sets the number of sweeps over all joints and contacts per substep of a context.
    fn raise_sweeps(
        &mut self,
        context: Entity,
        parameters: &mut IntegrationParameters,
        sweeps: usize,
    ) {
        let told = self.sweeps.entry(context).or_default();
        told.raise(&mut parameters.num_internal_pgs_iterations, sweeps);
    }

    /// Notes how fast bodies move that the game moves by setting their positions. Rapier moves them in the first of several steps of
    /// a tick, and they stand still in the others.
    fn note_led(&mut self, context: Entity, plan: &StepPlan, set: &RapierRigidBodySet) {
        if plan.calls < 2 {
            return;
        }
        for wall in &self.walls {
            if let Some(handle) = set.entity2body().get(wall)
                && let Some(motion) = set.bodies.get(*handle).and_then(|b| led(b, plan.time))
            {
                self.stepped.led.insert((context, id(*handle)), motion);
            }
        }
    }

    /// Returns `None` if there is nothing to do in a context, otherwise whether nothing has been changed since the last step.
    fn is_to_step(
        &self,
        context: Entity,
        simulation: &RapierContextSimulation,
        set: &Mut<RapierRigidBodySet>,
    ) -> Option<bool> {
        let here = self.groups.list().iter().any(|g| g.context == context);
        let left = self.left.iter().any(|(of, _)| *of == context)
            || self.unloaded.iter().any(|(of, ..)| *of == context);
        let quiet = self.changed.is_empty() && !self.loaded && !self.renewed && !left;
        let still = || {
            let active = simulation.islands.num_active_bodies();
            active == 0 && self.still.holds(context, set.last_changed())
        };
        let idle = !(here || left) || (quiet && !self.shifted && still());
        (!idle).then_some(quiet)
    }

    /// Removes from a context what elements that no longer act have left there, and restores the settings of bodies.
    fn take_out_what_is_left(
        &mut self,
        context: Entity,
        engine: &mut EngineParts,
        users: &Iterations,
    ) {
        self.left.retain_mut(|(of, inside)| {
            let here = *of == context;
            if here {
                remove(inside, engine);
            }
            !here
        });
        self.unloaded.retain_mut(|(of, body, raised)| {
            let here = *of == context;
            // Mutable access marks a body as modified, so not the one that has this handle in another context.
            if here && let Some(body) = engine.bodies.get_mut(handle(*body)) {
                let entity = Entity::try_from_bits(body.user_data as u64);
                if let Some(Ok((_, number))) = entity.map(|entity| users.get(entity)) {
                    raised.leave_substeps(number.0);
                }
                give_back(raised, body);
            }
            !here
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::measure::measure;
    use super::*;

    #[test]
    fn systems_that_share_work_run_on_the_main_thread() {
        fn may_leave<M>(system: impl IntoSystem<(), (), M>) -> bool {
            let mut system = IntoSystem::into_system(system);
            system.initialize(&mut World::new());
            system.is_send()
        }
        assert!(!may_leave(solve));
        assert!(!may_leave(measure));
        assert!(may_leave(|| {}));
    }
}
