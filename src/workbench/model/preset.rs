//! An element's numbers as JSON, and back: what is copied, saved and loaded.
//!
//! It is an object of components by their type paths, as Bevy's remote protocol and scene files have them, without the
//! ends: a preset fits any two bodies.

use super::snapshot::{Part, Snapshot};
use crate::element::*;
use bevy::prelude::*;
use bevy::reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy::reflect::{GetTypeRegistration, TypePath, TypeRegistry};
use serde::de::DeserializeSeed;
use serde_json::{Map, Value};

/// Where a limit stands for none; JSON has no infinity.
const NO_LIMIT: f32 = f32::MAX;

/// What can stand in a preset beside the element itself, and where it goes.
macro_rules! companions {
    ($action:ident) => {
        $action!(anchors: Anchors);
        $action!(spring_law: SpringLaw);
        $action!(damping_law: DampingLaw);
        $action!(action: SpringAction);
        $action!(travel: SpringTravel);
        $action!(axis: SpringAxis);
        $action!(preload: Preload);
        $action!(max_force: MaxForce);
        $action!(breakable: Breakable);
    };
}

/// All types that are needed to read and write a preset.
fn registry() -> TypeRegistry {
    let mut registry = TypeRegistry::new();
    macro_rules! register {
        ($field:ident: $type:ty) => {
            registry.register::<$type>();
        };
    }
    companions!(register);
    registry
}

/// The element as JSON.
pub(crate) fn json(snapshot: &Snapshot) -> Result<String, String> {
    let registry = registry();
    let mut out = Map::new();
    out.insert(path(&snapshot.part), numbers(&snapshot.part));
    let snapshot = limits(snapshot.clone(), f32::INFINITY, NO_LIMIT);
    macro_rules! write {
        ($field:ident: $type:ty) => {
            if let Some(value) = &snapshot.$field {
                let value = serde_json::to_value(TypedReflectSerializer::new(value, &registry));
                let value = value.map_err(|wrong| wrong.to_string())?;
                out.insert(<$type>::type_path().into(), value);
            }
        };
    }
    companions!(write);
    serde_json::to_string_pretty(&Value::Object(out)).map_err(|wrong| wrong.to_string())
}

/// Puts a preset into an element; its ends stay. What the preset has not is removed.
pub(crate) fn apply(text: &str, snapshot: &Snapshot) -> Result<Snapshot, String> {
    let value: Value =
        serde_json::from_str(text).map_err(|wrong| format!("this is not JSON: {wrong}"))?;
    let Value::Object(mut components) = value else {
        return Err("a preset is an object of components by their type paths".into());
    };
    let mut out = Snapshot::new(snapshot.part);
    let mut found = false;
    for kind in [
        "Spring",
        "Damper",
        "SpringDamper",
        "TorsionSpring",
        "TorsionDamper",
        "TorsionSpringDamper",
    ] {
        if let Some(numbers) = components.remove(&format!("bevy_coilover::{kind}")) {
            if kind.starts_with("Torsion") != snapshot.part.is_torsion() {
                return Err(format!(
                    "this is a {kind}, and the element a {}",
                    snapshot.part.name()
                ));
            }
            take_numbers(&mut out.part, &numbers)?;
            found = true;
        }
    }
    if !found {
        return Err("this preset has no spring or damper".into());
    }
    let registry = registry();
    macro_rules! read {
        ($field:ident: $type:ty) => {
            out.$field = match components.remove(<$type>::type_path()) {
                Some(value) => Some(component::<$type>(value, &registry)?),
                None => None,
            };
        };
    }
    companions!(read);
    // An anchor belongs to the bodies more than to the spring: a preset that has none leaves it.
    out.anchors = out.anchors.or(snapshot.anchors);
    if let Some(stranger) = components.keys().next() {
        return Err(format!("a preset cannot have a {stranger}"));
    }
    Ok(limits(out, NO_LIMIT, f32::INFINITY))
}

/// With one number for no limit in the place of another.
fn limits(mut snapshot: Snapshot, from: f32, to: f32) -> Snapshot {
    let change = |value: &mut f32| {
        if *value == from {
            *value = to;
        }
    };
    if let Some(travel) = &mut snapshot.travel {
        change(&mut travel.max_length);
    }
    if let Some(limit) = &mut snapshot.breakable {
        change(&mut limit.force);
        change(&mut limit.length);
    }
    if let Some(limit) = &mut snapshot.max_force {
        change(&mut limit.0);
    }
    snapshot
}

fn component<T: TypePath + FromReflect + GetTypeRegistration>(
    value: Value,
    registry: &TypeRegistry,
) -> Result<T, String> {
    let name = T::short_type_path();
    let read = TypedReflectDeserializer::of::<T>(registry).deserialize(value);
    let read = read.map_err(|wrong| format!("{name}: {wrong}"))?;
    T::from_reflect(&*read).ok_or_else(|| format!("{name} is not complete"))
}

fn path(part: &Part) -> String {
    format!("bevy_coilover::{}", part.name())
}

/// The name of the rest length's field.
fn rest_name(part: &Part) -> &'static str {
    if part.is_torsion() {
        "rest_angle"
    } else {
        "rest_length"
    }
}

fn numbers(part: &Part) -> Value {
    let mut out = Map::new();
    let mut copy = *part;
    if let Some(axis) = part.twist() {
        out.insert("axis".into(), axis.to_array().to_vec().into());
    }
    if let Some(rest) = copy.rest_mut() {
        out.insert(rest_name(part).into(), (*rest).into());
    }
    if let Some(stiffness) = part.stiffness() {
        out.insert("stiffness".into(), stiffness.into());
    }
    if let Some(damping) = part.damping() {
        out.insert("damping".into(), damping.into());
    }
    Value::Object(out)
}

fn take_numbers(part: &mut Part, numbers: &Value) -> Result<(), String> {
    let number = |name: &str| match numbers.get(name) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => match value.as_f64().map(|value| value as f32) {
            Some(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(format!("{name} is not a number")),
        },
    };
    let rest = number(rest_name(part))?;
    if let (Some(mine), Some(value)) = (part.stiffness_mut(), number("stiffness")?) {
        *mine = value;
    }
    if let (Some(mine), Some(value)) = (part.damping_mut(), number("damping")?) {
        *mine = value;
    }
    if numbers.get(rest_name(part)).is_some()
        && let Some(mine) = part.rest_mut()
    {
        *mine = rest;
    }
    if let (Some(mine), Some(Value::Array(axis))) = (part.twist_mut(), numbers.get("axis")) {
        let axis: Vec<_> = axis.iter().filter_map(Value::as_f64).collect();
        let [x, y, z] = axis[..] else {
            return Err("axis is not three numbers".into());
        };
        *mine = Vec3::new(x as f32, y as f32, z as f32);
    }
    Ok(())
}
