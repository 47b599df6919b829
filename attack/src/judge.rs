//! Runs a planned scene and returns what is wrong with it.

use crate::plan::{Plan, TICKS};
use crate::stage::Stage;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;

thread_local! {
    static LAST_PANIC: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Result of a scene.
#[derive(Debug, PartialEq)]
pub enum Verdict {
    /// Nothing is wrong.
    Sound,
    /// Something is wrong, but the scene without springs fails as well: a fault of the engine.
    Engines(String),
    /// Something is wrong only with springs: a fault of this crate.
    Ours(String),
}

/// Installs a panic hook that keeps the message instead of printing it.
fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|info| {
            LAST_PANIC.with(|last| *last.borrow_mut() = info.to_string());
        }));
    });
}

/// Runs a scene. Returns what is wrong, if anything is.
fn run(plan: &Plan, with_springs: bool) -> Result<(), String> {
    listen();
    let played = catch_unwind(AssertUnwindSafe(|| play(plan, with_springs)));
    played.unwrap_or_else(|_| {
        let panic = LAST_PANIC.with(|last| last.borrow().clone());
        Err(format!("panic: {panic}"))
    })
}

/// Runs a scene. If something is wrong, runs it once more without springs.
pub fn judge(plan: &Plan) -> Verdict {
    match run(plan, true) {
        Ok(()) => Verdict::Sound,
        Err(wrong) => match run(plan, false) {
            Ok(()) => Verdict::Ours(wrong),
            // A panic in this crate's code is its fault, even if the engine fails as well.
            Err(_) if wrong.contains("panicked at src/") => Verdict::Ours(wrong),
            Err(engines) => Verdict::Engines(engines),
        },
    }
}

fn play(plan: &Plan, with_springs: bool) -> Result<(), String> {
    let mut stage = Stage::new(plan, with_springs);
    let mut deeds = plan.deeds.clone();
    deeds.sort_by_key(|(tick, _)| *tick);
    let mut deeds = deeds.iter().peekable();
    let mut kept = vec![None; plan.goes_back.len()];
    for tick in 0..TICKS {
        for ([_, back], kept) in plan.goes_back.iter().zip(&kept) {
            if *back == tick {
                go_back(&mut stage, kept);
            }
        }
        while let Some((_, deed)) = deeds.next_if(|(at, _)| *at == tick) {
            stage.act(deed, with_springs);
        }
        stage.app.update();
        is_finite(&mut stage).map_err(|wrong| format!("tick {tick}: {wrong}"))?;
        for ([taken, _], kept) in plan.goes_back.iter().zip(&mut kept) {
            if *taken == tick {
                *kept = Some(keep(&stage));
            }
        }
    }
    // Done without springs as well: a paused engine continues here, and may show its own faults only then.
    nothing_is_left(&mut stage)
}

type Kept = (RapierSnapshot, CoiloverSnapshot);

fn keep(stage: &Stage) -> Kept {
    let world = stage.app.world();
    (RapierSnapshot::take(world), CoiloverSnapshot::take(world))
}

/// Restores a snapshot if it fits. Changes since it was taken may forbid that, and then nothing changes.
fn go_back(stage: &mut Stage, kept: &Option<Kept>) {
    let Some((engine, springs)) = kept else {
        return;
    };
    let world = stage.app.world_mut();
    // The springs' side may fit where the engine's does not. That is no worse than a jump by the game.
    let _ = engine.restore(world);
    let _ = springs.restore(world);
}

/// Returns an error unless all visible state is finite.
fn is_finite(stage: &mut Stage) -> Result<(), String> {
    let world = stage.app.world_mut();
    let mut bodies = world.query::<(
        Entity,
        &Transform,
        Option<&Velocity>,
        Option<&ExternalForce>,
    )>();
    for (entity, place, velocity, force) in bodies.iter(world) {
        let moves = velocity.is_none_or(|v| v.linear.is_finite() && v.angular.is_finite());
        let pushed = force.is_none_or(|f| f.force.is_finite() && f.torque.is_finite());
        if !(place.is_finite() && moves && pushed) {
            return Err(format!("{entity}: {place:?}, {velocity:?}, {force:?}"));
        }
    }
    let mut readouts = world.query::<(Entity, &SpringReadout)>();
    for (entity, readout) in readouts.iter(world) {
        let all = [
            readout.length,
            readout.rate,
            readout.spring_force,
            readout.damper_force,
            readout.stored_energy,
            readout.dissipated_energy,
        ];
        if !all.into_iter().all(f32::is_finite) {
            return Err(format!("{entity}: {readout:?}"));
        }
    }
    Ok(())
}

/// Despawns all elements. Returns an error if loads, joints or solver iterations of theirs are left.
fn nothing_is_left(stage: &mut Stage) -> Result<(), String> {
    let mut configurations = stage.app.world_mut().query::<&mut RapierConfiguration>();
    for mut configuration in configurations.iter_mut(stage.app.world_mut()) {
        configuration.physics_pipeline_active = true;
    }
    for element in stage.elements.clone() {
        if let Ok(element) = stage.app.world_mut().get_entity_mut(element) {
            element.despawn();
        }
    }
    for _ in 0..3 {
        stage.app.update();
    }
    let world = stage.app.world_mut();
    let loads = world.query::<&SpringLoad>().iter(world).count();
    if loads > 0 {
        return Err(format!("{loads} bodies still have a SpringLoad"));
    }
    let joints = world
        .query::<&RapierImpulseJointHandle>()
        .iter(world)
        .count();
    for context in world.query::<&RapierContextJoints>().iter(world) {
        let inside = context.impulse_joints.len();
        if inside > joints {
            return Err(format!(
                "{inside} joints in the engine, {joints} of the game's"
            ));
        }
    }
    let mut bodies = world.query::<(&RapierRigidBodyHandle, Option<&AdditionalSolverIterations>)>();
    let ordered: Vec<_> = bodies
        .iter(world)
        .map(|(handle, more)| (handle.0, more.map_or(0, |more| more.0)))
        .collect();
    for set in world.query::<&RapierRigidBodySet>().iter(world) {
        for (handle, ordered) in &ordered {
            let more = set
                .bodies
                .get(*handle)
                .map_or(*ordered, |b| b.additional_solver_iterations());
            if more != *ordered {
                return Err(format!(
                    "{more} iterations more, of which the game ordered {ordered}"
                ));
            }
        }
    }
    Ok(())
}
