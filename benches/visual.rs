#![allow(missing_docs, reason = "criterion writes a public function")]
//! What it costs to lay coils between their ends, without rendering: time per frame of the plugin's systems
//! alone.
//!
//! `cargo bench --bench visual` prints the time of a frame and how many coils a second that is.

use bevy::asset::AssetPlugin;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::{Duration, Instant};

const COUNT: u32 = 10_000;

/// An app without renderer, and the ends of its coils.
fn app() -> (App, Vec<Entity>) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), CoiloverVisualPlugin))
        .init_asset::<Mesh>()
        .init_asset::<StandardMaterial>();
    app.edit_schedule(PostUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    app.finish();
    app.cleanup();
    let world = app.world_mut();
    let mut ends = Vec::new();
    for i in 0..COUNT {
        let at = Vec3::new((i % 100) as f32, 0.0, (i / 100) as f32);
        let mut end = |at: Vec3| {
            let place = Transform::from_translation(at);
            world.spawn((place, GlobalTransform::from(place))).id()
        };
        let (a, b) = (end(at), end(at + Vec3::Y));
        ends.extend([a, b]);
        world.spawn((Spring::new(a, b), Coil::default()));
    }
    for _ in 0..3 {
        app.update();
    }
    (app, ends)
}

fn sway(world: &mut World, ends: &[Entity], frame: u32) {
    let turn = Quat::from_rotation_z(0.3 * (0.1 * frame as f32).sin());
    for pair in ends.chunks(2) {
        let Some(foot) = world.get::<GlobalTransform>(pair[0]).copied() else {
            continue;
        };
        if let Some(mut top) = world.get_mut::<GlobalTransform>(pair[1]) {
            *top = GlobalTransform::from_translation(foot.translation() + turn * Vec3::Y * 1.1);
        }
    }
}

fn placement(c: &mut Criterion) {
    let (mut app, ends) = app();
    let mut group = c.benchmark_group("visual");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    let mut frame = 0;
    group.bench_function("place 10000 moving coils", |b| {
        b.iter_custom(|rounds| {
            let mut spent = Duration::ZERO;
            for _ in 0..rounds {
                frame += 1;
                sway(app.world_mut(), &ends, frame);
                let begun = Instant::now();
                app.world_mut().run_schedule(PostUpdate);
                spent += begun.elapsed();
            }
            spent
        });
    });
    group.bench_function("place 10000 resting coils", |b| {
        b.iter(|| app.world_mut().run_schedule(PostUpdate));
    });
    group.finish();
    black_box(&app);
}

criterion_group!(benches, placement);
criterion_main!(benches);
