//! Writes Rapier's bodies and colliders as `KHR_physics_rigid_bodies`.

use super::export_filters::Filters;
use super::export_mass::mass;
use super::left_out::LeftOut;
use super::mass::steady;
use super::number::{Fields, number, numbers, vector};
use super::physics::UNLOCKED;
use super::place::place;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};

/// Lists of the file that nodes refer to by index.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) shapes: Vec<Value>,
    pub(super) materials: Vec<Value>,
    pub(super) filters: Filters,
    pub(super) joints: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    /// Index of the mesh of a shape, by the address of the shape. Colliders that were cloned share their shape.
    shared_meshes: HashMap<usize, usize>,
    /// Index of the node of each mesh.
    pub(super) mesh_nodes: Vec<usize>,
    pub(super) accessors: Vec<Value>,
    pub(super) views: Vec<Value>,
    pub(super) buffer: Vec<u8>,
    /// Nodes that belong to no entity: meshes of colliders, and colliders with a scale of their own.
    pub(super) more_nodes: Vec<Value>,
}

/// Index of a collider's geometry in the file.
pub(super) enum Geometry {
    Shape(usize),
    Mesh { mesh: usize, hull: bool },
}

/// Returns the index of a value in a list, and adds the value if the list does not contain it.
fn index(list: &mut Vec<Value>, value: Value) -> usize {
    list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

impl Parts {
    pub(super) fn material(&mut self, value: Value) -> usize {
        index(&mut self.materials, value)
    }

    pub(super) fn joint(&mut self, value: Value) -> usize {
        index(&mut self.joints, value)
    }

    /// Adds the shape of a collider, without the scale of its entity. The error says why the format cannot hold the
    /// shape.
    pub(super) fn geometry(&mut self, collider: &Collider) -> Result<Geometry, &'static str> {
        let shape = match collider.as_unscaled_typed_shape() {
            ColliderView::Ball(ball) => {
                json!({ "type": "sphere", "sphere": { "radius": number(ball.raw.radius) } })
            }
            ColliderView::Cuboid(cuboid) => {
                json!({ "type": "box", "box": { "size": vector(2.0 * cuboid.raw.half_extents) } })
            }
            ColliderView::Capsule(capsule) => {
                let [a, b] = [capsule.raw.segment.a, capsule.raw.segment.b];
                if a != -b || a.x != 0.0 || a.z != 0.0 {
                    return Err("is a capsule that is not about its node's Y axis");
                }
                let radius = number(capsule.raw.radius);
                json!({ "type": "capsule", "capsule": {
                    "height": number(a.distance(b)), "radiusTop": radius, "radiusBottom": radius } })
            }
            ColliderView::Cylinder(cylinder) => {
                let radius = number(cylinder.raw.radius);
                json!({ "type": "cylinder", "cylinder": { "height": number(2.0 * cylinder.raw.half_height),
                    "radiusTop": radius, "radiusBottom": radius } })
            }
            ColliderView::Cone(cone) => {
                json!({ "type": "cylinder", "cylinder": { "height": number(2.0 * cone.raw.half_height),
                    "radiusTop": 0, "radiusBottom": number(cone.raw.radius) } })
            }
            ColliderView::HalfSpace(plane) if plane.raw.normal == Vec3::Y => {
                json!({ "type": "plane", "plane": {} })
            }
            ColliderView::TriMesh(mesh) => {
                let (raw, hull) = (mesh.raw, false);
                let mesh = self.shared_mesh(raw, |parts| parts.mesh(raw.vertices(), raw.indices()));
                return Ok(Geometry::Mesh { mesh, hull });
            }
            ColliderView::ConvexPolyhedron(hull) => {
                let (raw, hull) = (hull.raw, true);
                let mesh = self.shared_mesh(raw, |parts| {
                    let (points, triangles) = raw.to_trimesh();
                    parts.mesh(&points, &triangles)
                });
                return Ok(Geometry::Mesh { mesh, hull });
            }
            _ => return Err("has a shape that glTF has not"),
        };
        Ok(Geometry::Shape(index(&mut self.shapes, shape)))
    }

    /// Returns the mesh of a shape, which `make` adds where it is not there yet.
    fn shared_mesh<S>(&mut self, shape: &S, make: impl FnOnce(&mut Self) -> usize) -> usize {
        let address = std::ptr::from_ref(shape).addr();
        if let Some(mesh) = self.shared_meshes.get(&address) {
            return *mesh;
        }
        let mesh = make(self);
        self.shared_meshes.insert(address, mesh);
        mesh
    }

    /// Adds a mesh.
    fn mesh(&mut self, vertices: &[Vec3], triangles: &[[u32; 3]]) -> usize {
        let numbers_of = vertices.iter().flat_map(Vec3::to_array);
        let bytes = numbers_of.flat_map(f32::to_le_bytes).collect();
        let view = self.view(bytes, 34962);
        let bound = |of: fn(Vec3, Vec3) -> Vec3| {
            vector(vertices.iter().copied().reduce(of).unwrap_or_default())
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": vertices.len(), "type": "VEC3",
            "min": bound(Vec3::min), "max": bound(Vec3::max),
        }));
        let bytes = triangles.iter().flatten().flat_map(|i| i.to_le_bytes());
        let view = self.view(bytes.collect(), 34963);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5125, "count": 3 * triangles.len(), "type": "SCALAR",
        }));
        let last = self.accessors.len() - 1;
        self.meshes.push(json!({ "primitives": [
            { "attributes": { "POSITION": last - 1 }, "indices": last }] }));
        self.meshes.len() - 1
    }

    fn view(&mut self, bytes: Vec<u8>, target: u32) -> usize {
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len(), "target": target,
        }));
        self.buffer.extend(bytes);
        self.views.len() - 1
    }
}

