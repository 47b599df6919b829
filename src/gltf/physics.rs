//! Reads `KHR_physics_rigid_bodies` and `KHR_implicit_shapes` into plain data. The JSON may be wrong.

use super::companions::choice;
use super::json::{Object, Told};
pub(super) use super::physics_joint::{Joint, JointKind};
use super::physics_joint::{joint, joint_kind};
use bevy::prelude::*;
use bevy_rapier3d::prelude::CoefficientCombineRule;
use serde_json::Value;

/// Name of the glTF extension that nodes and the file itself have.
pub(super) const NAME: &str = "KHR_physics_rigid_bodies";
/// Name of the glTF extension that holds the shapes.
pub(super) const SHAPES: &str = "KHR_implicit_shapes";

/// Key in the `extras` of a `motion` for the mass and the inertia of a body whose axes are locked.
pub(super) const UNLOCKED: &str = "BEVY_coilover_unlocked";

/// The `motion` of a node: how its body moves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Motion {
    pub(super) kinematic: bool,
    /// Mass, kg. Zero means infinite.
    pub(super) mass: Option<f32>,
    /// Mass to which a body returns that is unlocked, kg. The draft has no such number; the export writes it.
    pub(super) unlocked_mass: Option<f32>,
    pub(super) centre_of_mass: Option<Vec3>,
    /// Principal moments of inertia, kg m². Zero means infinite.
    pub(super) inertia: Option<Vec3>,
    /// Principal moments of inertia to which a body returns that is unlocked, kg m².
    pub(super) unlocked_inertia: Option<Vec3>,
    pub(super) inertia_frame: Quat,
    pub(super) linear_velocity: Vec3,
    pub(super) angular_velocity: Vec3,
    pub(super) gravity_factor: f32,
}

/// A shape without the scale of its node. A plane without `x` or `z` is endless in that direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Implicit {
    Plane { x: Option<f32>, z: Option<f32> },
    Sphere { radius: f32 },
    Box { size: Vec3 },
    Cylinder { height: f32, bottom: f32, top: f32 },
    Capsule { height: f32, bottom: f32, top: f32 },
}

/// Source of a collider's geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    Shape(usize),
    Mesh { node: usize, hull: bool },
}

/// A collider or a trigger.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Collider {
    pub(super) source: Source,
    pub(super) material: Option<usize>,
    pub(super) filter: Option<usize>,
    pub(super) trigger: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Material {
    pub(super) friction: f32,
    pub(super) friction_rule: CoefficientCombineRule,
    pub(super) restitution: f32,
    pub(super) restitution_rule: CoefficientCombineRule,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Filter {
    pub(super) systems: Vec<String>,
    pub(super) only: Option<Vec<String>>,
    pub(super) never: Option<Vec<String>>,
}

/// Content of the physics extension of one node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct NodePhysics {
    pub(super) motion: Option<Motion>,
    pub(super) collider: Option<Collider>,
    pub(super) joint: Option<Joint>,
}

/// Lists that the nodes of a file refer to by index. An item that could not be read is `None`, so that the indices
/// stay right.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shared {
    pub(super) shapes: Vec<Option<Implicit>>,
    pub(super) materials: Vec<Option<Material>>,
    pub(super) filters: Vec<Option<Filter>>,
    pub(super) joints: Vec<Option<JointKind>>,
}

impl Shared {
    pub(super) fn read(physics: Option<&Value>, shapes: Option<&Value>, told: &Told) -> Self {
        let mut shared = Self::default();
        if let Some(root) = shapes.and_then(|value| Object::new(value, SHAPES.into(), told)) {
            shared.shapes = read_all(&root, "shapes", shape);
        }
        if let Some(root) = physics.and_then(|value| Object::new(value, NAME.into(), told)) {
            shared.materials = read_all(&root, "physicsMaterials", |o| Some(material(o)));
            shared.filters = read_all(&root, "collisionFilters", |o| Some(filter(o)));
            shared.joints = read_all(&root, "physicsJoints", |o| Some(joint_kind(o)));
        }
        shared
    }
}

