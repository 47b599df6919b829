//! Writes Rapier's joints as `KHR_physics_rigid_bodies`. Each joint becomes two nodes, one below each of its bodies.

use super::expand::owner;
use super::export::Writer;
use super::left_out::LeftOut;
use super::mass::steady;
use super::number::{Fields, number, numbers, vector};
use super::place::place;
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{
    GenericJoint as RawJoint, JointEnabled, JointMotor, MotorModel, SpringCoefficients,
};
use bevy_rapier3d::rapier::prelude::Pose;
use serde_json::{Value, json};

impl Writer<'_> {
    /// Writes the joints of all exported entities. Runs after all other nodes, so that their indices are known.
    pub(super) fn joints(&mut self, order: &[Entity]) {
        for entity in self.joint_entities(order) {
            let world = self.world;
            let here = world.entity(entity);
            if let Some(joint) = here.get::<ImpulseJoint>() {
                self.joint(here, joint.parent, &joint.data.as_ref().raw);
            }
            if let Some(joint) = here.get::<MultibodyJoint>() {
                self.left_out
                    .tell(here, "MultibodyJoint comes back as an ImpulseJoint");
                self.joint(here, joint.parent, &joint.data.as_ref().raw);
            }
        }
    }

    /// Writes a joint between the body `parent` and the body that the entity `here` belongs to.
    fn joint(&mut self, here: EntityRef, parent: Entity, raw: &RawJoint) {
        let owner = owner(self.world, here.id());
        let index = |body: Option<Entity>| Some((body?, self.index.get(&body?).copied()?));
        let (Some(a), Some(b)) = (index(Some(parent)), index(owner)) else {
            let what = "a body of its joint is not among what is exported";
            self.left_out.tell(here, what);
            return;
        };
        if here.contains::<Disabled>() {
            self.left_out
                .tell(here, "its joint is Disabled, and comes back enabled");
        }
        tell_unwritten(raw, here, &mut self.left_out);
        let kind = kind(raw, here, &mut self.left_out);
        let kind = self.shared.joint(kind);
        let other = self.frame(b, raw.local_frame2, Value::Null);
        let joint = json!({ "joint": {
            "connectedNode": other, "joint": kind, "enableCollision": raw.contacts_enabled,
        } });
        self.frame(a, raw.local_frame1, json!({ super::physics::NAME: joint }));
    }

    /// Adds a node below a body's node, at the frame of a joint. Returns its index.
    fn frame(&mut self, (body, node): (Entity, usize), at: Pose, extensions: Value) -> usize {
        let scale = place(self.world, body).map_or(Vec3::ONE, |place| steady(place.scale));
        let mut turned = at.rotation.to_array();
        if scale.x < 0.0 {
            // Below a mirrored node, a rotation reads back as its mirror image.
            turned = [turned[0], -turned[1], -turned[2], turned[3]];
        }
        let frame = Fields::default()
            .with("translation", vector(at.translation / scale))
            .with("rotation", numbers(turned))
            .with("extensions", extensions);
        let index = self.nodes.len();
        self.nodes.push(frame.value());
        let body = &mut self.nodes[node];
        let mut children = body["children"].as_array().cloned().unwrap_or_default();
        children.push(json!(index));
        body["children"] = children.into();
        index
    }

    /// Returns all entities with a joint: exported entities and their descendants.
    fn joint_entities(&self, order: &[Entity]) -> Vec<Entity> {
        let mut found = Vec::new();
        let mut seen = EntityHashSet::default();
        let mut open: Vec<_> = order.iter().rev().copied().collect();
        while let Some(entity) = open.pop() {
            if !seen.insert(entity) {
                continue;
            }
            let has_joint = self.world.get::<ImpulseJoint>(entity).is_some()
                || self.world.get::<MultibodyJoint>(entity).is_some();
            if has_joint {
                found.push(entity);
            }
            open.extend(self.world.get::<Children>(entity).into_iter().flatten());
        }
        found
    }
}

/// Tells what of a joint is not in the file, or comes back as something else.
fn tell_unwritten(joint: &RawJoint, entity: EntityRef, left_out: &mut LeftOut) {
    if joint.enabled != JointEnabled::Enabled {
        left_out.tell(entity, "its joint is not enabled, and comes back enabled");
    }
    if joint.softness != SpringCoefficients::joint_defaults() {
        left_out.tell(entity, "the softness of its joint is not written");
    }
    let axes = joint.motor_axes.bits() & !joint.locked_axes.bits();
    let motors = joint.motors.iter().enumerate();
    let mut motors = motors.filter(|(axis, _)| axes & (1 << axis) != 0);
    if motors.any(|(_, motor)| comes_back_as_element(motor)) {
        left_out.tell(entity, "a motor of its joint comes back as an element");
    }
}

/// Whether a motor is read as an element, as [`is_ours`](super::soft::is_ours) has it of drives.
fn comes_back_as_element(motor: &JointMotor) -> bool {
    match motor.model {
        MotorModel::ForceBased => true,
        MotorModel::AccelerationBased => motor.stiffness > 0.0 && motor.target_vel == 0.0,
    }
}

/// Returns the motor of a joint that is a spring and a damper along the distance of its anchors and nothing else, as Rapier's
/// `SpringJoint` is.
fn distance_spring(joint: &RawJoint) -> Option<&JointMotor> {
    let linear = JointAxesMask::LIN_AXES;
    let is_of_distance = joint.coupled_axes.contains(linear)
        && !joint.locked_axes.intersects(linear)
        && joint.motor_axes & linear == JointAxesMask::LIN_X;
    let motor = &joint.motors[0];
    let numbers = [motor.target_pos, motor.stiffness, motor.damping];
    let is_spring = motor.model == MotorModel::ForceBased
        && motor.target_vel == 0.0
        && motor.max_force >= f32::MAX
        && numbers.iter().all(|x| x.is_finite());
    (is_of_distance && is_spring).then_some(motor)
}

/// Returns the limits and drives of a joint as JSON.
fn kind(joint: &RawJoint, entity: EntityRef, left_out: &mut LeftOut) -> Value {
    let bits = |mask: u8, first: usize| -> Vec<usize> {
        (0..3).filter(|i| mask & (1 << (first + i)) != 0).collect()
    };
    let locked = joint.locked_axes.bits();
    let coupled = joint.coupled_axes.bits() & !locked;
    let limited = joint.limit_axes.bits() & !locked;
    let mut limits = Vec::new();
    let mut drives = Vec::new();
    let mut motors = joint.motor_axes.bits() & !locked;
    if let Some(spring) = distance_spring(joint) {
        let length = number(spring.target_pos);
        limits.push(json!({
            "linearAxes": [0, 1, 2], "min": length, "max": length,
            "stiffness": number(spring.stiffness), "damping": number(spring.damping),
        }));
        motors &= !JointAxesMask::LIN_AXES.bits();
    }
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
            // Rapier has no least distance of coupled axes in any case.
            if first == 3 && joint.limits[first + i].min > 0.0 {
                let what = "the min of a limit of its coupled angles comes back as 0";
                left_out.tell(entity, what);
            }
        }
        for i in bits(limited & !coupled, first) {
            limits.push(ends(i, vec![i]));
        }
        for i in bits(motors, first) {
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
                left_out.tell(
                    entity,
                    "a motor of coupled axes is written as one of a single axis",
                );
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
