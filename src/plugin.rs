//! The physics plugin: schedule and system sets.

use crate::element::*;
use crate::engine::{self, Scene, SpringLoad, Watched};
use crate::readout::SpringReadout;
use crate::settings::CoiloverSettings;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{PhysicsSet, TimestepMode};

/// Springs and dampers for bodies simulated by `bevy_rapier3d`; physics alone, nothing drawn.
///
/// Add it beside `RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()`.
///
/// One kick of every element per engine step is enough for most scenes. The error of anything that
/// swings or turns falls with the square of [`with_microsteps`](Self::with_microsteps), and
/// [`with_extrapolation`](Self::with_extrapolation) buys fourth order for three kicks.
#[derive(Clone, Copy, Debug)]
pub struct CoiloverPlugin {
    settings: CoiloverSettings,
}

/// What the plugin does in its schedule, in this order.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoiloverSystems {
    /// After Rapier's `PhysicsSet::SyncBackend`: elements and their ends are found.
    Prepare,
    /// Then: forces are computed and written. Change elements before [`Self::Prepare`] to have them
    /// act in the same step.
    Solve,
    /// After Rapier's `PhysicsSet::Writeback`: [`SpringReadout`] is written. Read it after this.
    Readout,
}

impl Default for CoiloverPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl CoiloverPlugin {
    /// Runs in this schedule, which must be Rapier's. `default()` is `FixedUpdate`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            settings: CoiloverSettings {
                microsteps: 1,
                extrapolation: false,
                tolerance: None,
                max_microsteps: 256,
                max_iterations: 200,
                max_substeps: 64,
                schedule: schedule.intern(),
            },
        }
    }

    /// Sets the accuracy dial: micro-steps per engine step (default 1; 0 counts as 1).
    pub const fn with_microsteps(mut self, microsteps: u32) -> Self {
        self.settings.microsteps = microsteps;
        self
    }

    /// Lets each network choose its micro-steps in every step so that the error of position grows by about
    /// `tolerance` metres per simulated second. Zero, negative and NaN mean no tolerance.
    pub const fn with_tolerance(mut self, tolerance: f32) -> Self {
        self.settings.tolerance = Some(tolerance);
        self
    }

    /// Caps the micro-steps of an engine step (default 256).
    pub const fn with_max_microsteps(mut self, most: u32) -> Self {
        self.settings.max_microsteps = most;
        self
    }

    /// Caps the iterations of one solve of a large network (default 200).
    pub const fn with_max_iterations(mut self, most: u32) -> Self {
        self.settings.max_iterations = most;
        self
    }

    /// Caps the solver substeps that elements on held bodies ask of the engine in one step (default 64).
    pub const fn with_max_substeps(mut self, most: u32) -> Self {
        self.settings.max_substeps = most;
        self
    }

    /// Turns on the fourth-order combination wherever it is valid.
    pub const fn with_extrapolation(mut self) -> Self {
        self.settings.extrapolation = true;
        self
    }
}

impl Plugin for CoiloverPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Spring>()
            .register_type::<Damper>()
            .register_type::<SpringDamper>()
            .register_type::<TorsionSpring>()
            .register_type::<TorsionDamper>()
            .register_type::<TorsionSpringDamper>()
            .register_type::<Anchors>()
            .register_type::<SpringLaw>()
            .register_type::<DampingLaw>()
            .register_type::<SpringAction>()
            .register_type::<SpringTravel>()
            .register_type::<SpringAxis>()
            .register_type::<Preload>()
            .register_type::<MaxForce>()
            .register_type::<Breakable>()
            .register_type::<SpringTuning>()
            .register_type::<SpringReadout>()
            .register_type::<SpringLoad>()
            .register_type::<SpringFault>()
            .insert_resource(self.settings)
            .init_resource::<Scene>()
            .init_resource::<Watched>()
            .add_systems(PreStartup, engine::check_schedule);

        let schedule = self.settings.schedule;
        app.configure_sets(
            schedule,
            (
                (CoiloverSystems::Prepare, CoiloverSystems::Solve)
                    .chain()
                    .after(PhysicsSet::SyncBackend)
                    .before(PhysicsSet::StepSimulation),
                CoiloverSystems::Readout.after(PhysicsSet::Writeback),
            ),
        )
        .add_systems(
            schedule,
            (
                (engine::check_timestep, engine::prepare)
                    .chain()
                    .in_set(CoiloverSystems::Prepare),
                (engine::read_users, engine::solve)
                    .chain()
                    .in_set(CoiloverSystems::Solve),
                (engine::mark, engine::measure, engine::break_overloaded)
                    .chain()
                    .in_set(CoiloverSystems::Readout),
            )
                // Without Rapier there is nothing to do, and a message has said so.
                .run_if(resource_exists::<TimestepMode>)
                .run_if(engine::in_place),
        );
    }
}
