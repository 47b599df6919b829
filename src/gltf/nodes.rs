//! Content of a file that does not depend on the scene: its nodes, and the lists that they refer to by index.

use super::json::Told;
use super::physics::{self, NodePhysics, Shared, Source};
use super::{element, filters};
use bevy::math::Affine3A;
use bevy::platform::collections::HashSet;
use bevy::prelude::{Mat4, Quat, Vec3};
use gltf::scene::Transform;
use serde_json::Value;

/// Greatest depth of nodes that is followed. Bevy's own loader recurses and cannot go deeper either.
const DEEPEST: usize = 512;

#[derive(Default)]
pub(super) struct File {
    pub(super) path: String,
    pub(super) nodes: Vec<Node>,
    pub(super) shared: Option<Shared>,
    /// Bits of the collision filters, as [`filters::named_groups`] or [`filters::groups`] returns them.
    pub(super) groups: Vec<(u32, u32)>,
    /// Indices of the meshes that colliders need.
    pub(super) wanted: HashSet<usize>,
}

#[derive(Default)]
pub(super) struct Node {
    pub(super) place: String,
    transform: Affine3A,
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    deformed: bool,
    pub(super) element: Option<Value>,
    pub(super) physics: NodePhysics,
}

impl Node {
    fn read(node: &gltf::Node, told: &Told) -> Self {
        let name = node.name().map(|name| format!(" '{name}'"));
        let place = format!("node {}{}", node.index(), name.unwrap_or_default());
        let physics = node.extension_value(physics::NAME);
        Self {
            transform: affine(node),
            children: node.children().map(|child| child.index()).collect(),
            mesh: node.mesh().map(|mesh| mesh.index()),
            deformed: node.skin().is_some() || node.weights().is_some(),
            element: node.extension_value(element::NAME).cloned(),
            physics: physics
                .map(|value| NodePhysics::read(value, &place, told))
                .unwrap_or_default(),
            place,
        }
    }

    /// Returns the node whose meshes this node's collider consists of.
    fn source(&self) -> Option<usize> {
        match self.physics.collider.as_ref()?.source {
            Source::Mesh { node, .. } => Some(node),
            Source::Shape(_) => None,
        }
    }
}

impl File {
    pub(super) fn read(document: &gltf::Document, path: String) -> Self {
        let told = Told::default();
        let nodes = document.nodes().map(|node| Node::read(&node, &told));
        let nodes: Vec<_> = nodes.collect();
        let shared = Shared::read(
            document.extension_value(physics::NAME),
            document.extension_value(physics::SHAPES),
            &told,
        );
        // In files of this crate, where one collider has a filter all have. No bits are left for another one.
        let named = filters::named_groups(&shared);
        let has_filter = |collider: &physics::Collider| {
            collider
                .filter
                .is_some_and(|filter| filter < shared.filters.len())
        };
        let mut colliders = nodes
            .iter()
            .filter_map(|node| node.physics.collider.as_ref());
        let named = named.filter(|_| colliders.all(has_filter));
        if named.is_none() && shared.filters.len() > filters::MOST {
            let most = filters::MOST;
            told.tell(
                physics::NAME,
                format_args!("collisionFilters beyond the first {most} are taken as one"),
            );
        }
        let groups = named.unwrap_or_else(|| filters::groups(&shared));
        let mut file = Self {
            path,
            nodes,
            shared: Some(shared),
            groups,
            ..Default::default()
        };
        file.wanted = file.meshes_of_colliders(&told);
        told.log(&file.path);
        file
    }

