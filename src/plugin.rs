//! The physics plugin: schedule and system sets.

use crate::backend::rapier::forces::{SpringLoad, WithDisabled};
use crate::backend::rapier::setup::Watched;
use crate::element::*;
use crate::input::lists::{with_companions, with_elements};
use crate::input::strays::{Role, Strays};
use crate::mouse_spring::{self, Grip, MouseSpring};
use crate::readout::SpringReadout;
use crate::scene::state::Scene;
use crate::settings::{CoiloverSettings, MAX_ITERATIONS, MAX_MICROSTEPS, MAX_SUBSTEPS, RESOLVE};
use bevy::ecs::query::ArchetypeFilter;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{PhysicsSet, TimestepMode};

/// Simulates springs and dampers on the bodies of `bevy_rapier3d`. It does physics only and draws nothing.
///
/// Add it together with `RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()`.
///
/// One micro-step per engine step is enough for most scenes, and stiffer springs take more by themselves. Where elements
/// share bodies, the position error of what swings or turns falls with the square of the number of micro-steps, see
/// [`with_microsteps`](Self::with_microsteps). With [`with_extrapolation`](Self::with_extrapolation) it falls with the
/// fourth power, for three times as many micro-steps. That of a lone element between the centres of two bodies falls
/// with the fourth power by itself.
#[derive(Clone, Copy, Debug)]
pub struct CoiloverPlugin {
    settings: CoiloverSettings,
    /// Ticks per second that the plugin sets; `None` if it sets no rates.
    rate: Option<f64>,
}

/// System sets of the plugin, in the order in which they run.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CoiloverSystems {
    /// Finds elements and their ends. Runs after Rapier's `PhysicsSet::SyncBackend`. Change elements before this set to
    /// have the change act in the same step.
    Prepare,
    /// Computes the forces and writes them. Runs after [`Self::Prepare`] and before Rapier's
    /// `PhysicsSet::StepSimulation`.
    Solve,
    /// Writes [`SpringReadout`] and breaks elements that are [`Breakable`]. Runs after Rapier's
    /// `PhysicsSet::Writeback`. Read readouts after this set.
    Readout,
}

impl Default for CoiloverPlugin {
    fn default() -> Self {
        Self::new(FixedUpdate)
    }
}

impl CoiloverPlugin {
    /// Returns a plugin that runs in `schedule`. Rapier must run in the same schedule; otherwise an error is logged and
    /// springs do nothing. `default()` uses `FixedUpdate`.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            settings: CoiloverSettings {
                microsteps: 1,
                resolve: RESOLVE,
                extrapolation: false,
                tolerance: None,
                max_microsteps: MAX_MICROSTEPS,
                max_iterations: MAX_ITERATIONS,
                max_substeps: MAX_SUBSTEPS,
                schedule: schedule.intern(),
            },
            rate: None,
        }
    }

    /// Returns a plugin that runs in `FixedUpdate` at `hertz` ticks per second.
    ///
    /// It sets two rates, which must be equal: the rate of physics (`TimestepMode::Fixed` with one substep) and the
    /// rate of the schedule (`Time<Fixed>`). If you insert one of these resources later, yours takes its place. `hertz`
    /// must be from 1e-6 to 1e9; otherwise an error is logged and both rates stay as they are.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_coilover::prelude::*;
    /// # use bevy_rapier3d::prelude::*;
    /// # let mut app = App::new();
    /// app.add_plugins((
    ///     CoiloverPlugin::at_hz(120.0),
    ///     RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
    /// ));
    /// assert_eq!(app.world().resource::<Time<Fixed>>().timestep().as_micros(), 8333);
    /// ```
    pub fn at_hz(hertz: f64) -> Self {
        Self {
            rate: Some(hertz),
            ..Self::default()
        }
    }

    /// Sets the number of micro-steps per engine step (0 counts as 1), and sets [`CoiloverSettings::resolve`] to 1, so
    /// that stiff springs take no more by themselves. To take at least this number, and more for stiffer springs, call
    /// [`with_resolve`](Self::with_resolve) afterwards.
    ///
    /// A lone linear element then takes exactly this number. A network may still take up to 4 micro-steps to resolve
    /// its stiffest mode, and up to 20 where a force law has a kink, such as a rope that goes taut.
    pub const fn with_microsteps(mut self, microsteps: u32) -> Self {
        self.settings.microsteps = microsteps;
        self.settings.resolve = 1;
        self
    }

    /// Sets [`CoiloverSettings::resolve`]: the most kicks per step that all stiff networks together may take to follow
    /// their stiff modes while these move. Default 1024. 1 switches this off, also for lone elements.
    pub const fn with_resolve(mut self, kicks: u32) -> Self {
        self.settings.resolve = kicks;
        self
    }

    /// Lets each network choose its number of micro-steps in every step, so that the position error grows by about
    /// `tolerance`, in metres per simulated second. A value that is not finite and above zero means no tolerance.
    pub const fn with_tolerance(mut self, tolerance: f32) -> Self {
        self.settings.tolerance = Some(tolerance);
        self
    }

    /// Sets the most micro-steps of one engine step (default 256).
    pub const fn with_max_microsteps(mut self, most: u32) -> Self {
        self.settings.max_microsteps = most;
        self
    }

    /// Sets the most iterations of one linear solve of a large network (default 200).
    pub const fn with_max_iterations(mut self, most: u32) -> Self {
        self.settings.max_iterations = most;
        self
    }

    /// Sets the most solver substeps that elements on held bodies (with contacts or joints) may request from the engine
    /// in one step (default 64).
    pub const fn with_max_substeps(mut self, most: u32) -> Self {
        self.settings.max_substeps = most;
        self
    }

    /// Turns on extrapolation in all steps in which it is valid; see [`CoiloverSettings::extrapolation`].
    pub const fn with_extrapolation(mut self) -> Self {
        self.settings.extrapolation = true;
        self
    }
}

