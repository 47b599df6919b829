//! Checks the set-up of plugins, schedule and timestep. For each mistake it logs one message that says what to change.

use crate::settings::CoiloverSettings;
use bevy::ecs::schedule::Schedules;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier3d::plugin::systems;
use bevy_rapier3d::prelude::*;
use std::any::Any;

/// The mistake in the set-up that [`check_schedule`] has found and reported.
#[derive(Resource, Default)]
pub(crate) struct Watched {
    /// Whether the engine is missing or does not step in the crate's schedule. Then the crate must do nothing, because impulses
    /// would accumulate without a step.
    misplaced: bool,
}

/// Checks that Rapier is present and steps in the crate's schedule.
pub(crate) fn check_schedule(
    settings: Res<CoiloverSettings>,
    schedules: Res<Schedules>,
    rapier: Option<Res<RapierContextInitialization>>,
    mut watched: ResMut<Watched>,
) {
    if rapier.is_none() {
        log::error!(
            "bevy_coilover: RapierPhysicsPlugin is missing, so springs and dampers do nothing; add \
             RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule() to the app"
        );
        watched.misplaced = true;
        return;
    }
    let label = settings.schedule;
    // Every schedule that steps Rapier contains its write-back system. That system has no generic parameter, so it can
    // be found by its type.
    let writeback = IntoSystem::into_system(systems::writeback_rigid_bodies).system_type();
    let steps_here = schedules.get(label).is_some_and(|schedule| {
        schedule
            .graph()
            .systems
            .iter()
            .any(|(_, system, _)| system.system_type() == writeback)
    });
    watched.misplaced = !steps_here;
    if !steps_here {
        log::error!(
            "bevy_coilover: CoiloverPlugin runs in {label:?} but RapierPhysicsPlugin does not, so \
             springs and dampers do nothing; use CoiloverPlugin::new(…) with Rapier's schedule, or \
             RapierPhysicsPlugin::in_fixed_schedule() with CoiloverPlugin::default()"
        );
    }
}

/// Whether Rapier is present and steps in the crate's schedule, according to [`check_schedule`].
pub(crate) fn in_place(watched: Res<Watched>, mode: Option<Res<TimestepMode>>) -> bool {
    !watched.misplaced && mode.is_some()
}

/// Mistakes in the timesteps that have been reported.
#[derive(Default)]
pub(crate) struct Told {
    variable: bool,
    mismatch: bool,
}

/// The timesteps of the engine and of the schedule.
#[derive(SystemParam)]
pub(crate) struct Timesteps<'w, 's> {
    pub(crate) mode: Res<'w, TimestepMode>,
    pub(crate) settings: Res<'w, CoiloverSettings>,
    fixed: Option<Res<'w, Time<Fixed>>>,
    told: Local<'s, Told>,
}

impl Timesteps<'_, '_> {
    /// Warns once if the engine's timestep does not fit the schedule's.
    pub(crate) fn check(&mut self) {
        // Compared by type, because to intern a label takes longer than all else here.
        let schedule: &dyn Any = &*self.settings.schedule;
        let fixed = self.fixed.as_ref();
        let Some(fixed) = fixed.filter(|_| schedule.is::<FixedUpdate>()) else {
            return;
        };
        let tick = fixed.timestep().as_secs_f32();
        let told = &mut self.told;
        match *self.mode {
            TimestepMode::Variable { .. } if !told.variable => {
                told.variable = true;
                log::warn!(
                    "bevy_coilover: TimestepMode::Variable in FixedUpdate ties the physics to max_dt; \
                 insert TimestepMode::Fixed {{ dt: {tick}, substeps: 1 }} instead"
                );
            }
            TimestepMode::Fixed { dt, .. } if !told.mismatch && (dt - tick).abs() > 1e-3 * tick => {
                told.mismatch = true;
                log::warn!(
                    "bevy_coilover: TimestepMode::Fixed steps {dt} s while FixedUpdate ticks every \
                 {tick} s, so physics runs {:.2} times as fast as time; set both alike, for \
                 example with Time::<Fixed>::from_seconds({dt})",
                    dt / tick
                );
            }
            _ => {}
        }
    }
}
