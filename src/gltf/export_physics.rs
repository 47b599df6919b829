//! Rapier's bodies, colliders and joints as `KHR_physics_rigid_bodies` writes them.

use super::mass::steady;
use super::number::{Fields, number, numbers, vector};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{GenericJoint as RawJoint, MotorModel};
use serde_json::{Value, json};

/// What nodes share in a file.
#[derive(Default)]
pub(super) struct Parts {
    pub(super) shapes: Vec<Value>,
    pub(super) materials: Vec<Value>,
    pub(super) filters: Vec<Value>,
    pub(super) joints: Vec<Value>,
    pub(super) meshes: Vec<Value>,
    pub(super) accessors: Vec<Value>,
    pub(super) views: Vec<Value>,
    pub(super) buffer: Vec<u8>,
    /// Nodes that only hold the mesh of a collider.
    pub(super) mesh_nodes: Vec<Value>,
}

/// Where a collider's geometry is in the file.
pub(super) enum Geometry {
    Shape(usize),
    Mesh { mesh: usize, hull: bool },
}

/// The index of a value in a list, which gets it if it has not.
fn place(list: &mut Vec<Value>, value: Value) -> usize {
    list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

impl Parts {
    pub(super) fn material(&mut self, value: Value) -> usize {
        place(&mut self.materials, value)
    }

    pub(super) fn filter(&mut self, value: Value) -> usize {
        place(&mut self.filters, value)
    }

    pub(super) fn joint(&mut self, value: Value) -> usize {
        place(&mut self.joints, value)
    }

    /// A collider's shape, before its entity's scale; what it is, if the format has it not.
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
                let mesh = self.mesh(mesh.raw.vertices(), mesh.raw.indices());
                return Ok(Geometry::Mesh { mesh, hull: false });
            }
            ColliderView::ConvexPolyhedron(hull) => {
                let (points, triangles) = hull.raw.to_trimesh();
                let mesh = self.mesh(&points, &triangles);
                return Ok(Geometry::Mesh { mesh, hull: true });
            }
            _ => return Err("has a shape that glTF has not"),
        };
        Ok(Geometry::Shape(place(&mut self.shapes, shape)))
    }

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