/// Returns the `motion` of a body; `None` for a fixed body.
pub(super) fn motion(body: EntityRef, world: &World, left_out: &mut LeftOut) -> Option<Value> {
    let kind = *body.get::<RigidBody>()?;
    let mut motion = Fields::default();
    match kind {
        RigidBody::Fixed => return None,
        RigidBody::Dynamic => {}
        RigidBody::KinematicVelocityBased | RigidBody::KinematicPositionBased => {
            motion.add("isKinematic", true.into());
        }
    }
    let place = place(world, body.id()).unwrap_or_default();
    let locked = body
        .get::<LockedAxes>()
        .copied()
        .unwrap_or(LockedAxes::empty());
    let some_of = |all: LockedAxes| locked.intersects(all) && !locked.contains(all);
    if some_of(LockedAxes::TRANSLATION_LOCKED) || some_of(LockedAxes::ROTATION_LOCKED) {
        left_out.tell(
            body,
            "single LockedAxes are of the world, and glTF has only those of the body",
        );
    }
    let properties = mass(world, body);
    // In the file, what is locked is infinite, which is written as zero. The numbers themselves are for this crate.
    let mut unlocked = Fields::default();
    if locked.contains(LockedAxes::TRANSLATION_LOCKED) {
        motion.add("mass", number(0.0));
        unlocked.add("mass", number(properties.mass));
    } else {
        motion.add("mass", number(properties.mass));
    }
    if properties.local_center_of_mass != Vec3::ZERO {
        motion.add(
            "centerOfMass",
            vector(properties.local_center_of_mass / steady(place.scale)),
        );
    }
    if locked.contains(LockedAxes::ROTATION_LOCKED) {
        motion.add("inertiaDiagonal", vector(Vec3::ZERO));
        unlocked.add("inertiaDiagonal", vector(properties.principal_inertia));
    } else {
        motion.add("inertiaDiagonal", vector(properties.principal_inertia));
    }
    let frame = properties.principal_inertia_local_frame;
    if frame != Quat::IDENTITY {
        motion.add("inertiaOrientation", numbers(frame.to_array()));
    }
    if !unlocked.is_empty() {
        motion.add("extras", json!({ UNLOCKED: unlocked.value() }));
    }
    if let Some(velocity) = body.get::<Velocity>() {
        let turned = place.rotation.inverse();
        for (key, v) in [
            ("linearVelocity", velocity.linear),
            ("angularVelocity", velocity.angular),
        ] {
            if v != Vec3::ZERO {
                motion.add(key, vector(turned * v));
            }
        }
    }
    if let Some(GravityScale(factor)) = body.get() {
        motion.add("gravityFactor", number(*factor));
    }
    Some(motion.value())
}

/// Returns the material of a collider; `None` if it has neither `Friction` nor `Restitution`.
pub(super) fn material(collider: EntityRef) -> Option<Value> {
    let (friction, restitution) = (collider.get::<Friction>(), collider.get::<Restitution>());
    if friction.is_none() && restitution.is_none() {
        return None;
    }
    let rule = |rule| match rule {
        CoefficientCombineRule::Min => "minimum",
        CoefficientCombineRule::Max => "maximum",
        CoefficientCombineRule::Multiply => "multiply",
        _ => "average",
    };
    // A missing component is written with Rapier's default, because a reader of the file would use other defaults.
    let friction = friction.copied().unwrap_or_default();
    let restitution = restitution.copied().unwrap_or_default();
    let fields = Fields::default()
        .with("staticFriction", number(friction.coefficient))
        .with("dynamicFriction", number(friction.coefficient))
        .with("frictionCombine", rule(friction.combine_rule).into())
        .with("restitution", number(restitution.coefficient))
        .with("restitutionCombine", rule(restitution.combine_rule).into());
    Some(fields.value())
}

/// Returns the scale of a collider relative to its node, if it has one other than 1. A shape that equals its mirror
/// image loses the signs.
pub(super) fn own_scale(collider: EntityRef, world: &World, symmetric: bool) -> Option<Vec3> {
    let scale = match collider.get::<ColliderScale>()? {
        ColliderScale::Relative(scale) => *scale,
        ColliderScale::Absolute(scale) => {
            *scale / place(world, collider.id()).unwrap_or_default().scale
        }
    };
    let scale = steady(if symmetric { scale.abs() } else { scale });
    // A node with a scale of zero gives a scale that is not finite. In the file, that node has no collider in any
    // case.
    (scale.is_finite() && scale != Vec3::ONE).then_some(scale)
}
