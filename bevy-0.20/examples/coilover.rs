//! Renders a picture with Bevy 0.20, without a window: a weight on a coilover, two seconds after its release.
//!
//! `cargo run --example coilover -- FILE.png`

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::image::Image;
use bevy::prelude::*;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Duration of the scene before the picture, s.
const BEFORE: f64 = 2.0;
/// Longest wait for the picture, s.
const PATIENCE: u64 = 240;

fn main() -> AppExit {
    let Some(file) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("coilover FILE.png");
        return AppExit::error();
    };
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        }),
        ScheduleRunnerPlugin::default(),
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        CoiloverPlugins::at_hz(60.0),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 60.0,
    )));
    let mut image = Image::new_target_texture(960, 720, TextureFormat::Rgba8UnormSrgb, None);
    image.asset_usage = RenderAssetUsages::default();
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let target = RenderTarget::Image(image.clone().into());
    app.add_systems(Startup, move |mut commands: Commands| {
        commands.spawn((
            Camera3d::default(),
            Transform::from_xyz(0.45, 0.85, 1.6).looking_at(Vec3::Y * 0.47, Vec3::Y),
            target.clone(),
        ));
    })
    .add_systems(Startup, setup);
    app.finish();
    app.cleanup();
    for _ in 0..(60.0 * BEFORE) as usize {
        app.update();
    }
    take(&mut app, &image, &file)
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(3.0, 7.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let mut solid = |size: Vec3, color: Color| {
        (
            Mesh3d(meshes.add(Cuboid::from_size(size))),
            MeshMaterial3d(materials.add(color)),
        )
    };
    let foot = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, 0.1, 0.0),
            solid(Vec3::new(0.3, 0.2, 0.3), Color::srgb(0.2, 0.2, 0.22)),
        ))
        .id();
    let car = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(350.0),
            LockedAxes::ROTATION_LOCKED,
            Transform::from_xyz(0.0, 0.96, 0.0),
            solid(Vec3::new(0.5, 0.12, 0.4), Color::srgb(0.16, 0.3, 0.44)),
        ))
        .id();
    commands.spawn(coilover(foot, car)).insert((
        SpringDamper::new(foot, car)
            .with_stiffness(30e3)
            .with_damping(2_500.0)
            .with_rest_length(0.62),
        Anchors::new(Vec3::Y * 0.1, Vec3::NEG_Y * 0.06),
    ));
}

/// Updates until the picture is on disk.
fn take(app: &mut App, image: &Handle<Image>, file: &Path) -> AppExit {
    let _ = std::fs::remove_file(file);
    // Shaders are compiled in the background, so some frames pass first.
    for _ in 0..60 {
        app.update();
    }
    app.world_mut()
        .spawn(Screenshot::image(image.clone()))
        .observe(save_to_disk(file.to_owned()));
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(PATIENCE) {
        app.update();
        if file.metadata().is_ok_and(|file| file.len() > 0) {
            println!("{}", file.display());
            return AppExit::Success;
        }
    }
    eprintln!("no picture within {PATIENCE} s");
    AppExit::error()
}
