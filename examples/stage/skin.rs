//! Meshes that follow points: each vertex is at the weighted mean of some entities.

use super::Paint;
use bevy::asset::{AssetEventSystems, RenderAssetUsages};
use bevy::camera::visibility::NoFrustumCulling;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

/// A vertex: the entities it follows, with weights whose sum is 1, and its offset in the world's axes, m.
#[derive(Clone, Default)]
pub struct Vertex {
    pub follows: Vec<(Entity, f32)>,
    pub offset: Vec3,
}

/// A mesh over moving points. Ignored where nothing is drawn.
#[derive(Component)]
#[require(Transform, Visibility, NoFrustumCulling)]
pub struct Skin {
    pub vertices: Vec<Vertex>,
    /// Anticlockwise, seen from outside. Removed triangles are no longer drawn.
    pub triangles: Vec<[u32; 3]>,
    pub paint: Paint,
}

impl Skin {
    /// Returns a tube along points, each of which follows one entity.
    pub fn tube(points: &[Entity], radius: f32, across: [Vec3; 2], paint: Paint) -> Self {
        const SIDES: u32 = 8;
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for (i, point) in points.iter().enumerate() {
            for side in 0..SIDES {
                let (sin, cos) = (side as f32 / SIDES as f32 * std::f32::consts::TAU).sin_cos();
                vertices.push(Vertex {
                    follows: vec![(*point, 1.0)],
                    offset: radius * (cos * across[0] + sin * across[1]),
                });
                if i > 0 {
                    let next = (side + 1) % SIDES;
                    let (far, near) = (SIDES * i as u32, SIDES * (i as u32 - 1));
                    let [a, b, c, d] = [near + side, near + next, far + side, far + next];
                    triangles.extend([[a, b, c], [c, b, d]]);
                }
            }
        }
        Self {
            vertices,
            triangles,
            paint,
        }
    }
}

pub fn add(app: &mut App) {
    app.add_systems(
        PostUpdate,
        (make, follow)
            .chain()
            .after(TransformSystems::Propagate)
            .before(AssetEventSystems),
    );
}

fn make(
    skins: Query<(Entity, &Skin), Without<Mesh3d>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, skin) in &skins {
        let mesh = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        );
        commands.entity(entity).insert((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(materials.add(skin.paint.material())),
        ));
    }
}

fn follow(
    skins: Query<(&Skin, &Mesh3d)>,
    places: Query<&GlobalTransform>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (skin, mesh) in &skins {
        let Some(mut mesh) = meshes.get_mut(&mesh.0) else {
            continue;
        };
        let place = |vertex: &Vertex| {
            let parts = vertex.follows.iter().filter_map(|(entity, weight)| {
                Some(*weight * places.get(*entity).ok()?.translation())
            });
            vertex.offset + parts.sum::<Vec3>()
        };
        let points: Vec<Vec3> = skin.vertices.iter().map(place).collect();
        let mut normals = vec![Vec3::ZERO; points.len()];
        for triangle in &skin.triangles {
            let [a, b, c] = triangle.map(|i| points[i as usize]);
            let normal = (b - a).cross(c - a);
            for i in triangle {
                normals[*i as usize] += normal;
            }
        }
        for normal in &mut normals {
            *normal = normal.normalize_or(Vec3::Y);
        }
        let indices = skin.triangles.iter().flatten().copied().collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_POSITION, points);
        mesh.insert_attribute(Mesh::ATTRIBUTE_NORMAL, normals);
        mesh.insert_indices(Indices::U32(indices));
    }
}
