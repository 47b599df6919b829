//! Triangles of colliders: reads them from the meshes of a file, and joins those of a node and its descendants.
//!
//! Many nodes may have the same mesh, and many colliders the same nodes. So a small file may ask for more geometry than
//! there is memory. The size of each collider is known before anything is copied, and [`MOST`] limits their sum.

use super::carry::Mesh;
use super::nodes::{File, Node};
use bevy::platform::collections::HashMap;
use bevy::prelude::Vec3;
use gltf::Semantic;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use std::sync::Arc;

/// Greatest number of vertices and corners of triangles that the colliders of a file have together. A mesh counts once
/// for each collider that it is part of, because the engine gets a copy for each. The nodes that are visited to find the
/// meshes count too.
///
/// With half as many vertices as triangles, as usual, these are 3 million triangles. A vertex takes 12 bytes and a corner 4,
/// and the engine's search tree takes 64 for each triangle. Below 2³², indices of vertices do not overflow. Pinned by
/// `large::a_collider_that_does_not_fit_is_left_out_before_it_is_copied`.
pub(super) const MOST: usize = 10_000_000;

/// Geometry of a file's colliders.
#[derive(Clone, Default)]
pub(super) struct Geometry {
    /// Meshes of the file, by index. `None` if a mesh does not fit into [`MOST`].
    meshes: HashMap<usize, Option<Mesh>>,
    /// Sum of the sizes of these meshes.
    read: usize,
    /// Size of each node with its descendants. Empty until the first collider needs it.
    sizes: Vec<Size>,
    /// Geometry of colliders, by the node that they consist of.
    made: HashMap<usize, Arc<Mesh>>,
    /// Sum of the sizes of all colliders so far.
    spent: usize,
}

/// Size of a node with its descendants.
#[derive(Clone, Copy, Default)]
struct Size {
    nodes: usize,
    /// Number of vertices and of corners of triangles; `usize::MAX` if a mesh does not fit into [`MOST`].
    geometry: usize,
}

impl Size {
    fn plus(self, other: Self) -> Self {
        Self {
            nodes: self.nodes.saturating_add(other.nodes),
            geometry: self.geometry.saturating_add(other.geometry),
        }
    }
}

