//! Headless app with the real Rapier pipeline. Tests step it tick by tick.

use crate::compat::begin;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::transform::StaticTransformOptimizations;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::time::Duration;

pub const DT: f32 = 1.0 / 60.0;
pub const GRAVITY: f64 = 9.81;

/// App in which every `tick` is one engine step.
pub struct Lab {
    pub app: App,
}

/// Settings of the engine that a test can change.
#[derive(Clone, Copy)]
pub struct Engine {
    pub dt: f32,
    pub iterations: usize,
    pub substeps: usize,
    pub gravity: Vec3,
}

impl Default for Engine {
    fn default() -> Self {
        Self {
            dt: DT,
            iterations: 4,
            substeps: 1,
            gravity: Vec3::NEG_Y * GRAVITY as f32,
        }
    }
}

impl Engine {
    pub fn weightless() -> Self {
        Self {
            gravity: Vec3::ZERO,
            ..default()
        }
    }
}

impl Lab {
    pub fn new() -> Self {
        Self::with(CoiloverPlugin::default(), Engine::default())
    }

    pub fn weightless() -> Self {
        Self::with(CoiloverPlugin::default(), Engine::weightless())
    }

    pub fn with(plugin: CoiloverPlugin, engine: Engine) -> Self {
        let mut lab = Self::without_plugin(engine);
        lab.app.add_plugins(plugin);
        lab.prime();
        lab
    }

    /// Engine without the coilover plugin. Call [`prime`](Self::prime) after adding further plugins.
    pub fn without_plugin(engine: Engine) -> Self {
        let mut app = App::new();
        let mut rapier = RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule();
        let parameters = bevy_rapier3d::rapier::dynamics::IntegrationParameters {
            num_solver_iterations: engine.iterations,
            ..default()
        };
        rapier = rapier.with_custom_initialization(begin(parameters, engine.gravity));
        let tick = Duration::from_secs_f32(engine.dt);
        app.add_plugins((MinimalPlugins, TransformPlugin))
            .insert_resource(TimestepMode::Fixed {
                dt: engine.dt,
                substeps: engine.substeps,
            })
            .insert_resource(Time::<Fixed>::from_duration(tick))
            .insert_resource(TimeUpdateStrategy::ManualDuration(tick))
            // Looking for what rests takes three threads in every update: a quarter of the time of all these tests.
            .insert_resource(StaticTransformOptimizations::Disabled)
            .add_plugins(rapier);
        Self { app }
    }

    /// Runs the start-up schedules. No time passes in the first update, so it runs no tick.
    pub fn prime(&mut self) {
        self.app.finish();
        self.app.cleanup();
        single_threaded(&mut self.app);
        self.app.update();
    }

    /// Runs one tick. No number of a body may become infinite or NaN in it: comparisons with NaN are false, so many a test
    /// would not notice.
    pub fn tick(&mut self) {
        let before = self.wild();
        self.app.update();
        let after = self.wild();
        let new: Vec<_> = after.difference(&before).collect();
        assert!(new.is_empty(), "not finite any more: {new:?}");
    }

    /// Bodies with a position, rotation or velocity that is not finite.
    fn wild(&mut self) -> EntityHashSet {
        let world = self.app.world_mut();
        let mut bodies =
            world.query_filtered::<(Entity, &Transform, Option<&Velocity>), With<RigidBody>>();
        let is_wild = |(_, at, velocity): &(Entity, &Transform, Option<&Velocity>)| {
            let moves = velocity.is_none_or(|v| v.linear.is_finite() && v.angular.is_finite());
            !(at.translation.is_finite() && at.rotation.is_finite() && moves)
        };
        let wild = bodies.iter(world).filter(is_wild);
        wild.map(|(body, ..)| body).collect()
    }

    pub fn run(&mut self, seconds: f64) {
        for _ in 0..self.ticks(seconds) {
            self.tick();
        }
    }

    /// Switches the physics step of all worlds on or off.
    pub fn set_stepping(&mut self, active: bool) {
        let world = self.app.world_mut();
        let mut engines = world.query::<&mut RapierConfiguration>();
        for mut engine in engines.iter_mut(world) {
            engine.physics_pipeline_active = active;
        }
    }

    pub fn dt(&self) -> f64 {
        match *self.app.world().resource::<TimestepMode>() {
            TimestepMode::Fixed { dt, .. } => f64::from(dt),
            _ => f64::from(DT),
        }
    }

    pub fn ticks(&self, seconds: f64) -> usize {
        (seconds / self.dt()).round() as usize
    }

    pub fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.app.world_mut().spawn(bundle).id()
    }

    /// Spawns a body without collider; see [`body`].
    pub fn body(&mut self, mass: f32, at: Vec3) -> Entity {
        self.spawn(body(mass, at))
    }

    /// Spawns a body with an initial velocity.
    pub fn moving(&mut self, body: impl Bundle, velocity: Velocity) -> Entity {
        let entity = self.spawn(body);
        self.app.world_mut().entity_mut(entity).insert(velocity);
        entity
    }

    /// Spawns an entity without a body, for elements to attach to.
    pub fn point(&mut self, at: Vec3) -> Entity {
        self.spawn(Transform::from_translation(at))
    }

    pub fn position(&self, entity: Entity) -> Vec3 {
        self.get::<Transform>(entity).translation
    }

    pub fn velocity(&self, entity: Entity) -> Vec3 {
        self.get::<Velocity>(entity).linear
    }

    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        self.app
            .world()
            .get::<C>(entity)
            .expect("the component is there")
    }

    pub fn get_mut<C: Component<Mutability = bevy::ecs::component::Mutable>>(
        &mut self,
        entity: Entity,
    ) -> Mut<'_, C> {
        self.app
            .world_mut()
            .get_mut::<C>(entity)
            .expect("the component is there")
    }

    pub fn readout(&self, element: Entity) -> SpringReadout {
        *self.get::<SpringReadout>(element)
    }

    pub fn is_sleeping(&self, entity: Entity) -> bool {
        self.get::<Sleeping>(entity).sleeping
    }
}

/// Makes all schedules single-threaded. Waking worker threads costs ten times as much as the small systems of a
/// lab. The messages of the crate also arrive on the test's own thread then.
pub fn single_threaded(app: &mut App) {
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
}

/// Dynamic body without collider. Mass in kg; each principal moment of inertia is 0.4 kg m² per kg.
pub fn body(mass: f32, at: Vec3) -> impl Bundle {
    brick(mass, Vec3::splat(0.4 * mass), at)
}

/// Dynamic body without collider. Mass in kg, principal moments of inertia in kg m².
pub fn brick(mass: f32, inertia: Vec3, at: Vec3) -> impl Bundle {
    (
        RigidBody::Dynamic,
        Transform::from_translation(at),
        AdditionalMassProperties::MassProperties(MassProperties {
            mass,
            principal_inertia: inertia,
            ..default()
        }),
        Velocity::default(),
        Sleeping::default(),
    )
}

/// Rows of a reference file in `tests/data`, one every 1/240 s. The first column is the time in s.
pub fn reference(text: &str) -> Vec<Vec<f64>> {
    text.lines()
        .skip(2)
        .map(|line| {
            line.split(',')
                .map(|x| x.parse().expect("a number"))
                .collect()
        })
        .collect()
}

impl Lab {
    /// Applies an external force of the user, N, to a body.
    pub fn spawn_force(&mut self, body: Entity, force: Vec3) {
        self.app
            .world_mut()
            .entity_mut(body)
            .insert(ExternalForce { force, ..default() });
    }
}
