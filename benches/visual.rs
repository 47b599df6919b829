#![allow(missing_docs, reason = "criterion writes a public function")]
//! Time to lay coils between their ends, without rendering and on one thread. It times only the plugin's systems, in
//! a `PostUpdate` without anything else. "Bevy alone" is the time of that schedule without the plugin.
//!
//! `cargo bench -p benches --bench visual` prints the time of a frame and the coils per second.

use bevy::asset::AssetPlugin;
use bevy::camera::primitives::Frustum;
use bevy::camera::{Camera, ComputedCameraValues, Projection, RenderTargetInfo};
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use std::time::{Duration, Instant};

const COUNT: u32 = 10_000;

/// The camera that looks at the coils.
#[derive(Clone, Copy)]
enum Onlooker {
    /// No camera, as on a server: every coil is laid in every frame, as if it were visible.
    None,
    /// A camera that sees every coil.
    SeesAll,
    /// A camera that sees none.
    SeesNothing,
}

/// Adds the look of an element.
type Looks = fn(&mut EntityWorldMut);

fn coil(element: &mut EntityWorldMut) {
    element.insert(Coil::default());
}

fn coilover(element: &mut EntityWorldMut) {
    element.insert((Coil::default(), Telescope::default()));
}

/// An app without renderer, with the ends of its coils.
struct Scene {
    app: App,
    ends: Vec<Entity>,
    frame: u32,
}

impl Scene {
    fn new(camera: Onlooker, with_plugin: bool, looks: Looks) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default()))
            .init_asset::<Mesh>()
            .init_asset::<StandardMaterial>();
        if with_plugin {
            app.add_plugins(CoiloverVisualPlugin);
        }
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
            looks(&mut world.spawn(Spring::new(a, b)));
        }
        let to = match camera {
            Onlooker::None => None,
            Onlooker::SeesAll => Some(Vec3::new(50.0, 0.0, 50.0)),
            Onlooker::SeesNothing => Some(Vec3::new(50.0, 400.0, 50.0)),
        };
        if let Some(to) = to {
            look(world, Vec3::new(50.0, 200.0, 51.0), to);
        }
        for _ in 0..3 {
            app.update();
        }
        let frame = 0;
        Self { app, ends, frame }
    }

    /// Rotates every end A, and swings and stretches every element.
    fn sway(&mut self) {
        self.frame += 1;
        let phase = (0.1 * self.frame as f32).sin();
        let turn = Quat::from_rotation_z(0.3 * phase);
        let spin = Quat::from_rotation_y(0.2 * phase);
        let up = turn * Vec3::Y * (1.1 + 0.1 * phase);
        let world = self.app.world_mut();
        for pair in self.ends.chunks(2) {
            let Some(mut foot) = world.get_mut::<GlobalTransform>(pair[0]) else {
                continue;
            };
            let at = foot.translation();
            *foot = Transform::from_translation(at).with_rotation(spin).into();
            if let Some(mut top) = world.get_mut::<GlobalTransform>(pair[1]) {
                *top = GlobalTransform::from_translation(at + up);
            }
        }
    }

    /// Returns the time of this number of frames.
    fn spent(&mut self, frames: u64, moving: bool) -> Duration {
        let mut spent = Duration::ZERO;
        for _ in 0..frames {
            if moving {
                self.sway();
            }
            let begun = Instant::now();
            self.app.world_mut().run_schedule(PostUpdate);
            spent += begun.elapsed();
        }
        spent
    }
}

/// Spawns a camera as the renderer would prepare it.
fn look(world: &mut World, from: Vec3, to: Vec3) {
    let projection = Projection::from(PerspectiveProjection {
        aspect_ratio: 16.0 / 9.0,
        ..default()
    });
    let at = GlobalTransform::from(Transform::from_translation(from).looking_at(to, Vec3::Z));
    let camera = Camera {
        computed: ComputedCameraValues {
            clip_from_view: projection.get_clip_from_view(),
            target_info: Some(RenderTargetInfo {
                physical_size: UVec2::new(1920, 1080),
                scale_factor: 1.0,
            }),
            ..default()
        },
        ..default()
    };
    let frustum: Frustum = projection.compute_frustum(&at);
    world.spawn((camera, projection, frustum, at));
}

fn placement(c: &mut Criterion) {
    let mut group = c.benchmark_group("visual");
    group.throughput(Throughput::Elements(u64::from(COUNT)));
    let mut time = |name: &str, scene: Scene, moving| case(&mut group, name, scene, moving);
    let cameras = [
        ("without camera", Onlooker::None),
        ("all in sight", Onlooker::SeesAll),
        ("all out of sight", Onlooker::SeesNothing),
    ];
    for (sight, camera) in cameras {
        for (motion, moving) in [("moving", true), ("resting", false)] {
            let name = format!("place 10000 {motion} coils {sight}");
            time(&name, Scene::new(camera, true, coil), moving);
        }
    }
    let coilovers = Scene::new(Onlooker::SeesAll, true, coilover);
    time("place 10000 moving coilovers all in sight", coilovers, true);
    let bare = Scene::new(Onlooker::SeesAll, false, coil);
    time("Bevy alone", bare, true);
    group.finish();
}

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

fn case(group: &mut Group, name: &str, mut scene: Scene, moving: bool) {
    group.bench_function(name, |b| {
        b.iter_custom(|frames| scene.spent(frames, moving));
    });
}

criterion_group!(benches, placement);
criterion_main!(benches);
