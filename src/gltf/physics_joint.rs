//! Reads the joints of `KHR_physics_rigid_bodies` into plain data.

use super::json::{Object, index};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limit {
    pub(super) linear: bool,
    pub(super) axes: [bool; 3],
    pub(super) min: Option<f32>,
    pub(super) max: Option<f32>,
    /// Stiffness, N/m or N m/rad. `None` for a rigid limit.
    pub(super) stiffness: Option<f32>,
    pub(super) damping: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drive {
    pub(super) linear: bool,
    pub(super) acceleration: bool,
    pub(super) axis: usize,
    pub(super) max_force: Option<f32>,
    pub(super) position: f32,
    pub(super) velocity: f32,
    pub(super) stiffness: f32,
    pub(super) damping: f32,
}

/// Limits and drives, which several joints may share.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct JointKind {
    pub(super) limits: Vec<Limit>,
    pub(super) drives: Vec<Drive>,
}

/// The joint of a node: indices of the connected node and of the shared [`JointKind`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Joint {
    pub(super) connected: usize,
    pub(super) kind: usize,
    pub(super) collide: bool,
}

pub(super) fn joint_kind(object: &Object) -> JointKind {
    let limits = object.objects("limits");
    let drives = object.objects("drives");
    JointKind {
        limits: limits.iter().flatten().filter_map(limit).collect(),
        drives: drives.iter().flatten().filter_map(drive).collect(),
    }
}

fn limit(object: &Object) -> Option<Limit> {
    let linear = object.has("linearAxes");
    let key = if linear { "linearAxes" } else { "angularAxes" };
    if linear == object.has("angularAxes") {
        object.told().tell(
            object.place(),
            "must have either linearAxes or angularAxes; left out",
        );
        return None;
    }
    let mut axes = [false; 3];
    for axis in object.list(key) {
        match index(axis).and_then(|axis| axes.get_mut(axis)) {
            Some(axis) => *axis = true,
            None => object.tell(key, "has an axis that is none of 0, 1, 2"),
        }
    }
    if axes == [false; 3] {
        object.tell(key, "has no axis; the limit is left out");
        return None;
    }
    let (min, max) = (object.finite("min"), object.finite("max"));
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        object.tell("min", "is above max; the limit is left out");
        return None;
    }
    Some(Limit {
        linear,
        axes,
        min,
        max,
        stiffness: object.finite("stiffness"),
        damping: object.finite("damping").unwrap_or(0.0),
    })
}

fn drive(object: &Object) -> Option<Drive> {
    let linear = match object.text("type") {
        Some("linear") => true,
        Some("angular") => false,
        _ => {
            object.tell(
                "type",
                "is neither linear nor angular; the drive is left out",
            );
            return None;
        }
    };
    let acceleration = match object.text("mode") {
        None | Some("force") => false,
        Some("acceleration") => true,
        Some(_) => {
            object.tell("mode", "is neither force nor acceleration; taken as force");
            false
        }
    };
    let axis = object.index("axis").filter(|axis| *axis < 3);
    if axis.is_none() {
        object.tell("axis", "is none of 0, 1, 2; the drive is left out");
    }
    let of = |key| object.finite(key).unwrap_or(0.0);
    Some(Drive {
        linear,
        acceleration,
        axis: axis?,
        max_force: object.finite("maxForce"),
        position: of("positionTarget"),
        velocity: of("velocityTarget"),
        stiffness: of("stiffness"),
        damping: of("damping"),
    })
}

pub(super) fn joint(object: &Object) -> Option<Joint> {
    let needed = |key: &str| {
        if !object.has(key) {
            object.tell(key, "is missing; the joint is left out");
        }
        object.index(key)
    };
    Some(Joint {
        connected: needed("connectedNode")?,
        kind: needed("joint")?,
        collide: object.flag("enableCollision").unwrap_or(false),
    })
}