/// How a body moves; nothing for one that is fixed.
pub(super) fn motion(body: EntityRef, world: &World, left_out: &mut Vec<String>) -> Option<Value> {
    let kind = *body.get::<RigidBody>()?;
    let mut motion = Fields::default();
    match kind {
        RigidBody::Fixed => return None,
        RigidBody::Dynamic => {}
        RigidBody::KinematicVelocityBased | RigidBody::KinematicPositionBased => {
            motion.add("isKinematic", true.into());
        }
    }
    let place = body
        .get::<GlobalTransform>()
        .map(GlobalTransform::compute_transform)
        .unwrap_or_default();
    if let Some(properties) = properties(body, world) {
        let locked = body
            .get::<LockedAxes>()
            .copied()
            .unwrap_or(LockedAxes::empty());
        if !(locked - LockedAxes::TRANSLATION_LOCKED - LockedAxes::ROTATION_LOCKED).is_empty()
            || (locked.intersects(LockedAxes::TRANSLATION_LOCKED)
                && !locked.contains(LockedAxes::TRANSLATION_LOCKED))
            || (locked.intersects(LockedAxes::ROTATION_LOCKED)
                && !locked.contains(LockedAxes::ROTATION_LOCKED))
        {
            left_out.push(format!(
                "{}: single locked axes are of the world, and glTF has only those of the body",
                body.id()
            ));
        }
        let endless = locked.contains(LockedAxes::TRANSLATION_LOCKED);
        motion.add("mass", number(if endless { 0.0 } else { properties.mass }));
        if properties.local_center_of_mass != Vec3::ZERO {
            motion.add(
                "centerOfMass",
                vector(properties.local_center_of_mass / steady(place.scale)),
            );
        }
        if locked.contains(LockedAxes::ROTATION_LOCKED) {
            motion.add("inertiaDiagonal", vector(Vec3::ZERO));
        } else {
            motion.add("inertiaDiagonal", vector(properties.principal_inertia));
            let frame = properties.principal_inertia_local_frame;
            if frame != Quat::IDENTITY {
                motion.add("inertiaOrientation", numbers(frame.to_array()));
            }
        }
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

/// Mass properties of a whole body: as the user gave them if nothing else weighs, else as the engine has them.
fn properties(body: EntityRef, world: &World) -> Option<MassProperties> {
    let handle = body.get::<RapierRigidBodyHandle>();
    let context = body.get::<RapierContextEntityLink>();
    let engine = handle.zip(context).and_then(|(handle, context)| {
        let set = world.get::<RapierRigidBodySet>(context.0)?;
        let raw = set.bodies.get(handle.0)?.mass_properties().local_mprops;
        Some(MassProperties::from_rapier(raw))
    });
    let given = match body.get::<AdditionalMassProperties>() {
        Some(AdditionalMassProperties::MassProperties(given)) => Some(*given),
        _ => None,
    };
    match (given, engine) {
        (Some(given), Some(engine)) if (engine.mass - given.mass).abs() > 1e-4 * given.mass => {
            Some(engine)
        }
        (Some(given), _) => Some(given),
        (None, engine) => engine,
    }
}

/// Friction and restitution of a collider, if it has any of its own.
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
    let mut fields = Fields::default();
    if let Some(friction) = friction {
        fields.add("staticFriction", number(friction.coefficient));
        fields.add("dynamicFriction", number(friction.coefficient));
        fields.add("frictionCombine", rule(friction.combine_rule).into());
    }
    if let Some(restitution) = restitution {
        fields.add("restitution", number(restitution.coefficient));
        fields.add("restitutionCombine", rule(restitution.combine_rule).into());
    }
    Some(fields.value())
}

/// Groups as systems that have the number of their bit for a name.
pub(super) fn filter(groups: &CollisionGroups) -> Value {
    let names = |group: Group| -> Vec<String> {
        let bits = (0..32).filter(|bit| group.bits() & (1 << bit) != 0);
        bits.map(|bit| bit.to_string()).collect()
    };
    json!({
        "collisionSystems": names(groups.memberships),
        "collideWithSystems": names(groups.filters),
    })
}

/// Limits and drives of a joint.
pub(super) fn joint(joint: &RawJoint, entity: Entity, left_out: &mut Vec<String>) -> Value {
    let bits = |mask: u8, first: usize| -> Vec<usize> {
        (0..3).filter(|i| mask & (1 << (first + i)) != 0).collect()
    };
    let locked = joint.locked_axes.bits();
    let coupled = joint.coupled_axes.bits() & !locked;
    let limited = joint.limit_axes.bits() & !locked;
    let mut limits = Vec::new();
    let mut drives = Vec::new();
    for (first, key, kind) in [(0, "linearAxes", "linear"), (3, "angularAxes", "angular")] {
        let all = bits(locked, first);
        if !all.is_empty() {
            limits.push(json!({ key: all, "min": 0, "max": 0 }));
        }
        let ends = |i: usize, axes: Vec<usize>| {
            let limit = &joint.limits[first + i];
            let given = |x: f32| {
                if x.abs() < f32::MAX {
                    number(x)
                } else {
                    Value::Null
                }
            };
            Fields::default()
                .with(key, json!(axes))
                .with("min", given(limit.min))
                .with("max", given(limit.max))
                .value()
        };
        let group = bits(coupled, first);
        if let Some(i) = group.first()
            && limited & (1 << (first + i)) != 0
        {
            limits.push(ends(*i, group.clone()));
        }
        for i in bits(limited & !coupled, first) {
            limits.push(ends(i, vec![i]));
        }
        for i in bits(joint.motor_axes.bits() & !locked, first) {
            let motor = &joint.motors[first + i];
            let mode = match motor.model {
                MotorModel::AccelerationBased => "acceleration",
                MotorModel::ForceBased => "force",
            };
            let fields = Fields::default()
                .with("type", kind.into())
                .with("mode", mode.into())
                .with("axis", json!(i))
                .with("positionTarget", number(motor.target_pos))
                .with("velocityTarget", number(motor.target_vel))
                .with("stiffness", number(motor.stiffness))
                .with("damping", number(motor.damping))
                .with(
                    "maxForce",
                    if motor.max_force < f32::MAX {
                        number(motor.max_force)
                    } else {
                        Value::Null
                    },
                );
            drives.push(fields.value());
            if coupled & (1 << (first + i)) != 0 {
                left_out.push(format!(
                    "{entity}: a motor of coupled axes is written as one of a single axis"
                ));
            }
        }
    }
    let mut all = Fields::default();
    if !limits.is_empty() {
        all.add("limits", limits.into());
    }
    if !drives.is_empty() {
        all.add("drives", drives.into());
    }
    all.value()
}
