//! The workbench with a few springs below a shaking beam. Select a spring in the list or click it, drag its numbers,
//! and look at its curves. F9 closes and opens the panel.
//!
//! `cargo run --features workbench --example workbench`

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

/// Amplitude of the beam, m.
const AMPLITUDE: f32 = 0.05;
/// Frequency of the beam, Hz.
const FREQUENCY: f32 = 0.7;
/// Height of the beam, m.
const HEIGHT: f32 = 2.0;

#[derive(Component)]
struct Beam;

fn main() {
    App::new()
        .add_plugins((
            DefaultPlugins.set(WindowPlugin {
                primary_window: Some(Window {
                    title: "workbench".into(),
                    resolution: (1280, 720).into(),
                    ..default()
                }),
                ..default()
            }),
            CoiloverPlugins::at_hz(60.0),
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
            CoiloverWorkbenchPlugin,
        ))
        .insert_resource(CoiloverWorkbench {
            open: true,
            ..default()
        })
        .insert_resource(ClearColor(Color::srgb(0.12, 0.14, 0.17)))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, shake.before(PhysicsSet::SyncBackend))
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    // The springs are visible between the panels.
    let eye = Transform::from_xyz(0.15, 1.0, 6.5).looking_at(Vec3::new(0.15, 0.45, 0.0), Vec3::Y);
    commands.spawn((Camera3d::default(), eye));
    let light = Transform::from_xyz(2.0, 4.0, 5.0).looking_at(Vec3::ZERO, Vec3::Y);
    commands.spawn((DirectionalLight::default(), light));
    let iron = materials.add(Color::srgb(0.45, 0.48, 0.52));
    let beam = commands
        .spawn((
            Name::new("Beam"),
            Beam,
            RigidBody::KinematicPositionBased,
            Transform::from_xyz(0.0, HEIGHT, 0.0),
            Mesh3d(meshes.add(Cuboid::new(3.4, 0.1, 0.3))),
            MeshMaterial3d(iron),
        ))
        .id();
    let cube = meshes.add(Cuboid::from_length(0.36));
    let mut load = |x: f32, y: f32, mass: f32, name: &'static str, color: Color| {
        let body = (
            Name::new(name),
            RigidBody::Dynamic,
            Collider::cuboid(0.18, 0.18, 0.18),
            ColliderMassProperties::Mass(mass),
            Transform::from_xyz(x, y, 0.0),
            Mesh3d(cube.clone()),
            MeshMaterial3d(materials.add(color)),
        );
        let anchors = Anchors::new(Vec3::new(x, -0.05, 0.0), 0.18 * Vec3::Y);
        (commands.spawn(body).id(), anchors)
    };
    let lamp = load(-1.35, 0.6, 2.0, "Lamp", Color::srgb(0.9, 0.6, 0.2));
    let chest = load(-0.45, 0.7, 5.0, "Chest", Color::srgb(0.3, 0.6, 0.9));
    let bell = load(0.45, 0.9, 3.0, "Bell", Color::srgb(0.5, 0.8, 0.4));
    let safe = load(1.35, 0.5, 20.0, "Safe", Color::srgb(0.8, 0.35, 0.35));

    let coil = Coil::default();
    commands.spawn((
        Name::new("Soft spring"),
        SpringDamper::new(beam, lamp.0)
            .with_stiffness(80.0)
            .with_damping(1.5),
        lamp.1,
        HoldPose::of_b(),
        coil,
    ));
    commands.spawn((
        Name::new("Shock absorber"),
        SpringDamper::new(beam, chest.0)
            .with_stiffness(300.0)
            .with_damping(20.0),
        SpringLaw::polynomial(250.0, 0.0, 9_000.0),
        DampingLaw::sided(12.0, 40.0),
        chest.1,
        HoldPose::of_b(),
        coil,
    ));
    commands.spawn((
        Name::new("Bungee"),
        SpringDamper::new(beam, bell.0)
            .with_stiffness(120.0)
            .with_damping(2.0)
            .with_rest_length(0.7),
        SpringAction::Pull,
        bell.1,
        coil,
    ));
    commands.spawn((
        Name::new("Too stiff"),
        Spring::new(beam, safe.0)
            .with_stiffness(2e6)
            .with_rest_length(1.3),
        safe.1,
        coil,
    ));
}

fn shake(time: Res<Time>, mut beams: Query<&mut Transform, With<Beam>>) {
    for mut beam in &mut beams {
        beam.translation.y = HEIGHT + AMPLITUDE * (TAU * FREQUENCY * time.elapsed_secs()).sin();
    }
}
