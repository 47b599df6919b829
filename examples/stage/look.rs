//! Light, ground, camera, and simple solids for bodies.

use super::again::Stays;
use super::strip::strip_mesh;
use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::CascadeShadowConfigBuilder;
use bevy::prelude::*;
use bevy::render::render_resource::Face;

/// The look of a body. Ignored where nothing is drawn.
#[derive(Component, Clone, Copy)]
#[require(Visibility)]
pub enum Shape {
    Cuboid(Vec3, Paint),
    Ball(f32, Paint),
    /// Radius and height, about Y.
    Cylinder(f32, f32, Paint),
    /// Radius, and height without the round ends, about Y.
    Capsule(f32, f32, Paint),
    /// Height over x, length along x, and width, as in [`super::strip`].
    Strip(fn(f32) -> f32, f32, f32, Paint),
}

impl Shape {
    /// Returns half the size of the bounding box, m.
    pub fn half_size(&self) -> Vec3 {
        match *self {
            Shape::Cuboid(size, _) => 0.5 * size,
            Shape::Ball(radius, _) => Vec3::splat(radius),
            Shape::Cylinder(radius, height, _) => Vec3::new(radius, 0.5 * height, radius),
            Shape::Capsule(radius, height, _) => Vec3::new(radius, 0.5 * height + radius, radius),
            // A hand cannot pick it.
            Shape::Strip(..) => Vec3::ZERO,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub enum Paint {
    Iron,
    Ivory,
    Blue,
    Floor,
    Grass,
    Asphalt,
    Sand,
    Red,
    Wood,
    Hemp,
    Water,
    /// Visible from both sides.
    Cloth,
    /// Translucent.
    Jelly,
}

impl Paint {
    pub(super) fn material(self) -> StandardMaterial {
        let (color, roughness, metallic) = match self {
            Paint::Iron => (Color::srgb(0.16, 0.17, 0.19), 0.5, 0.3),
            Paint::Ivory => (Color::srgb(0.86, 0.83, 0.76), 0.6, 0.0),
            Paint::Blue => (Color::srgb(0.16, 0.30, 0.44), 0.5, 0.1),
            Paint::Floor => (Color::srgb(0.36, 0.38, 0.40), 0.95, 0.0),
            Paint::Grass => (Color::srgb(0.33, 0.41, 0.29), 1.0, 0.0),
            Paint::Asphalt => (Color::srgb(0.25, 0.26, 0.28), 0.95, 0.0),
            Paint::Sand => (Color::srgb(0.55, 0.51, 0.44), 0.95, 0.0),
            Paint::Red => (Color::srgb(0.62, 0.15, 0.12), 0.6, 0.0),
            Paint::Wood => (Color::srgb(0.46, 0.31, 0.18), 0.85, 0.0),
            Paint::Hemp => (Color::srgb(0.62, 0.52, 0.36), 0.95, 0.0),
            Paint::Water => (Color::srgb(0.20, 0.34, 0.40), 0.25, 0.0),
            Paint::Cloth => (Color::srgb(0.66, 0.13, 0.11), 0.9, 0.0),
            Paint::Jelly => (Color::srgba(0.35, 0.68, 0.22, 0.6), 0.25, 0.0),
        };
        let both_sides = matches!(self, Paint::Cloth);
        StandardMaterial {
            base_color: color,
            perceptual_roughness: roughness,
            metallic,
            double_sided: both_sides,
            cull_mode: if both_sides { None } else { Some(Face::Back) },
            alpha_mode: if color.alpha() < 1.0 {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            },
            ..default()
        }
    }
}

/// Returns a wide visible floor with its top at y = 0. Add a collider if it must carry anything.
pub fn floor() -> impl Bundle {
    (
        Transform::from_xyz(0.0, -0.05, 0.0),
        Shape::Cuboid(Vec3::new(40.0, 0.1, 40.0), Paint::Floor),
    )
}

/// Adds what makes a scene visible from `eye`, in a window or an image.
pub fn dress(app: &mut App, eye: Vec3, target: Vec3, image: Option<RenderTarget>) {
    super::skin::add(app);
    app.insert_resource(ClearColor(Color::srgb(0.62, 0.67, 0.72)))
        // After the ticks, one of which may have begun the scene again: its bodies appear with its springs.
        .add_systems(Update, (show_shapes, super::rope::show))
        .add_systems(Startup, move |mut commands: Commands| {
            let mut camera = commands.spawn((
                Stays,
                Camera3d::default(),
                Transform::from_translation(eye).looking_at(target, Vec3::Y),
                Projection::Perspective(PerspectiveProjection {
                    fov: 0.6,
                    ..default()
                }),
                Tonemapping::AcesFitted,
                AmbientLight {
                    color: Color::srgb(0.85, 0.92, 1.0),
                    brightness: 500.0,
                    ..default()
                },
                Msaa::Sample4,
            ));
            if let Some(image) = &image {
                camera.insert(image.clone());
            }
            commands.spawn((
                Stays,
                DirectionalLight {
                    illuminance: 9_000.0,
                    shadow_maps_enabled: true,
                    ..default()
                },
                Transform::from_xyz(3.0, 7.0, 4.0).looking_at(Vec3::ZERO, Vec3::Y),
                CascadeShadowConfigBuilder {
                    maximum_distance: 25.0,
                    first_cascade_far_bound: 10.0,
                    ..default()
                }
                .build(),
            ));
            // A second light from the other side brightens the shadows.
            commands.spawn((
                Stays,
                DirectionalLight {
                    illuminance: 2_200.0,
                    color: Color::srgb(0.8, 0.88, 1.0),
                    ..default()
                },
                Transform::from_xyz(-5.0, 3.0, 2.0).looking_at(Vec3::ZERO, Vec3::Y),
            ));
        });
}

fn show_shapes(
    shapes: Query<(Entity, &Shape), Added<Shape>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, shape) in &shapes {
        let (mesh, paint): (Mesh, _) = match *shape {
            Shape::Cuboid(size, paint) => (Cuboid::from_size(size).into(), paint),
            Shape::Ball(radius, paint) => (Sphere::new(radius).mesh().uv(48, 24), paint),
            Shape::Cylinder(radius, height, paint) => (
                Cylinder::new(radius, height).mesh().resolution(64).build(),
                paint,
            ),
            Shape::Capsule(radius, height, paint) => (Capsule3d::new(radius, height).into(), paint),
            Shape::Strip(height, length, width, paint) => {
                (strip_mesh(height, length, width), paint)
            }
        };
        commands.entity(entity).insert((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(materials.add(paint.material())),
        ));
    }
}
