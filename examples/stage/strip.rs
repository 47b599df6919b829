//! The mesh of a road strip that is not level: the region below a curve, as triangles.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, Mesh, PrimitiveTopology};
use bevy::prelude::*;

/// Distance between two points along the strip, m.
const STEP: f32 = 0.1;

/// Returns points, normals and triangles of a strip along x from 0 and about z = 0: its top at the function's height,
/// and its ends and sides down to y = 0.
pub fn strip(
    height: fn(f32) -> f32,
    length: f32,
    width: f32,
) -> (Vec<Vec3>, Vec<Vec3>, Vec<[u32; 3]>) {
    let count = (length / STEP).round().max(1.0) as u32;
    let step = length / count as f32;
    let xs: Vec<f32> = (0..=count).map(|i| i as f32 * step).collect();
    let (mut points, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    let half = 0.5 * width;
    // Each item is a band between two lines, seen with the first line on the left.
    let mut band = |lines: [Vec<Vec3>; 2], normal: Vec<Vec3>| {
        let first = points.len() as u32;
        let count = normal.len() as u32;
        let [left, right] = lines;
        for ((left, right), normal) in left.into_iter().zip(right).zip(normal) {
            points.extend([left, right]);
            normals.extend([normal, normal]);
        }
        for i in 0..count - 1 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + 2 * i + k);
            triangles.extend([[a, b, c], [c, b, d]]);
        }
    };
    let line = |z: f32, high: bool| -> Vec<Vec3> {
        let y = |x| if high { height(x) } else { 0.0 };
        xs.iter().map(|x| Vec3::new(*x, y(*x), z)).collect()
    };
    let up = |x: &f32| Vec3::new(height(x - step) - height(x + step), 2.0 * step, 0.0).normalize();
    let tops = xs.iter().map(up).collect();
    band([line(-half, true), line(half, true)], tops);
    band(
        [line(half, true), line(half, false)],
        vec![Vec3::Z; xs.len()],
    );
    band(
        [line(-half, false), line(-half, true)],
        vec![Vec3::NEG_Z; xs.len()],
    );
    let end = |y, z| Vec3::new(length, y, z);
    let top = height(length);
    band(
        [
            vec![end(top, -half), end(0.0, -half)],
            vec![end(top, half), end(0.0, half)],
        ],
        vec![Vec3::X; 2],
    );
    (points, normals, triangles)
}

/// Returns the strip as a mesh.
pub fn strip_mesh(height: fn(f32) -> f32, length: f32, width: f32) -> Mesh {
    let (points, normals, triangles) = strip(height, length, width);
    let uvs: Vec<Vec2> = points.iter().map(|p| p.xz()).collect();
    let indices = triangles.into_iter().flatten().collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, points)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_indices(Indices::U32(indices))
}
