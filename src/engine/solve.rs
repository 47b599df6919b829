//! The step's system: component by component.

use super::assembly::Assembly;
use super::body::{Engine, FARTHEST_TURN};
use super::forces::{self, Loads};
use super::group::{Group, Groups};
use super::inside::{Crowd, EngineParts, Outlook, Solver, Surroundings};
use super::lone::{BATCH, Batch, prefetch};
use super::point::Route;
use super::rows::{BodyRow, ElementRow};
use super::scene::Scene;
use super::step::Step;
use super::timestep::Plan;
use crate::settings::CoiloverSettings;
use bevy::prelude::*;
use bevy::tasks::ComputeTaskPool;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{DefaultBroadPhase, NarrowPhase};
use std::num::NonZeroUsize;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

/// What of a Rapier context the step needs.
type ContextParts<'a> = (
    Entity,
    &'a mut RapierContextSimulation,
    &'a mut RapierContextColliders,
    &'a mut RapierContextJoints,
    &'a RapierConfiguration,
    &'a SimulationToRenderTime,
);

/// Elements in networks that are about to be solved, above which it is worth waking other threads, and the few
/// allocations that this takes: the only ones of a warm step.
const WORTH_SHARING: usize = 256;

/// More threads than these would only wait for each other.
static CORES: LazyLock<usize> =
    LazyLock::new(|| available_parallelism().map_or(1, NonZeroUsize::get));

/// Room for the work of a step.
#[derive(Default)]
pub(crate) struct Spare {
    batch: Batch,
    /// What lone elements are assembled in that need the general solver.
    assembly: Assembly,
    /// Groups that need the general solver in this step.
    general_once: Vec<usize>,
    /// Groups that need it for as long as can be seen.
    general: Vec<usize>,
    inside: Solver,
}

/// Computes and delivers every element's force for the coming engine step.
pub(crate) fn solve(
    mut scene: ResMut<Scene>,
    settings: Res<CoiloverSettings>,
    mode: Res<TimestepMode>,
    time: Res<Time>,
    mut contexts: Query<ContextParts>,
    mut sets: Query<&mut RapierRigidBodySet>,
    mut loads: Loads,
    users: Query<&AdditionalSolverIterations>,
    mut spare: Local<Spare>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    if scene.renewed {
        forces::release(scene, &mut loads, &mut sets, &mut commands);
    }
    scene.time = 0.0;
    scene.stepped.clear();
    scene.delivered = false;
    for (context, mut simulation, mut colliders, mut joints, configuration, lag) in &mut contexts {
        let plan = Plan::new(*mode, time.delta_secs(), lag.diff);
        if plan.time <= 0.0 || !configuration.physics_pipeline_active {
            // What is moved meanwhile is not to be taken for known.
            scene.still.note(context, false);
            continue;
        }
        scene.time = plan.time;
        scene.stepped.push(context);
        let here = scene.groups.list().iter().any(|g| g.context == context);
        let left = scene.left.iter().any(|(of, _)| *of == context)
            || scene.unloaded.iter().any(|(of, ..)| *of == context);
        let Ok(mut set) = sets.get_mut(context) else {
            continue;
        };
        let quiet = scene.changed.is_empty() && !scene.loaded && !scene.renewed && !left;
        if !(here || left)
            || (quiet && !scene.shifted && scene.still.holds(context, &simulation, &set))
        {
            continue;
        }
        let simulation = &mut *simulation;
        let parameters = simulation.integration_parameters;
        let mut step = Step {
            plan,
            schedule: plan.schedule(parameters.num_solver_iterations),
            engine: Engine {
                iterations: parameters.num_solver_iterations,
                fastest: f64::from(parameters.max_linear_velocity()),
                farthest_turn: FARTHEST_TURN * f64::from(plan.pipeline_steps),
                length_unit: parameters.length_unit,
                gravity: configuration.gravity,
            },
            accuracy: settings.accuracy(),
            most_substeps: settings.max_substeps.max(1),
            alike: None,
            quiet,
            delivered: AtomicBool::new(false),
        };
        let mut engine = EngineParts {
            bodies: &mut set.bodies,
            joints: &mut joints,
            islands: &mut simulation.islands,
            colliders: &mut colliders.colliders,
        };
        scene.left.retain_mut(|(of, inside)| {
            let here = *of == context;
            if here {
                inside.remove(&mut engine);
            }
            !here
        });
        scene.unloaded.retain_mut(|(of, handle, raised)| {
            let here = *of == context;
            if let Some(body) = engine.bodies.get_mut(*handle).filter(|_| here) {
                raised.give_back(body);
            }
            !here
        });
        let finest = users.iter().map(|users| users.0).max().unwrap_or(0);
        let spare = &mut *spare;
        let held_asleep = scene.step_held(
            context,
            &mut step,
            (&simulation.narrow_phase, &simulation.broad_phase),
            &mut engine,
            finest,
            &mut spare.inside,
        );
        let all_asleep = scene.step(context, &step, engine.bodies, spare) && held_asleep;
        let sweeps = &mut simulation
            .integration_parameters
            .num_internal_pgs_iterations;
        let told = scene.sweeps.entry(context).or_default();
        told.raise(sweeps, spare.inside.sweeps());
        scene.still.note(context, all_asleep);
        scene.delivered |= step.delivered.into_inner();
    }
    forces::show(scene, &mut loads);
}

