//! Does a wrong set-up cause a message that says what to change?

use crate::harness::*;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::cell::RefCell;
use std::time::Duration;

thread_local! {
    static MESSAGES: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

struct Collector;

impl log::Log for Collector {
    fn enabled(&self, metadata: &log::Metadata) -> bool {
        metadata.level() <= log::Level::Info
    }

    fn log(&self, record: &log::Record) {
        if self.enabled(record.metadata()) && record.target().starts_with("bevy_coilover") {
            MESSAGES.with_borrow_mut(|m| m.push(record.args().to_string()));
        }
    }

    fn flush(&self) {}
}

/// Messages of the crate on this thread. Labs run on the test's own thread.
pub struct Log;

impl Log {
    pub fn capture() -> Self {
        // Only the first call installs the logger. For later calls it is already there.
        let _ = log::set_logger(&Collector);
        log::set_max_level(log::LevelFilter::Info);
        MESSAGES.take();
        Self
    }

    pub fn take(&self) -> Vec<String> {
        MESSAGES.take()
    }
}

fn pull(app: &mut App) -> Entity {
    let hook = app.world_mut().spawn(Transform::default()).id();
    let body = app.world_mut().spawn(body(1.0, Vec3::X * 2.0)).id();
    app.world_mut().spawn(
        Spring::new(hook, body)
            .with_stiffness(10.0)
            .with_rest_length(1.0),
    );
    body
}

#[test]
fn a_sound_setup_says_nothing() {
    let log = Log::capture();
    let mut lab = Lab::new();
    pull(&mut lab.app);
    lab.run(0.2);
    assert_eq!(log.take(), Vec::<String>::new());
}

#[test]
fn without_rapier() {
    for plugin in [CoiloverPlugin::default(), CoiloverPlugin::at_hz(60.0)] {
        let log = Log::capture();
        let mut app = App::new();
        let tick = TimeUpdateStrategy::ManualDuration(Duration::from_millis(20));
        app.add_plugins((MinimalPlugins, TransformPlugin, plugin))
            .insert_resource(tick);
        pull(&mut app);
        single_threaded(&mut app);
        for _ in 0..3 {
            app.update();
        }
        let told = log.take();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].contains("RapierPhysicsPlugin is missing")
                && told[0].contains("in_fixed_schedule")
        );
    }
}

#[test]
fn with_rapier_in_another_schedule() {
    let log = Log::capture();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        RapierPhysicsPlugin::<NoUserData>::default(),
        CoiloverPlugin::default(),
    ));
    let body = pull(&mut app);
    single_threaded(&mut app);
    for _ in 0..5 {
        app.update();
    }
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("FixedUpdate") && told[0].contains("CoiloverPlugin::new"));
    // No load accumulates on the body meanwhile.
    assert!(app.world().get::<SpringLoad>(body).is_none());
}

#[test]
fn in_rapiers_own_schedule_it_works() {
    let log = Log::capture();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        RapierPhysicsPlugin::<NoUserData>::default(),
        CoiloverPlugin::new(PostUpdate),
    ))
    .insert_resource(TimestepMode::Fixed {
        dt: DT,
        substeps: 1,
    });
    let body = pull(&mut app);
    single_threaded(&mut app);
    for _ in 0..30 {
        app.update();
    }
    assert_eq!(log.take(), Vec::<String>::new());
    let x = app
        .world()
        .get::<Transform>(body)
        .map_or(f32::NAN, |t| t.translation.x);
    assert!(x < 1.9, "{x}");
}

#[test]
fn with_a_variable_timestep_in_the_fixed_schedule() {
    let log = Log::capture();
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app
        .add_plugins(CoiloverPlugin::default())
        .insert_resource(TimestepMode::default());
    lab.prime();
    lab.run(0.2);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("Variable") && told[0].contains("TimestepMode::Fixed"));
}

#[test]
fn with_an_engine_step_that_is_not_the_tick() {
    let log = Log::capture();
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app
        .add_plugins(CoiloverPlugin::default())
        .insert_resource(TimestepMode::Fixed {
            dt: 1.0 / 30.0,
            substeps: 1,
        });
    lab.prime();
    lab.run(0.2);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("2.00 times as fast"));
}

#[test]
fn an_element_with_a_name_is_told_by_it() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X);
    let spring = Spring::new(hook, body).with_stiffness(f32::NAN);
    lab.spawn((Name::new("Left rear"), spring));
    lab.run(0.1);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with("Left rear, ") && told[0].contains("Spring::stiffness is NaN"));
}

/// Two bodies, each on its own spring: one with the phase `omega_dt` per step, rad, and one with 0.5.
fn stiff_and_soft(plugin: CoiloverPlugin, omega_dt: f32) -> (Lab, [Entity; 2]) {
    let mut lab = Lab::with(plugin, Engine::default());
    let springs = [omega_dt, 0.5].map(|omega_dt| {
        let hook = lab.point(Vec3::ZERO);
        let body = lab.body(1.0, Vec3::X * 1.01);
        let omega = omega_dt / DT;
        lab.spawn(
            Spring::new(hook, body)
                .with_stiffness(omega * omega)
                .with_rest_length(1.0),
        )
    });
    (lab, springs)
}

#[test]
fn what_cannot_be_followed_is_told_once() {
    let log = Log::capture();
    // A lone spring takes up to 32 micro-steps. They are enough up to ω·dt = 64.
    let (mut lab, [stiff, soft]) = stiff_and_soft(CoiloverPlugin::default(), 100.0);
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains(&stiff.to_string()) && told[0].contains("too stiff"));
    assert!(!told[0].contains(&soft.to_string()), "{told:?}");
    assert!(lab.readout(stiff).capped && !lab.readout(soft).capped);

    let (mut lab, springs) = stiff_and_soft(CoiloverPlugin::default(), 50.0);
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new());
    assert!(springs.iter().all(|spring| !lab.readout(*spring).capped));
    // An explicit number of micro-steps is taken as given, without a message.
    let exactly = CoiloverPlugin::default().with_microsteps(2);
    let (mut lab, [stiff, _]) = stiff_and_soft(exactly, 100.0);
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new());
    assert!(!lab.readout(stiff).capped);
}

#[test]
fn a_network_beyond_its_budget_is_told_in_one_message() {
    let chain = |resolve| {
        let plugin = CoiloverPlugin::default().with_resolve(resolve);
        let mut lab = Lab::with(plugin, Engine::default());
        let mut last = lab.point(Vec3::ZERO);
        let mut springs = vec![];
        for link in 1..=5 {
            let next = lab.body(1.0, Vec3::X * link as f32);
            let omega = 20.0 / DT;
            let spring = Spring::new(last, next).with_stiffness(omega * omega);
            springs.push(lab.spawn(spring.with_rest_length(1.0)));
            last = next;
        }
        (lab, springs)
    };
    let log = Log::capture();
    let (mut lab, springs) = chain(10);
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("and 2 others"), "{told:?}");
    assert!(springs.iter().all(|spring| lab.readout(*spring).capped));
    // A later element gets its own message.
    let hook = lab.point(Vec3::Y);
    let body = lab.body(1.0, Vec3::new(1.01, 1.0, 0.0));
    let stiff = Spring::new(hook, body).with_stiffness(1e9);
    let late = lab.spawn(stiff.with_rest_length(1.0));
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains(&late.to_string()), "{told:?}");

    let (mut lab, springs) = chain(1024);
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new());
    assert!(springs.iter().all(|spring| !lab.readout(*spring).capped));
}
