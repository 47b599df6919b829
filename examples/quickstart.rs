//! The shortest useful program: a ball on a coilover, in a window.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

fn main() {
    App::new()
        .add_plugins((
            DefaultPlugins,
            CoiloverPlugins::at_hz(60.0),
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
        ))
        .add_systems(Startup, setup)
        .run();
}

fn setup(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    commands.spawn((Camera3d::default(), Transform::from_xyz(0.0, 0.0, 5.0)));
    commands.spawn((
        DirectionalLight::default(),
        Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::ZERO, Vec3::Y),
    ));
    let hook = commands.spawn(Transform::from_xyz(0.0, 1.5, 0.0)).id();
    let ball = commands
        .spawn((
            RigidBody::Dynamic,
            Collider::ball(0.3),
            ColliderMassProperties::Mass(20.0),
            Transform::from_xyz(0.4, 0.3, 0.0),
            Mesh3d(meshes.add(Sphere::new(0.3))),
            MeshMaterial3d(materials.add(Color::srgb(0.8, 0.3, 0.2))),
        ))
        .id();
    commands.spawn(coilover(hook, ball));
}