impl Plugin for CoiloverPlugin {
    fn build(&self, app: &mut App) {
        register_elements(app);
        app.register_type::<SpringReadout>()
            .register_type::<SpringLoad>()
            .register_type::<SpringFault>()
            .insert_resource(self.settings)
            .init_resource::<Scene>()
            .init_resource::<Watched>()
            .init_resource::<Strays>()
            .add_systems(PreStartup, crate::backend::rapier::setup::check_schedule);
        if let Some(hertz) = self.rate {
            set_rates(app, hertz);
        }
        notice_strays(app);
        crate::backend::rapier::watch::watch(app);
        crate::input::named_ends::watch(app);

        let schedule = self.settings.schedule;
        app.add_systems(
            schedule,
            crate::input::strays::tell_strays.run_if(crate::input::strays::any_strays),
        );
        app.add_observer(mouse_spring::forget);
        app.add_systems(
            schedule,
            mouse_spring::hold
                .run_if(any::<(Or<(With<MouseSpring>, With<Grip>)>, WithDisabled)>)
                .after(PhysicsSet::SyncBackend)
                .before(CoiloverSystems::Prepare),
        );
        order_sets(app, schedule);
        app.add_systems(
            schedule,
            (
                (
                    // Both apply their commands themselves: a sync point would run in every tick.
                    crate::input::named_ends::find_named_ends
                        .pipe(crate::input::anchoring::anchor)
                        .run_if(any::<Or<(With<AwaitsEnds>, With<WorldAnchors>)>>),
                    crate::backend::rapier::prepare::prepare
                        .run_if(crate::backend::rapier::watch::any_news),
                )
                    .chain()
                    .in_set(CoiloverSystems::Prepare),
                crate::backend::rapier::solve::solve.in_set(CoiloverSystems::Solve),
                // One system, because a system of its own costs more than a look at no `Breakable`.
                crate::backend::rapier::measure::measure
                    .pipe(crate::scene::breaking::break_overloaded)
                    .in_set(CoiloverSystems::Readout),
            )
                // Without Rapier there is nothing to do. `check_schedule` has logged that.
                .run_if(crate::backend::rapier::setup::in_place),
        );
    }
}

/// Puts the sets of systems before and after the engine's step.
fn order_sets(app: &mut App, schedule: impl ScheduleLabel) {
    app.configure_sets(
        schedule,
        (
            (CoiloverSystems::Prepare, CoiloverSystems::Solve)
                .chain()
                .after(PhysicsSet::SyncBackend)
                .before(PhysicsSet::StepSimulation),
            CoiloverSystems::Readout.after(PhysicsSet::Writeback),
        ),
    );
}

/// Run condition: some entity passes the filter.
fn any<F: ArchetypeFilter + 'static>(entities: Query<(), F>) -> bool {
    !entities.is_empty()
}

/// Registers the types that a designer writes in scenes: elements and their companions.
pub(crate) fn register_elements(app: &mut App) {
    macro_rules! elements {
        ($($element:ident),*) => {$(app.register_type::<$element>();)*};
    }
    with_elements!(elements);
    // Custom laws are functions, which cannot be reflected.
    app.register_type::<SpringLaw>()
        .register_type::<DampingLaw>()
        .register_type::<SpringAction>()
        .register_type::<SpringTravel>()
        .register_type::<SpringAxis>()
        .register_type::<Preload>()
        .register_type::<MaxForce>()
        .register_type::<Breakable>()
        .register_type::<SpringTuning>()
        .register_type::<HoldPose>()
        .register_type::<Anchors>()
        .register_type::<WorldAnchors>()
        .register_type::<EndNames>()
        .register_type::<MouseSpring>();
}

/// Sets the rate of physics and the rate of `FixedUpdate`, both to `hertz`.
fn set_rates(app: &mut App, hertz: f64) {
    let seconds = hertz.recip();
    // Bevy counts a tick in whole nanoseconds, and panics at none.
    if !(1e-9..=1e6).contains(&seconds) {
        log::error!(
            "bevy_coilover: CoiloverPlugin::at_hz({hertz}): a rate must be from 1e-6 to 1e9; the rates stay as they are"
        );
        return;
    }
    app.insert_resource(TimestepMode::Fixed {
        dt: seconds as f32,
        substeps: 1,
    })
    .insert_resource(Time::<Fixed>::from_seconds(seconds));
}

/// Watches for components that do nothing because their entity has no element, so that a warning can be logged.
fn notice_strays(app: &mut App) {
    use crate::input::strays::{kind, notice};
    macro_rules! companions {
        ([$($law:ident: $kind:ident),*] [$($other:ident: $other_kind:ident),*]) => {
            vec![
                $(kind::<$kind>(app),)*
                $(kind::<$other_kind>(app),)*
                kind::<Anchors>(app),
                kind::<WorldAnchors>(app),
                kind::<EndNames>(app),
            ]
        };
    }
    let companions = with_companions!(companions);
    notice(app, Role::Companion, companions);
    #[cfg(feature = "visual")]
    {
        let looks = vec![
            kind::<crate::Coil>(app),
            kind::<crate::Telescope>(app),
            kind::<crate::ShowSpringGizmos>(app),
        ];
        notice(app, Role::Look, looks);
        let spirals = vec![kind::<crate::TorsionCoil>(app)];
        notice(app, Role::Spiral, spirals);
    }
}
