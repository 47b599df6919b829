//! Does a step allocate memory after the scene has been read once? Every allocation of the process is counted
//! while the crate's systems run.

use bevy::app::TaskPoolOptions;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::time::Duration;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Allocations and reallocations at the start of the crate's systems, and within the systems so far.
#[derive(Resource, Default)]
struct Count {
    before: usize,
    within: usize,
}

fn allocations() -> usize {
    let stats = GLOBAL.stats();
    stats.allocations + stats.reallocations
}

fn begin(mut count: ResMut<Count>) {
    count.before = allocations();
}

fn end(mut count: ResMut<Count>) {
    count.within += allocations() - count.before;
}

/// An app on one thread, so that only the crate's systems run between `begin` and `end`.
fn app() -> App {
    let tick = Duration::from_secs_f32(1.0 / 60.0);
    let mut app = App::new();
    // One thread only: sharing work among threads takes a little memory.
    let one = TaskPoolPlugin {
        task_pool_options: TaskPoolOptions::with_num_threads(1),
    };
    app.add_plugins((
        MinimalPlugins.set(one),
        TransformPlugin,
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        CoiloverPlugin::default(),
    ))
    .insert_resource(TimestepMode::Fixed {
        dt: tick.as_secs_f32(),
        substeps: 1,
    })
    .insert_resource(Time::<Fixed>::from_duration(tick))
    .insert_resource(TimeUpdateStrategy::ManualDuration(tick))
    .init_resource::<Count>()
    .add_systems(
        FixedUpdate,
        (
            begin
                .after(PhysicsSet::SyncBackend)
                .before(CoiloverSystems::Prepare),
            end.after(CoiloverSystems::Solve)
                .before(PhysicsSet::StepSimulation),
            begin
                .after(PhysicsSet::Writeback)
                .before(CoiloverSystems::Readout),
            end.after(CoiloverSystems::Readout),
        ),
    );
    app.edit_schedule(FixedUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.finish();
    app.cleanup();
    app.update();
    app
}

fn body(world: &mut World, at: Vec3) -> Entity {
    world
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::MassProperties(MassProperties {
                mass: 1.0,
                principal_inertia: Vec3::new(0.1, 0.2, 0.15),
                ..default()
            }),
            Transform::from_translation(at),
        ))
        .id()
}

/// A chain of `count` springs, hung at one end.
fn chain(world: &mut World, at: Vec3, count: usize, arm: Vec3) {
    let mut last = world.spawn(Transform::from_translation(at)).id();
    for i in 1..=count {
        let next = body(world, at + Vec3::X * 1.1 * i as f32);
        world.spawn((
            SpringDamper::new(last, next)
                .with_stiffness(200.0)
                .with_damping(1.0)
                .with_rest_length(1.0),
            Anchors::new(Vec3::ZERO, arm),
        ));
        last = next;
    }
}

/// One test for everything, because the allocations of all threads are counted.
#[test]
fn a_warm_step_allocates_nothing() {
    let mut app = app();
    let world = app.world_mut();
    for i in 0..20 {
        // Lone springs, without and with rotation of the body.
        chain(world, Vec3::Z * 3.0 * i as f32, 1, Vec3::ZERO);
        chain(
            world,
            Vec3::new(-9.0, 0.0, 3.0 * i as f32),
            1,
            Vec3::Y * 0.3,
        );
    }
    chain(world, Vec3::Y * 20.0, 8, Vec3::ZERO);
    chain(world, Vec3::Y * 30.0, 8, Vec3::Y * 0.2);
    chain(world, Vec3::Y * 40.0, 150, Vec3::ZERO);
    for _ in 0..30 {
        app.update();
    }
    app.world_mut().resource_mut::<Count>().within = 0;
    for _ in 0..30 {
        app.update();
    }
    let within = app.world().resource::<Count>().within;
    assert_eq!(within, 0, "allocations in 30 steps");
    // Check that the counter works: a new network must allocate.
    let world = app.world_mut();
    chain(world, Vec3::Y * 50.0, 2, Vec3::ZERO);
    app.update();
    assert!(app.world().resource::<Count>().within > 0);
}
