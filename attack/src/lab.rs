//! The app in which everything here is played.

use bevy::ecs::schedule::{Schedules, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

/// Length of a tick, s.
pub const DT: f32 = 1.0 / 60.0;

/// An app with nothing but Rapier and, if `springs`, this crate. Each update is one tick. It has been updated once.
pub fn app(springs: bool) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule());
    if springs {
        app.add_plugins(CoiloverPlugin::default());
    }
    set_rate(&mut app, DT, 1);
    app.finish();
    app.cleanup();
    // Worker threads would only slow down other scenes that run at the same time.
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app.update();
    app
}

/// Sets the length of a tick, s, and the number of steps of the engine in it.
pub fn set_rate(app: &mut App, dt: f32, substeps: usize) {
    let tick = Duration::from_secs_f32(dt);
    app.insert_resource(TimestepMode::Fixed { dt, substeps })
        .insert_resource(Time::<Fixed>::from_duration(tick))
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick));
}
