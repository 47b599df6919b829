//! Builds the shapes of colliders for Rapier.

use super::carry::Shape;
use super::physics::Implicit;
use bevy::prelude::*;
use bevy_rapier3d::parry::shape::SharedShape;
use std::f32::consts::{PI, TAU};

/// Number of points on each circle of the convex hull that approximates a round shape which Rapier does not have.
const RIM: u32 = 32;

impl Shape {
    /// Builds the shape for Rapier, without any scale. The error says why that is not possible.
    pub(super) fn build(&self) -> Result<SharedShape, &'static str> {
        match self {
            Self::Implicit(shape) => shape.build(),
            Self::Mesh { mesh, hull } => {
                if mesh.vertices.iter().any(|v| !v.is_finite()) {
                    return Err("has a vertex that is not finite");
                }
                if *hull {
                    return SharedShape::convex_hull(&mesh.vertices)
                        .ok_or("has no convex hull: its points are too few or in one plane");
                }
                if mesh.triangles.is_empty() {
                    return Err("has no triangles");
                }
                SharedShape::trimesh(mesh.vertices.clone(), mesh.triangles.clone())
                    .map_err(|_| "has triangles that are no mesh")
            }
        }
    }

    /// Whether the shape equals its mirror image, up to a rotation.
    pub(super) fn is_symmetric(&self) -> bool {
        matches!(self, Self::Implicit(_))
    }
}

impl Implicit {
    fn build(self) -> Result<SharedShape, &'static str> {
        Ok(match self {
            Self::Plane { x: None, z: None } => SharedShape::halfspace(Vec3::Y),
            Self::Plane { x, z } => {
                // An endless side is 10 km long, which is enough for a game.
                let [x, z] = [x, z].map(|side| 0.5 * side.unwrap_or(1e4));
                let corner = |i, k| Vec3::new(i * x, 0.0, k * z);
                let corners = vec![
                    corner(-1.0, -1.0),
                    corner(-1.0, 1.0),
                    corner(1.0, 1.0),
                    corner(1.0, -1.0),
                ];
                SharedShape::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]])
                    .map_err(|_| "is no plane")?
            }
            Self::Sphere { radius } => SharedShape::ball(radius),
            Self::Box { size } => {
                let half = 0.5 * size;
                SharedShape::cuboid(half.x, half.y, half.z)
            }
            Self::Cylinder {
                height,
                bottom,
                top,
            } => {
                let half = 0.5 * height;
                if bottom == top {
                    SharedShape::cylinder(half, bottom)
                } else if top == 0.0 {
                    SharedShape::cone(half, bottom)
                } else {
                    let rims = [(-half, bottom), (half, top)];
                    hull(rims.into_iter().flat_map(|(y, radius)| rim(y, radius)))?
                }
            }
            Self::Capsule {
                height,
                bottom,
                top,
            } => {
                let half = 0.5 * height;
                if bottom == top {
                    SharedShape::capsule_y(half, bottom)
                } else {
                    let balls = [(-half, bottom), (half, top)];
                    hull(balls.into_iter().flat_map(|(y, radius)| ball(y, radius)))?
                }
            }
        })
    }
}

fn hull(points: impl Iterator<Item = Vec3>) -> Result<SharedShape, &'static str> {
    let points: Vec<_> = points.collect();
    SharedShape::convex_hull(&points).ok_or("has no convex hull")
}

/// Returns points on a horizontal circle at height `y`.
fn rim(y: f32, radius: f32) -> impl Iterator<Item = Vec3> {
    (0..RIM).map(move |i| {
        let (sin, cos) = (TAU * i as f32 / RIM as f32).sin_cos();
        Vec3::new(radius * cos, y, radius * sin)
    })
}

/// Returns points on a sphere whose centre is at height `y`.
fn ball(y: f32, radius: f32) -> impl Iterator<Item = Vec3> {
    (0..=RIM / 2).flat_map(move |i| {
        let (sin, cos) = (PI * i as f32 / (RIM / 2) as f32).sin_cos();
        rim(y - radius * cos, radius * sin)
    })
}