impl Geometry {
    /// Adds the vertices and triangles of a primitive to a mesh. Points, lines and triangles with indices out of range
    /// are left out. So is the whole mesh if it does not fit.
    pub(super) fn add(&mut self, mesh: usize, primitive: &gltf::Primitive, buffers: &[Vec<u8>]) {
        let is_vector = primitive.get(&Semantic::Positions).is_some_and(|accessor| {
            accessor.data_type() == DataType::F32 && accessor.dimensions() == Dimensions::Vec3
        });
        if !is_vector {
            // The reader would panic.
            return;
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let Some(positions) = reader.read_positions() else {
            return;
        };
        let indices = reader.read_indices().map(|indices| indices.into_u32());
        let count = positions.len();
        let length = indices.as_ref().map_or(count, |indices| indices.len());
        let corners = most_corners(primitive.mode(), length);
        let read = self.read.saturating_add(count).saturating_add(corners);
        let slot = self.meshes.entry(mesh);
        let slot = slot.or_insert_with(|| Some(Mesh::default()));
        if read > MOST {
            // Every mesh here is part of a collider. So some collider would not fit in any case.
            *slot = None;
        }
        let Some(to) = slot else {
            return;
        };
        self.read = read;
        // They do not overflow: there are at most `MOST` vertices.
        let (first, count) = (to.vertices.len() as u32, count as u32);
        to.vertices.extend(positions.map(Vec3::from_array));
        if corners == 0 {
            return;
        }
        let order: Vec<u32> = match indices {
            Some(indices) => indices.collect(),
            None => (0..count).collect(),
        };
        let right = triangles(primitive.mode(), &order)
            .into_iter()
            .filter(|t| t.iter().all(|i| *i < count))
            .map(|t| t.map(|i| i + first));
        to.triangles.extend(right);
    }

    /// Returns the triangles of a node and its descendants, in the space of that node, for one more collider. The error
    /// says why the collider has none.
    pub(super) fn collider(&mut self, file: &File, of: usize) -> Result<Arc<Mesh>, String> {
        const EMPTY: &str = "has no triangles";
        if self.sizes.is_empty() {
            self.sizes = self.measure(&file.nodes);
        }
        let size = self.sizes.get(of).copied().unwrap_or_default();
        if size.geometry == 0 {
            return Err(EMPTY.into());
        }
        let made = self.made.get(&of).cloned();
        let visited = if made.is_some() { 0 } else { size.nodes };
        let spent = self.spent.saturating_add(size.geometry);
        let spent = spent.saturating_add(visited);
        if spent > MOST {
            return Err(format!(
                "exceeds the {MOST} vertices and corners of triangles that all colliders of a file may have together"
            ));
        }
        self.spent = spent;
        let mesh = made.unwrap_or_else(|| {
            let mesh = Arc::new(self.join(file, of));
            self.made.insert(of, mesh.clone());
            mesh
        });
        if mesh.vertices.is_empty() {
            return Err(EMPTY.into());
        }
        Ok(mesh)
    }

    /// Returns the size of each node with its descendants. A node below several others counts for each of them.
    fn measure(&self, nodes: &[Node]) -> Vec<Size> {
        let mut sizes = vec![Size::default(); nodes.len()];
        let mut seen = vec![false; nodes.len()];
        // Each node with whether the nodes below it have been measured.
        let mut open: Vec<(usize, bool)> = (0..nodes.len()).map(|index| (index, false)).collect();
        while let Some((index, measured)) = open.pop() {
            let Some(node) = nodes.get(index) else {
                continue;
            };
            if measured {
                let own = Size {
                    nodes: 1,
                    geometry: node.mesh.map_or(0, |mesh| self.size(mesh)),
                };
                let below = node.children.iter().filter_map(|child| sizes.get(*child));
                let sum = below.fold(own, |sum, size| sum.plus(*size));
                sizes[index] = sum;
            } else if !std::mem::replace(&mut seen[index], true) {
                open.push((index, true));
                open.extend(node.children.iter().map(|child| (*child, false)));
            }
        }
        sizes
    }

    /// Returns the number of vertices and corners of triangles of a mesh.
    fn size(&self, mesh: usize) -> usize {
        match self.meshes.get(&mesh) {
            Some(Some(mesh)) => mesh.vertices.len() + 3 * mesh.triangles.len(),
            Some(None) => usize::MAX,
            None => 0,
        }
    }

    /// Joins the triangles of a node and its descendants, in the space of that node.
    fn join(&self, file: &File, node: usize) -> Mesh {
        let mut all = Mesh::default();
        file.below(node, &mut |node, place| {
            let Some(Some(mesh)) = node.mesh.and_then(|mesh| self.meshes.get(&mesh)) else {
                return;
            };
            // It does not overflow: there are at most `MOST` vertices.
            let first = all.vertices.len() as u32;
            let moved = mesh.vertices.iter().map(|v| place.transform_point3(*v));
            all.vertices.extend(moved);
            let triangles = mesh.triangles.iter().map(|t| t.map(|i| i + first));
            all.triangles.extend(triangles);
        });
        all
    }
}

/// Returns how many corners the triangles of a primitive have at most that has so many indices.
fn most_corners(mode: Mode, indices: usize) -> usize {
    match mode {
        Mode::Triangles => indices,
        Mode::TriangleStrip | Mode::TriangleFan => indices.saturating_mul(3),
        _ => 0,
    }
}

/// Returns the triangles of a primitive whose vertices come in this order.
fn triangles(mode: Mode, order: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => order.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => order
            .windows(3)
            .enumerate()
            .map(|(i, t)| {
                if i % 2 == 0 {
                    [t[0], t[1], t[2]]
                } else {
                    [t[1], t[0], t[2]]
                }
            })
            .collect(),
        Mode::TriangleFan => order
            .windows(2)
            .skip(1)
            .map(|t| [order[0], t[0], t[1]])
            .collect(),
        _ => Vec::new(),
    }
}
