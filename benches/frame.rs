#![allow(missing_docs, reason = "criterion writes a public function")]
//! Time of whole frames, and the part of it spent in our own systems.
//!
//! `cargo bench -p benches --bench frame` prints the times of one run. Compare them within that run, not between
//! machines. `frame` times whole frames: free bodies, our springs, and Rapier's `SpringJoint` on the same bodies.
//! `own` times our systems only.

use benches::{Link, Own, Scene};
use bevy::app::App;
use bevy::ecs::world::World;
use bevy_coilover::prelude::CoiloverPlugin;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;

/// A change to the world before a frame.
type Change = fn(&mut World);

/// An app that is created when a benchmark first needs it, so that a filtered-out benchmark costs nothing.
struct Lazy<F>(Option<App>, F);

impl<F: Fn() -> App> Lazy<F> {
    fn new(make: F) -> Self {
        Self(None, make)
    }

    fn app(&mut self) -> &mut App {
        self.0.get_or_insert_with(&self.1)
    }

    /// Returns the time in our systems over this number of frames, each after a change.
    fn own(&mut self, frames: u64, change: Change) -> Duration {
        let app = self.app();
        app.world_mut().resource_mut::<Own>().0 = Duration::ZERO;
        for _ in 0..frames {
            change(app.world_mut());
            app.update();
        }
        app.world().resource::<Own>().0
    }
}

fn frames(c: &mut Criterion) {
    let links = [Link::Nothing, Link::Bare, Link::Ours, Link::Joint];
    whole(
        c,
        "frame",
        Scene::Isolated,
        &[1_000, 10_000, 100_000],
        &links,
    );
    let links = [Link::Nothing, Link::Ours, Link::Joint];
    whole(c, "frame/flying cars", Scene::Cars, &[1_000], &links);
}

/// Times whole frames of a scene with these numbers of springs.
fn whole(c: &mut Criterion, name: &str, scene: Scene, counts: &[u32], links: &[Link]) {
    let mut group = c.benchmark_group(name);
    group.sample_size(10);
    for count in counts.iter().copied() {
        group.throughput(Throughput::Elements(u64::from(count)));
        for link in links.iter().copied() {
            let mut lazy = Lazy::new(|| scene.app(count, link));
            group.bench_function(BenchmarkId::new(format!("{link:?}"), count), |b| {
                let app = lazy.app();
                b.iter(|| app.update());
            });
        }
    }
    group.finish();
}

/// Times cars on a road, held by contacts and joints: whole frames, and our own systems.
fn road(c: &mut Criterion) {
    for (name, scene, count) in [
        ("rolling", Scene::Rolling, 100),
        ("parked", Scene::Parked, 1_000),
    ] {
        let mut group = c.benchmark_group(format!("road/{name}"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(u64::from(count)));
        for link in [Link::Ours, Link::Joint] {
            let mut lazy = Lazy::new(|| scene.app(count, link));
            group.bench_function(BenchmarkId::new(format!("{link:?}"), count), |b| {
                let app = lazy.app();
                b.iter(|| app.update());
            });
        }
        let mut lazy = Lazy::new(|| scene.clocked(count, Link::Ours, CoiloverPlugin::default()));
        group.bench_function(BenchmarkId::new("own", count), |b| {
            b.iter_custom(|frames| lazy.own(frames, |_| {}));
        });
        group.finish();
    }
}

fn isolated(c: &mut Criterion) {
    let mut group = c.benchmark_group("own/isolated");
    group.sample_size(10);
    let mut bench = |name: &str, scene: Scene, link: Link, count: u32, plugin: CoiloverPlugin| {
        let mut lazy = Lazy::new(|| scene.clocked(count, link, plugin));
        group.throughput(Throughput::Elements(u64::from(count)));
        group.bench_function(BenchmarkId::new(name, count), |b| {
            b.iter_custom(|frames| lazy.own(frames, |_| {}));
        });
    };
    let plugin = CoiloverPlugin::default;
    for count in [1, 10, 100, 1_000, 10_000, 100_000] {
        bench("awake", Scene::Isolated, Link::Ours, count, plugin());
    }
    bench("asleep", Scene::Asleep, Link::Ours, 10_000, plugin());
    let beside = "asleep, another body flies";
    bench(beside, Scene::AllButOne, Link::Ours, 10_000, plugin());
    for count in [10_000, 100_000] {
        bench("bare force", Scene::Isolated, Link::Bare, count, plugin());
    }
    bench("with laws", Scene::Isolated, Link::Laws, 10_000, plugin());
    bench("turning", Scene::Isolated, Link::Turning, 1_000, plugin());
    // By default the plugin looks whether a spring needs more micro-steps. "1" is without that look.
    for count in [1, 4, 16] {
        let (name, fixed) = (
            format!("{count} microsteps"),
            plugin().with_microsteps(count),
        );
        bench(&name, Scene::Isolated, Link::Ours, 10_000, fixed);
    }
    group.finish();
}

fn networks(c: &mut Criterion) {
    let sizes = [1_000, 5_000, 10_000, 50_000, 100_000];
    for (scene, sizes) in [
        // A longer chain reaches so far from the origin that the engine's f32 makes it shake.
        (Scene::Chain, &sizes[..4]),
        (Scene::Lattice, &sizes),
        (Scene::Cloth, &sizes),
        (Scene::Bridge, &sizes),
        (Scene::Cars, &sizes[..1]),
    ] {
        let mut group = c.benchmark_group(format!("own/{scene:?}"));
        group.sample_size(10);
        for count in sizes.iter().copied() {
            let mut lazy =
                Lazy::new(|| scene.clocked(count, Link::Ours, CoiloverPlugin::default()));
            let springs = scene.springs(count);
            group.throughput(Throughput::Elements(u64::from(springs)));
            group.bench_function(BenchmarkId::from_parameter(springs), |b| {
                b.iter_custom(|frames| lazy.own(frames, |_| {}));
            });
        }
        group.finish();
    }
}

/// Times spawning and despawning in every frame.
fn churn(c: &mut Criterion) {
    let mut group = c.benchmark_group("own/churn");
    group.sample_size(10);
    let count = 10_000;
    let cases: [(&str, Change); 3] = [
        ("nothing", |_| {}),
        ("a body without spring", benches::shoot),
        ("a spring", benches::respring),
    ];
    for (name, change) in cases {
        let mut lazy =
            Lazy::new(|| Scene::Isolated.clocked(count, Link::Ours, CoiloverPlugin::default()));
        group.throughput(Throughput::Elements(u64::from(count)));
        group.bench_function(BenchmarkId::new(name, count), |b| {
            b.iter_custom(|frames| lazy.own(frames, change));
        });
    }
    group.finish();
}

criterion_group!(benches, frames, road, isolated, networks, churn);
criterion_main!(benches);
