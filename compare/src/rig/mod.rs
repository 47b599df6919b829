//! Sets up a problem in an engine, in a headless app that makes one step per `tick`.

pub mod avian;
pub mod rapier;

use crate::method::Setting;
use crate::problem::Problem;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use std::time::Duration;

/// An app in which every update is one step of the engine.
pub struct Rig {
    app: App,
    bodies: Vec<Entity>,
    read: fn(&World, Entity) -> Option<State>,
}

/// Position, rotation, velocity (m/s) and angular velocity (rad/s) of a body in world space.
#[derive(Clone, Copy, Debug)]
pub struct State {
    pub position: DVec3,
    pub rotation: DQuat,
    pub velocity: DVec3,
    pub spin: DVec3,
}

impl Rig {
    pub fn new(problem: &Problem, setting: Setting) -> Self {
        let ground = Some(rapier::GROUND_FREQUENCY);
        Self::build(setting, problem.gravity, ground, |world| {
            if setting.method.is_avian() {
                avian::fill(world, problem, setting.method)
            } else {
                rapier::fill(world, problem, setting.method)
            }
        })
    }

    /// Builds an app whose bodies and springs are spawned by `fill`. `ground` is the natural frequency of Rapier's contacts
    /// with bodies that are not dynamic, Hz. With `None` the engine keeps its default.
    pub fn build(
        setting: Setting,
        gravity: Vec3,
        ground: Option<f32>,
        fill: impl FnOnce(&mut World) -> Vec<Entity>,
    ) -> Self {
        let mut app = App::new();
        let tick = Duration::from_secs_f64(setting.dt());
        app.add_plugins((MinimalPlugins, TransformPlugin))
            .insert_resource(Time::<Fixed>::from_duration(tick))
            .insert_resource(TimeUpdateStrategy::ManualDuration(tick));
        let avian = setting.method.is_avian();
        if avian {
            avian::plug(&mut app, gravity, setting.dial);
        } else {
            rapier::plug(&mut app, gravity, ground, setting);
        }
        app.finish();
        app.cleanup();
        // Waking worker threads costs more time than these scenes take.
        let mut schedules = app.world_mut().resource_mut::<Schedules>();
        for (_, schedule) in schedules.iter_mut() {
            schedule.set_executor(SingleThreadedExecutor::new());
        }
        // No time passes in the first update, so it makes no step.
        app.update();
        let bodies = fill(app.world_mut());
        let read = if avian { avian::read } else { rapier::read };
        Self { app, bodies, read }
    }

    pub fn tick(&mut self) {
        self.app.update();
    }

    /// State of a body of the problem. NaN if the engine no longer has the body.
    pub fn state(&self, body: usize) -> State {
        (self.read)(self.app.world(), self.bodies[body]).unwrap_or(State {
            position: DVec3::NAN,
            rotation: DQuat::IDENTITY,
            velocity: DVec3::NAN,
            spin: DVec3::NAN,
        })
    }
}