    /// Returns the meshes that colliders need. Reports nodes of colliders that a skin or weights would deform.
    ///
    /// Each node is visited once, however many colliders consist of it or of a node above it.
    fn meshes_of_colliders(&self, told: &Told) -> HashSet<usize> {
        let mut open: Vec<usize> = self.nodes.iter().filter_map(Node::source).collect();
        let mut seen = vec![false; self.nodes.len()];
        while let Some(index) = open.pop() {
            let Some(node) = self.nodes.get(index) else {
                continue;
            };
            if !std::mem::replace(&mut seen[index], true) {
                open.extend(&node.children);
            }
        }
        let mut wanted = HashSet::new();
        for (node, _) in self.nodes.iter().zip(seen).filter(|(_, seen)| *seen) {
            wanted.extend(node.mesh);
            if node.deformed {
                told.tell(&node.place, "its skin or weights do not deform colliders");
            }
        }
        wanted
    }

    /// Visits a node and its descendants, each with its transform in the space of the first node.
    pub(super) fn below<'a>(&'a self, first: usize, visit: &mut impl FnMut(&'a Node, Affine3A)) {
        let mut open = vec![(first, Affine3A::IDENTITY, 0)];
        let mut seen = HashSet::new();
        while let Some((index, place, depth)) = open.pop() {
            let Some(node) = self.nodes.get(index) else {
                continue;
            };
            if depth > DEEPEST || !seen.insert(index) {
                continue;
            }
            visit(node, place);
            for &child in &node.children {
                if let Some(node) = self.nodes.get(child) {
                    open.push((child, place * node.transform, depth + 1));
                }
            }
        }
    }
}

fn affine(node: &gltf::Node) -> Affine3A {
    match node.transform() {
        Transform::Matrix { matrix } => Affine3A::from_mat4(Mat4::from_cols_array_2d(&matrix)),
        Transform::Decomposed {
            translation,
            rotation,
            scale,
        } => Affine3A::from_scale_rotation_translation(
            Vec3::from_array(scale),
            Quat::from_array(rotation),
            Vec3::from_array(translation),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Returns what a file says whose nodes are these. Each may have the mesh 0.
    fn read(nodes: &[Value]) -> File {
        let file = json!({
            "asset": { "version": "2.0" },
            "nodes": nodes,
            "meshes": [{ "primitives": [{ "attributes": {} }] }],
        });
        // Validation would ask for the vertices, which nothing here reads.
        let gltf = gltf::Gltf::from_slice_without_validation(file.to_string().as_bytes());
        File::read(&gltf.expect("it is glTF").document, "test".into())
    }

    #[test]
    fn ten_thousand_colliders_that_consist_of_one_node_are_read() {
        const COUNT: usize = 10_000;
        let collider = json!({ "collider": { "geometry": { "node": 0 } } });
        let extensions = json!({ "KHR_physics_rigid_bodies": collider });
        let node = json!({ "weights": [0.5], "extensions": extensions });
        let mut nodes = vec![node; COUNT];
        let children: Vec<usize> = (1..COUNT).collect();
        nodes[0]["children"] = json!(children);
        nodes[COUNT - 1]["mesh"] = json!(0);
        let file = read(&nodes);
        let told = Told::default();
        let wanted = file.meshes_of_colliders(&told);
        assert!(wanted.len() == 1 && wanted.contains(&0), "{wanted:?}");
        // Each node is told of once, and not once for each collider.
        assert_eq!(told.count(), COUNT);
        assert!(told.lines()[0].starts_with("node 0: its skin or weights"));
    }

    #[test]
    fn colliders_that_consist_of_each_other_or_of_no_node_are_read() {
        let collider = |of: usize| json!({ "collider": { "geometry": { "node": of } } });
        let node = |of: usize, child: usize| {
            let extensions = json!({ "KHR_physics_rigid_bodies": collider(of) });
            json!({ "children": [child], "mesh": 0, "extensions": extensions })
        };
        // Bevy refuses nodes in a ring later than it lets this crate read them.
        let file = read(&[node(1, 1), node(0, 0), node(7, 0)]);
        assert!(file.wanted.contains(&0));
        let mut visited = 0;
        file.below(0, &mut |_, _| visited += 1);
        assert_eq!(visited, 2);
    }
}
