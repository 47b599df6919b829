//! Converts an element's numbers to JSON or RON and back, for copy, paste, save and load.
//!
//! A preset is a map of components by their type paths. It leaves out the ends, so that it fits any two bodies. The
//! JSON is that of Bevy's remote protocol, the RON that of Bevy's scene files.

use super::preset_parts::{KINDS, Numbers, Written, component_of};
use super::snapshot::Snapshot;
use crate::element::*;
use bevy::reflect::{TypePath, TypeRegistry};
use ron::ser::PrettyConfig;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserializer, Serialize, Serializer};
use std::fmt;

/// Stands for "no limit" in JSON, which has no infinity. The sign is kept.
const NO_LIMIT: f32 = f32::MAX;

/// Calls a macro with each companion that a preset can hold: the field of [`Snapshot`] and its type.
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

/// Returns a registry of all types that are needed to read and write a preset.
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

/// Writes an element as JSON.
pub(crate) fn json(snapshot: &Snapshot) -> Result<String, String> {
    let snapshot = limits(snapshot.clone(), f32::INFINITY, NO_LIMIT);
    let preset = Preset {
        snapshot: &snapshot,
        registry: &registry(),
    };
    serde_json::to_string_pretty(&preset).map_err(|wrong| wrong.to_string())
}

/// Writes an element as RON.
pub(crate) fn ron(snapshot: &Snapshot) -> Result<String, String> {
    let preset = Preset {
        snapshot,
        registry: &registry(),
    };
    // Equal on every operating system.
    let config = PrettyConfig::new().new_line("\n");
    ron::ser::to_string_pretty(&preset, config).map_err(|wrong| wrong.to_string())
}

/// Writes an element for a file of this name: RON if the name ends with `.ron`, else JSON.
pub(crate) fn text_for(name: &str, snapshot: &Snapshot) -> Result<String, String> {
    if name.ends_with(".ron") {
        ron(snapshot)
    } else {
        json(snapshot)
    }
}

/// Applies a preset in JSON or RON to an element and returns the result. The ends and, if the preset has none, the
/// anchors stay. Other companions that the preset does not have are removed.
pub(crate) fn apply(text: &str, snapshot: &Snapshot) -> Result<Snapshot, String> {
    let preset = Preset {
        snapshot,
        registry: &registry(),
    };
    if serde_json::from_str::<IgnoredAny>(text).is_ok() {
        let mut json = serde_json::Deserializer::from_str(text);
        return preset
            .deserialize(&mut json)
            .map_err(|wrong| wrong.to_string());
    }
    match ron::from_str::<IgnoredAny>(text) {
        Ok(_) => ron::Options::default()
            .from_str_seed(text, preset)
            .map_err(|wrong| wrong.to_string()),
        Err(wrong) => Err(format!("this is neither JSON nor RON: {wrong}")),
    }
}

/// Replaces the number that stands for "no limit", in upper and lower limits.
fn limits(mut snapshot: Snapshot, from: f32, to: f32) -> Snapshot {
    let change = |value: &mut f32| {
        if value.abs() == from {
            *value = to.copysign(*value);
        }
    };
    if let Some(travel) = &mut snapshot.travel {
        change(&mut travel.min_length);
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

/// The element to be written, or the element that a preset is read into.
struct Preset<'a> {
    snapshot: &'a Snapshot,
    registry: &'a TypeRegistry,
}

impl Serialize for Preset<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use bevy::reflect::serde::TypedReflectSerializer;
        let mut map = serializer.serialize_map(None)?;
        let part = &self.snapshot.part;
        map.serialize_entry(&format!("bevy_coilover::{}", part.name()), &Written(part))?;
        macro_rules! write {
            ($field:ident: $type:ty) => {
                if let Some(value) = &self.snapshot.$field {
                    let value = TypedReflectSerializer::new(value, self.registry);
                    map.serialize_entry(<$type>::type_path(), &value)?;
                }
            };
        }
        companions!(write);
        map.end()
    }
}

impl<'de> DeserializeSeed<'de> for Preset<'_> {
    type Value = Snapshot;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Snapshot, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for Preset<'_> {
    type Value = Snapshot;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a preset: an object of components by their type paths")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Snapshot, A::Error> {
        let mut out = Snapshot::new(self.snapshot.part);
        let mut found = false;
        while let Some(path) = map.next_key::<String>()? {
            let short = path.strip_prefix("bevy_coilover::").unwrap_or(&path);
            let told = |wrong: A::Error| A::Error::custom(format!("{short}: {wrong}"));
            if KINDS.contains(&short) {
                if short.starts_with("Torsion") != out.part.is_torsion() {
                    let name = out.part.name();
                    let wrong = format!("this is a {short}, and the element a {name}");
                    return Err(A::Error::custom(wrong));
                }
                let numbers: Numbers = map.next_value().map_err(told)?;
                numbers.put_into(&mut out.part).map_err(A::Error::custom)?;
                found = true;
                continue;
            }
            macro_rules! read {
                ($field:ident: $type:ty) => {
                    if path == <$type>::type_path() {
                        let value = component_of::<$type, A>(&mut map, self.registry);
                        out.$field = Some(value.map_err(told)?);
                        continue;
                    }
                };
            }
            companions!(read);
            return Err(A::Error::custom(format!("a preset cannot have a {path}")));
        }
        if !found {
            return Err(A::Error::custom("this preset has no spring or damper"));
        }
        let name = out.part.name();
        for (law, has_law, number) in [
            ("SpringLaw", out.spring_law.is_some(), out.part.stiffness()),
            ("DampingLaw", out.damping_law.is_some(), out.part.damping()),
        ] {
            if has_law && number.is_none() {
                let wrong = format!("a {law} does not fit the element, which is a {name}");
                return Err(A::Error::custom(wrong));
            }
        }
        // Anchors belong to the bodies more than to the spring. A preset without anchors leaves them as they are.
        out.anchors = out.anchors.or(self.snapshot.anchors);
        Ok(limits(out, NO_LIMIT, f32::INFINITY))
    }
}