impl Scene {
    /// Finds what contacts or joints hold, and has the engine solve it; says whether all of that is asleep.
    fn step_held(
        &mut self,
        context: Entity,
        step: &mut Step,
        (narrow, broad): (&NarrowPhase, &DefaultBroadPhase),
        engine: &mut EngineParts,
        finest: usize,
        solver: &mut Solver,
    ) -> bool {
        let Self {
            elements,
            bodies,
            groups,
            handles,
            assemblies,
            stale,
            ..
        } = self;
        let mut all_asleep = true;
        solver.clear();
        if !self.changed.is_empty() || self.renewed {
            add_up(elements, bodies);
        }
        let any_changed = !self.changed.is_empty();
        let time = step.plan.time / f64::from(step.plan.pipeline_steps.max(1));
        let new = |row: &BodyRow| row.is_new && row.context == context;
        let crowd = bodies.iter().any(new).then(|| Crowd::new(engine.colliders));
        for g in 0..groups.list().len() {
            let group = &groups.list()[g];
            if group.context != context {
                continue;
            }
            let members = groups.members(group);
            let (was_inside, asleep) = (group.inside, group.is_asleep);
            if was_inside
                && asleep
                && step.quiet
                && step.is_left_alone(&members, elements, bodies, engine.bodies)
            {
                continue;
            }
            if any_changed && members.elements.iter().any(|e| elements[*e].changed) {
                groups.at(g).clear = 0;
            }
            let group = &groups.list()[g];
            let members = groups.members(group);
            solver.look_at_pushes(step, &members, elements, bodies, engine.bodies);
            let around = Surroundings::new(narrow, engine.joints, engine.colliders, crowd.as_ref());
            let (mut held, mut stiff) = (false, false);
            for (slot, b) in members.bodies.iter().enumerate() {
                let row = &mut bodies[*b];
                let push = solver.pushes[slot];
                if (row.can_touch || around.any_joints || row.lingers > 0.0)
                    && let Some(body) = engine.bodies.get_mut(row.handle)
                {
                    held |= around.look(row, body, step.plan.time, push);
                    stiff |= row.look_ahead(body, time);
                }
            }
            if stiff && !held && group.clear == 0 {
                let outlook = Outlook {
                    broad,
                    bodies: engine.bodies,
                    colliders: engine.colliders,
                    time: step.plan.time as f32,
                };
                let rows: Vec<_> = members.bodies.iter().map(|b| &bodies[*b]).collect();
                let (near, clear) = outlook.look(&rows, &solver.pushes, |handle| {
                    let row = handles
                        .get(&(context, handle))
                        .map(|b| &bodies[*b as usize]);
                    row.is_some_and(|row| row.group == g as u32)
                });
                held = near;
                groups.at(g).clear = clear;
            } else {
                groups.at(g).clear = group.clear.saturating_sub(1);
            }
            let members = groups.members(&groups.list()[g]);
            held &= !members.elements.is_empty();
            if !(held || was_inside) {
                groups.at(g).held = false;
                continue;
            }
            let awake = solver.read(step, g, &members, elements, bodies, engine, narrow, stale);
            if !held && awake {
                solver.release(groups, elements, bodies, engine);
            }
            let index = groups.list()[g].assembly;
            if let Some(index) = index {
                assemblies[index].forget();
            }
            let group = groups.at(g);
            group.held = held || !awake;
            group.is_asleep = !awake;
            all_asleep &= !awake || !held;
        }
        solver.write(step, groups, elements, bodies, engine, finest);
        let links = engine.joints.multibody_joints.multibodies().next();
        step.alike = links.map(|_| {
            let more = |row: &BodyRow| row.raised.iterations();
            bodies.iter().map(more).max().unwrap_or(0).max(finest)
        });
        all_asleep
    }

