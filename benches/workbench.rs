#![allow(missing_docs, reason = "criterion writes a public function")]
//! Time that the workbench adds to a frame with ten thousand springs.
//!
//! `cargo bench -p benches --features workbench --bench workbench` times frames with the panel closed, open, and open
//! with an element selected. The clock is paused, so frames contain no physics. Nothing is rendered, but the panel is
//! laid out and tessellated.

use bevy::asset::AssetPlugin;
use bevy::camera::RenderTargetInfo;
use bevy::input::InputPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use criterion::{Criterion, criterion_group, criterion_main};

const SPRINGS: u16 = 10_000;
const SIZE: UVec2 = UVec2::new(1280, 1200);

/// Returns an app with weights on springs in rows, a window and a camera, and the first spring.
fn scene() -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        InputPlugin,
        WindowPlugin {
            primary_window: Some(Window {
                resolution: (SIZE.x, SIZE.y).into(),
                ..default()
            }),
            exit_condition: ExitCondition::DontExit,
            ..default()
        },
        AssetPlugin::default(),
    ))
    .init_asset::<Image>()
    .init_asset::<bevy::shader::Shader>()
    .add_plugins((
        CoiloverPlugin::at_hz(60.0),
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        CoiloverWorkbenchPlugin,
    ));
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));
    let projection = PerspectiveProjection {
        aspect_ratio: SIZE.x as f32 / SIZE.y as f32,
        ..default()
    };
    let projection = Projection::Perspective(projection);
    let mut camera = Camera::default();
    camera.computed.clip_from_view = projection.get_clip_from_view();
    camera.computed.target_info = Some(RenderTargetInfo {
        physical_size: SIZE,
        scale_factor: 1.0,
    });
    let world = app.world_mut();
    let eye = Transform::from_xyz(0.0, 1.0, 8.0);
    world.spawn((Camera3d::default(), camera, projection, eye));
    let springs: Vec<_> = (0..SPRINGS)
        .map(|i| {
            let x = 0.1 * f32::from(i);
            let hook = (RigidBody::Fixed, Transform::from_xyz(x, 2.0, 0.0));
            let hook = world.spawn((Name::new("Hook"), hook)).id();
            let weight = (
                Name::new("Weight"),
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(2.0),
                Transform::from_xyz(x, 1.0, 0.0),
            );
            let weight = world.spawn(weight).id();
            let spring = SpringDamper::new(hook, weight)
                .with_stiffness(50.0)
                .with_damping(1.5);
            world
                .spawn((Name::new(format!("Weight spring {i}")), spring))
                .id()
        })
        .collect();
    app.finish();
    app.cleanup();
    (app, springs[0])
}

fn frames(c: &mut Criterion) {
    let (mut app, first) = scene();
    for _ in 0..30 {
        app.update();
    }
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    let mut group = c.benchmark_group(format!("workbench/{SPRINGS} springs"));
    for (name, open, selected) in [
        ("closed", false, None),
        ("open", true, None),
        ("one chosen", true, Some(first)),
    ] {
        let mut workbench = app.world_mut().resource_mut::<CoiloverWorkbench>();
        workbench.open = open;
        workbench.selected = selected;
        // Builds the list, and lays out texts for the first time.
        for _ in 0..60 {
            app.update();
        }
        group.bench_function(name, |b| b.iter(|| app.update()));
    }
    group.finish();
}

criterion_group!(benches, frames);
criterion_main!(benches);
