//! The physics plugin: schedule and system sets.

use crate::backend::rapier::forces::SpringLoad;
use crate::backend::rapier::setup::Watched;
use crate::element::*;
use crate::input::lists::{with_companions, with_elements};
use crate::input::strays::{Role, Strays};
use crate::mouse_spring::{self, Grip, MouseSpring};
use crate::readout::SpringReadout;
use crate::scene::state::Scene;
use crate::settings::CoiloverSettings;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{PhysicsSet, TimestepMode};

/// Springs and dampers for bodies simulated by `bevy_rapier3d`; physics alone, nothing drawn.
///
/// Add it beside `RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule()`.
///
/// One kick of every element per engine step is enough for most scenes, and stiffer springs take more by themselves. The
/// error of anything that
/// swings or turns falls with the square of [`with_microsteps`](Self::with_microsteps), and
/// [`with_extrapolation`](Self::with_extrapolation) buys fourth order for three kicks.
#[derive(Clone, Copy, Debug)]
pub struct CoiloverPlugin {
    settings: CoiloverSettings,
    /// Ticks per second, if the plugin is to set them.
    rate: Option<f64>,
}

/// Kicks that stiff networks take together in a step by default, at most: about half a millisecond.
const RESOLVE: u32 = 1024;

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
                resolve: RESOLVE,
                extrapolation: false,
                tolerance: None,
                max_microsteps: 256,
                max_iterations: 200,
                max_substeps: 64,
                schedule: schedule.intern(),
            },
            rate: None,
        }
    }

    /// Runs in `FixedUpdate`, with so many ticks per second (finite and above zero, else an error is logged and
    /// the rates stay as they are).
    ///
    /// It sets both rates, which must be equal: that of physics, `TimestepMode::Fixed` with one substep, and that
    /// of the schedule, `Time<Fixed>`. What you insert afterwards takes their place.
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

    /// Sets the accuracy dial: exactly so many micro-steps per engine step (0 counts as 1). By default it is one, and more
    /// where springs are too stiff for that. This switches that off: follow it by [`with_resolve`](Self::with_resolve) for at least so
    /// many, and more for stiffer springs.
    pub const fn with_microsteps(mut self, microsteps: u32) -> Self {
        self.settings.microsteps = microsteps;
        self.settings.resolve = 1;
        self
    }

    /// Sets how many kicks stiff networks may take together in a step to be followed, where their stiff modes move
    /// ([`CoiloverSettings::resolve`], default 1024; 1 for no more than asked).
    pub const fn with_resolve(mut self, kicks: u32) -> Self {
        self.settings.resolve = kicks;
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

        let schedule = self.settings.schedule;
        app.add_systems(
            schedule,
            crate::input::strays::tell_strays.run_if(crate::input::strays::any_strays),
        );
        let any_held = any_with_component::<MouseSpring>.or_else(any_with_component::<Grip>);
        app.add_observer(mouse_spring::forget);
        app.add_systems(
            schedule,
            mouse_spring::hold
                .run_if(any_held)
                .after(PhysicsSet::SyncBackend)
                .before(CoiloverSystems::Prepare),
        );
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
                (
                    crate::input::named_ends::find_named_ends
                        .run_if(any_with_component::<AwaitsEnds>),
                    crate::input::anchoring::anchor.run_if(any_with_component::<WorldAnchors>),
                    crate::backend::rapier::prepare::prepare,
                )
                    .chain_ignore_deferred()
                    .in_set(CoiloverSystems::Prepare),
                crate::backend::rapier::solve::solve.in_set(CoiloverSystems::Solve),
                (
                    crate::backend::rapier::measure::measure,
                    crate::scene::breaking::break_overloaded
                        .run_if(any_with_component::<Breakable>),
                )
                    .chain()
                    .in_set(CoiloverSystems::Readout),
            )
                // Without Rapier there is nothing to do, and a message has said so.
                .run_if(resource_exists::<TimestepMode>)
                .run_if(crate::backend::rapier::setup::in_place),
        );
    }
}

/// What a designer writes is in the type registry: elements and their companions.
pub(crate) fn register_elements(app: &mut App) {
    macro_rules! elements {
        ($($element:ident),*) => {$(app.register_type::<$element>();)*};
    }
    with_elements!(elements);
    // Laws that are functions are no data.
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

/// Sets the rates of physics and of `FixedUpdate` alike.
fn set_rates(app: &mut App, hertz: f64) {
    let seconds = hertz.recip();
    if !(seconds.is_normal() && seconds > 0.0 && seconds < 1e6) {
        log::error!(
            "bevy_coilover: CoiloverPlugin::at_hz({hertz}): a rate must be finite and above zero; the rates stay \
             as they are"
        );
        return;
    }
    app.insert_resource(TimestepMode::Fixed {
        dt: seconds as f32,
        substeps: 1,
    })
    .insert_resource(Time::<Fixed>::from_seconds(seconds));
}

/// What stands where no element is does nothing, and that is told.
fn notice_strays(app: &mut App) {
    use crate::input::strays::notice;
    macro_rules! companions {
        ([$($law:ident: $kind:ident),*] [$($other:ident: $other_kind:ident),*]) => {
            $(notice::<$kind>(app, Role::Companion);)*
            $(notice::<$other_kind>(app, Role::Companion);)*
        };
    }
    with_companions!(companions);
    notice::<Anchors>(app, Role::Companion);
    notice::<WorldAnchors>(app, Role::Companion);
    notice::<EndNames>(app, Role::Companion);
    #[cfg(feature = "visual")]
    {
        notice::<crate::Coil>(app, Role::Look);
        notice::<crate::Telescope>(app, Role::Look);
        notice::<crate::TorsionCoil>(app, Role::Spiral);
    }
}