    /// Takes every other component of a context through the step; says whether all of them are asleep.
    fn step(
        &mut self,
        context: Entity,
        step: &Step,
        set: &mut RigidBodySet,
        spare: &mut Spare,
    ) -> bool {
        let Self {
            elements,
            bodies,
            groups,
            assemblies,
            stale,
            ..
        } = self;
        let mut all_asleep = true;
        // First, so that what touches them is read as the engine has left it, whatever lone elements there are.
        let free = |g: &&Group| g.context == context && !g.held;
        for group in groups.list().iter().filter(free) {
            if let Some(index) = group.assembly {
                let members = groups.members(group);
                assemblies[index].gather(step, &members, elements, bodies, set, stale);
                all_asleep &= assemblies[index].is_asleep();
            }
        }
        for g in 0..groups.list().len() {
            if g % BATCH == 0 {
                prefetch(groups, g, elements, bodies, set);
            }
            let group = &groups.list()[g];
            if group.context != context || group.assembly.is_some() || group.held {
                continue;
            }
            if let (true, Some(handles)) = (step.quiet, &group.dozing)
                && handles
                    .iter()
                    .all(|handle| set.get(*handle).is_some_and(RapierBody::is_sleeping))
            {
                continue;
            }
            let members = groups.members(group);
            let batch = &mut spare.batch;
            let route = step.gather_lone(batch, g, &members, elements, bodies, set, stale);
            let mut dozing = None;
            all_asleep &= matches!(route, Route::Asleep(_));
            match route {
                Route::Asleep(handles) => dozing = handles,
                Route::GeneralOnce => spare.general_once.push(g),
                Route::General => spare.general.push(g),
                Route::Batched | Route::Gone => {}
            }
            groups.at(g).dozing = dozing;
            if spare.batch.is_full() {
                step.scatter(
                    &mut spare.batch,
                    elements,
                    bodies,
                    set,
                    &mut spare.general_once,
                );
            }
        }
        step.scatter(
            &mut spare.batch,
            elements,
            bodies,
            set,
            &mut spare.general_once,
        );
        for g in spare
            .general_once
            .drain(..)
            .chain(spare.general.iter().copied())
        {
            let (members, assembly) = (groups.members(&groups.list()[g]), &mut spare.assembly);
            assembly.gather(step, &members, elements, bodies, set, stale);
            assembly.advance(step, &members, bodies, set);
            assembly.deliver(step, &members, elements, bodies, set);
            assembly.forget();
        }
        advance(assemblies, step, groups, bodies, set);
        for group in groups.list().iter().filter(free) {
            if let Some(index) = group.assembly {
                assemblies[index].deliver(step, &groups.members(group), elements, bodies, set);
            }
        }
        for group in spare.general.drain(..) {
            groups.promote(group, assemblies);
        }
        all_asleep
    }
}

/// Of each body the stiffness of all its elements.
fn add_up(elements: &[ElementRow], bodies: &mut [BodyRow]) {
    for row in bodies.iter_mut() {
        row.stiffness = 0.0;
    }
    for row in elements
        .iter()
        .filter(|row| !row.companion.guide.is_twist())
    {
        for body in row.on.iter().flatten() {
            let stiffness = match row.companion.law {
                // It may be anything where it kinks.
                Some(_) => f64::INFINITY,
                None => f64::from(row.parameters.stiffness),
            };
            bodies[*body as usize].stiffness += stiffness;
        }
    }
}

/// Integrates all assemblies, on several threads where that is worth it; each is on its own, so the
/// result is the same.
fn advance(
    assemblies: &mut [Assembly],
    step: &Step,
    groups: &Groups,
    bodies: &[BodyRow],
    set: &RigidBodySet,
) {
    let load: usize = assemblies.iter().map(Assembly::load).sum();
    // The one that waits for the pool works too: on two cores the pool has just one.
    let pool = ComputeTaskPool::try_get().map_or(0, |pool| pool.thread_num());
    let threads = CORES.min(pool + 1);
    let ready = assemblies.iter().filter(|a| a.load() > 0).count();
    let advance = |assemblies: &mut [Assembly]| {
        for assembly in assemblies {
            let group = &groups.list()[assembly.group];
            assembly.advance(step, &groups.members(group), bodies, set);
        }
    };
    if threads < 2 || ready < 2 || load < WORTH_SHARING {
        return advance(assemblies);
    }
    let chunk = assemblies.len().div_ceil(4 * threads);
    let advance = &advance;
    ComputeTaskPool::get().scope(|scope| {
        for chunk in assemblies.chunks_mut(chunk) {
            scope.spawn(async move { advance(chunk) });
        }
    });
}
