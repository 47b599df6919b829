#![allow(missing_docs, reason = "criterion writes a public function")]
//! Whole frames with many isolated springs: bodies alone, ours, and Rapier's `SpringJoint`.
//!
//! `cargo bench --bench frame` prints the times of one run; compare them within it, not between machines.

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

/// What joins each pair of bodies.
#[derive(Clone, Copy, Debug)]
enum Link {
    Nothing,
    Ours,
    Joint,
}

/// Pairs of bodies without colliders, weightless and never asleep, oscillating.
fn app(count: u32, link: Link, microsteps: u32) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        CoiloverPlugin::default().with_microsteps(microsteps),
    ))
    .insert_resource(TimestepMode::Fixed {
        dt: 1.0 / 60.0,
        substeps: 1,
    })
    .insert_resource(Time::<Fixed>::from_hz(60.0));
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));
    app.finish();
    app.cleanup();
    app.update();
    let world = app.world_mut();
    let body = |world: &mut World, at: Vec3| {
        world
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(1.0),
                GravityScale(0.0),
                Sleeping::disabled(),
                Transform::from_translation(at),
            ))
            .id()
    };
    for i in 0..count {
        let at = Vec3::new((i % 100) as f32 * 4.0, (i / 100) as f32 * 4.0, 0.0);
        let (a, b) = (body(world, at), body(world, at + Vec3::X * 1.2));
        match link {
            Link::Nothing => {}
            Link::Ours => {
                world.spawn(Spring::new(a, b).with_stiffness(40.0).with_rest_length(1.0));
            }
            Link::Joint => {
                let joint = SpringJointBuilder::new(1.0, 40.0, 0.0);
                world.entity_mut(b).insert(ImpulseJoint::new(a, joint));
            }
        }
    }
    for _ in 0..20 {
        app.update();
    }
    app
}

fn frames(c: &mut Criterion) {
    let mut group = c.benchmark_group("frame");
    group.sample_size(20);
    for count in [1_000, 10_000] {
        group.throughput(Throughput::Elements(u64::from(count)));
        for link in [Link::Nothing, Link::Ours, Link::Joint] {
            let mut app = app(count, link, 1);
            group.bench_function(BenchmarkId::new(format!("{link:?}"), count), |b| {
                b.iter(|| app.update());
            });
            black_box(&app);
        }
    }
    group.finish();
}

fn microsteps(c: &mut Criterion) {
    let mut group = c.benchmark_group("microsteps");
    group.sample_size(20);
    for n in [1, 4, 16] {
        let mut app = app(10_000, Link::Ours, n);
        group.bench_function(BenchmarkId::new("10000 springs", n), |b| {
            b.iter(|| app.update());
        });
    }
    group.finish();
}

criterion_group!(benches, frames, microsteps);
criterion_main!(benches);