fn read_all<T>(root: &Object, key: &str, read: impl Fn(&Object) -> Option<T>) -> Vec<Option<T>> {
    let objects = root.objects(key);
    objects.iter().map(|o| read(o.as_ref()?)).collect()
}

/// Returns a number above zero, or `default` if the key is missing.
fn size(object: &Object, key: &str, default: f32) -> Option<f32> {
    if !object.has(key) {
        return Some(default);
    }
    let size = object.finite(key)?;
    if size <= 0.0 {
        object.tell(key, "is not above zero; the shape is left out");
        return None;
    }
    Some(size)
}

fn shape(object: &Object) -> Option<Implicit> {
    let kind = object.text("type")?;
    let empty = Value::Object(default());
    let data = object.raw(kind).unwrap_or(&empty);
    let data = Object::new(data, object.place_of(kind), object.told())?;
    match kind {
        "plane" => {
            let side = |key| {
                if data.has(key) {
                    size(&data, key, 1.0).map(Some)
                } else {
                    Some(None)
                }
            };
            if data.flag("doubleSided") == Some(true) && !data.has("sizeX") && !data.has("sizeZ") {
                data.tell(
                    "doubleSided",
                    "is not honoured: an endless plane has one side",
                );
            }
            Some(Implicit::Plane {
                x: side("sizeX")?,
                z: side("sizeZ")?,
            })
        }
        "sphere" => Some(Implicit::Sphere {
            radius: size(&data, "radius", 0.5)?,
        }),
        "box" => {
            let size = if data.has("size") {
                data.finite_vector("size")?
            } else {
                Vec3::ONE
            };
            if size.cmple(Vec3::ZERO).any() {
                data.tell("size", "is not above zero; the shape is left out");
                return None;
            }
            Some(Implicit::Box { size })
        }
        "cylinder" | "capsule" => {
            let height = size(&data, "height", 0.5)?;
            let radius = |key| {
                let given = data.has(key);
                let radius = if given { data.finite(key)? } else { 0.25 };
                if radius < 0.0 {
                    data.tell(key, "is negative; the shape is left out");
                    return None;
                }
                Some(radius)
            };
            let (bottom, top) = (radius("radiusBottom")?, radius("radiusTop")?);
            if bottom.max(top) <= 0.0 {
                object.tell(kind, "has no radius above zero; the shape is left out");
                return None;
            }
            Some(if kind == "cylinder" {
                Implicit::Cylinder {
                    height,
                    bottom,
                    top,
                }
            } else {
                Implicit::Capsule {
                    height,
                    bottom,
                    top,
                }
            })
        }
        other => {
            object.tell("type", format_args!("'{other}' is not known; left out"));
            None
        }
    }
}

fn material(object: &Object) -> Material {
    let amount = |key: &str, default: f32| {
        let value = object.finite(key).unwrap_or(default);
        if value < 0.0 {
            object.tell(key, "is negative, and taken as 0");
        }
        value.max(0.0)
    };
    // The text of the specification gives no defaults; its schema gives these.
    let resting = amount("staticFriction", 0.6);
    let friction = amount("dynamicFriction", 0.6);
    if object.has("staticFriction") && resting != friction {
        object.tell(
            "staticFriction",
            "differs from dynamicFriction, which is used for both",
        );
    }
    let rule = |key| {
        let rules = [
            ("average", CoefficientCombineRule::Average),
            ("minimum", CoefficientCombineRule::Min),
            ("maximum", CoefficientCombineRule::Max),
            ("multiply", CoefficientCombineRule::Multiply),
        ];
        choice(object, key, rules).unwrap_or(CoefficientCombineRule::Average)
    };
    Material {
        friction,
        friction_rule: rule("frictionCombine"),
        restitution: amount("restitution", 0.0),
        restitution_rule: rule("restitutionCombine"),
    }
}

