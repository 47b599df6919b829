#![allow(missing_docs, reason = "criterion writes a public function")]
//! Time and size of a snapshot.
//!
//! `cargo bench -p benches --bench snapshot` prints bytes for each spring, and the times to take a snapshot and to
//! restore it, for our side and for Rapier's, for several numbers of springs.

use benches::{Link, Scene};
use bevy_coilover::{CoiloverSnapshot, RapierSnapshot};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

fn snapshots(c: &mut Criterion) {
    let scenes = [
        (Scene::Isolated, 1_000),
        (Scene::Isolated, 10_000),
        (Scene::Lattice, 1_000),
        (Scene::Rolling, 250),
    ];
    for (scene, count) in scenes {
        let mut app = scene.app(count, Link::Ours);
        for _ in 0..60 {
            app.update();
        }
        let springs = scene.springs(count);
        let mut group = c.benchmark_group(format!("snapshot/{scene:?}"));
        group.sample_size(20);
        group.throughput(Throughput::Elements(u64::from(springs)));
        let kept = CoiloverSnapshot::take(app.world());
        let each = kept.bytes() / springs.max(1) as usize;
        println!("snapshot/{scene:?}: {springs} springs, {each} bytes for each");
        // One that does not fit would be restored very fast.
        assert_eq!(kept.restore(app.world_mut()), Ok(()));
        group.bench_function(BenchmarkId::new("take", springs), |b| {
            b.iter(|| black_box(CoiloverSnapshot::take(app.world())));
        });
        group.bench_function(BenchmarkId::new("restore", springs), |b| {
            b.iter(|| black_box(kept.restore(app.world_mut())));
        });
        group.bench_function(BenchmarkId::new("clone", springs), |b| {
            b.iter(|| black_box(kept.clone()));
        });
        let kept = RapierSnapshot::take(app.world());
        assert_eq!(kept.restore(app.world_mut()), Ok(()));
        group.bench_function(BenchmarkId::new("take of Rapier", springs), |b| {
            b.iter(|| black_box(RapierSnapshot::take(app.world())));
        });
        group.bench_function(BenchmarkId::new("restore of Rapier", springs), |b| {
            b.iter(|| black_box(kept.restore(app.world_mut())));
        });
        group.bench_function(BenchmarkId::new("frame", springs), |b| {
            b.iter(|| app.update());
        });
        group.finish();
    }
}

criterion_group!(benches, snapshots);
criterion_main!(benches);