fn filter(object: &Object) -> Filter {
    let list = |key| {
        let texts = object.texts(key)?;
        Some(texts.into_iter().map(str::to_owned).collect())
    };
    Filter {
        systems: list("collisionSystems").unwrap_or_default(),
        only: list("collideWithSystems"),
        never: list("notCollideWithSystems"),
    }
}

impl NodePhysics {
    pub(super) fn read(value: &Value, place: &str, told: &Told) -> Self {
        let Some(object) = Object::new(value, format!("{place}: {NAME}"), told) else {
            return Self::default();
        };
        object.only(&["motion", "collider", "trigger", "joint"]);
        let mut collider = object
            .object("collider")
            .and_then(|o| read_collider(&o, false));
        if let Some(trigger) = object.object("trigger") {
            // A compound trigger has no geometry of its own: its volumes are on the nodes below it.
            let volume = trigger
                .has("geometry")
                .then(|| read_collider(&trigger, true))
                .flatten();
            if collider.is_some() && volume.is_some() {
                object.tell("trigger", "stands on a node with a collider; left out");
            } else {
                collider = collider.or(volume);
            }
        }
        Self {
            motion: object.object("motion").map(|o| motion(&o)),
            collider,
            joint: object.object("joint").and_then(|o| joint(&o)),
        }
    }
}

/// Returns the mass of an object, and its moments of inertia.
fn mass_and_inertia(object: &Object) -> (Option<f32>, Option<Vec3>) {
    let mass = object.finite("mass").filter(|mass| {
        if *mass < 0.0 {
            object.tell("mass", "is negative; left out");
        }
        *mass >= 0.0
    });
    let inertia = object.finite_vector("inertiaDiagonal").filter(|inertia| {
        let right = inertia.cmpge(Vec3::ZERO).all();
        if !right {
            object.tell("inertiaDiagonal", "is negative; left out");
        }
        right
    });
    (mass, inertia)
}

fn motion(object: &Object) -> Motion {
    let (mass, inertia) = mass_and_inertia(object);
    // Whatever else other programs write there is none of this crate's business.
    let extras = object.raw("extras").and_then(|extras| extras.get(UNLOCKED));
    let unlocked = extras.and_then(|value| {
        let place = format!("{}.{UNLOCKED}", object.place_of("extras"));
        Object::new(value, place, object.told())
    });
    let unlocked = unlocked.as_ref().map(mass_and_inertia);
    let (unlocked_mass, unlocked_inertia) = unlocked.unwrap_or_default();
    let frame = object.numbers::<4>("inertiaOrientation").and_then(|xyzw| {
        let frame = Quat::from_array(xyzw);
        let right = frame.is_finite() && frame.length() > 1e-6 && frame.length() < 1e6;
        if !right {
            object.tell("inertiaOrientation", "is no rotation; left out");
        }
        right.then(|| frame.normalize())
    });
    Motion {
        kinematic: object.flag("isKinematic").unwrap_or(false),
        mass,
        unlocked_mass,
        centre_of_mass: object.finite_vector("centerOfMass"),
        inertia,
        unlocked_inertia,
        inertia_frame: frame.unwrap_or(Quat::IDENTITY),
        linear_velocity: object.finite_vector("linearVelocity").unwrap_or_default(),
        angular_velocity: object.finite_vector("angularVelocity").unwrap_or_default(),
        gravity_factor: object.finite("gravityFactor").unwrap_or(1.0),
    }
}

fn read_collider(object: &Object, trigger: bool) -> Option<Collider> {
    let Some(geometry) = object.object("geometry") else {
        object.tell("geometry", "is missing; left out");
        return None;
    };
    let source = match (geometry.index("shape"), geometry.index("node")) {
        (Some(shape), None) => Source::Shape(shape),
        (None, Some(node)) => Source::Mesh {
            node,
            hull: geometry.flag("convexHull").unwrap_or(false),
        },
        _ => {
            let what = "must have either a shape or a node; left out";
            geometry.told().tell(geometry.place(), what);
            return None;
        }
    };
    Some(Collider {
        source,
        material: object.index("physicsMaterial"),
        filter: object.index("collisionFilter"),
        trigger,
    })
}
