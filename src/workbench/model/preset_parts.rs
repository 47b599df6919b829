//! Reads and writes the parts of a preset: the element's own numbers, and one companion.

use super::snapshot::Part;
use bevy::prelude::*;
use bevy::reflect::serde::TypedReflectDeserializer;
use bevy::reflect::{GetTypeRegistration, TypePath, TypeRegistry};
use serde::de::{Error, MapAccess};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Names of the components that make an entity an element.
pub(super) const KINDS: [&str; 6] = [
    "Spring",
    "Damper",
    "SpringDamper",
    "TorsionSpring",
    "TorsionDamper",
    "TorsionSpringDamper",
];

/// Writes an element's own numbers like its component, but without the ends.
pub(super) struct Written<'a>(pub &'a Part);

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut part = *self.0;
        let axis = part.twist().map(|axis| axis.to_array());
        let rest = part.rest_mut().map(|rest| *rest);
        let (stiffness, damping) = (part.stiffness(), part.damping());
        let count = [
            axis.is_some(),
            rest.is_some(),
            stiffness.is_some(),
            damping.is_some(),
        ];
        let count = count.into_iter().filter(|there| *there).count();
        let mut out = serializer.serialize_struct(part.name(), count)?;
        if let Some(axis) = axis {
            out.serialize_field("axis", &axis)?;
        }
        if let Some(rest) = rest {
            out.serialize_field(rest_name(&part), &rest)?;
        }
        if let Some(stiffness) = stiffness {
            out.serialize_field("stiffness", &stiffness)?;
        }
        if let Some(damping) = damping {
            out.serialize_field("damping", &damping)?;
        }
        out.end()
    }
}

/// Returns the field name of the rest length or rest angle.
fn rest_name(part: &Part) -> &'static str {
    if part.is_torsion() {
        "rest_angle"
    } else {
        "rest_length"
    }
}

/// An element's own numbers in a preset. A missing number leaves the element's number as it is. Ends, which a scene
/// file has, are skipped.
#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Numbers {
    #[serde(deserialize_with = "there")]
    axis: Option<[f32; 3]>,
    #[serde(deserialize_with = "there")]
    rest_length: Option<Option<f32>>,
    #[serde(deserialize_with = "there")]
    rest_angle: Option<Option<f32>>,
    #[serde(deserialize_with = "there")]
    stiffness: Option<f32>,
    #[serde(deserialize_with = "there")]
    damping: Option<f32>,
}

/// Reads a present field as it is. In RON, `Some` then stands only around fields that are optional in the component.
fn there<'de, T: Deserialize<'de>, D: Deserializer<'de>>(from: D) -> Result<Option<T>, D::Error> {
    T::deserialize(from).map(Some)
}

impl Numbers {
    pub fn put_into(self, part: &mut Part) -> Result<(), String> {
        let rest = if part.is_torsion() {
            self.rest_angle
        } else {
            self.rest_length
        };
        let finite = |name: &str, value: Option<f32>| match value {
            Some(value) if !value.is_finite() => Err(format!("{name} is not a number")),
            _ => Ok(value),
        };
        finite(rest_name(part), rest.flatten())?;
        if let (Some(mine), Some(rest)) = (part.rest_mut(), rest) {
            *mine = rest;
        }
        let (stiffness, damping) = (
            finite("stiffness", self.stiffness)?,
            finite("damping", self.damping)?,
        );
        if let (Some(mine), Some(stiffness)) = (part.stiffness_mut(), stiffness) {
            *mine = stiffness;
        }
        if let (Some(mine), Some(damping)) = (part.damping_mut(), damping) {
            *mine = damping;
        }
        if let (Some(mine), Some(axis)) = (part.twist_mut(), self.axis) {
            *mine = Vec3::from_array(axis);
        }
        Ok(())
    }
}

/// Reads a companion of an element.
pub(super) fn component_of<'de, T, A>(map: &mut A, registry: &TypeRegistry) -> Result<T, A::Error>
where
    T: TypePath + FromReflect + GetTypeRegistration,
    A: MapAccess<'de>,
{
    let read = map.next_value_seed(TypedReflectDeserializer::of::<T>(registry))?;
    T::from_reflect(&*read).ok_or_else(|| A::Error::custom("it is not complete"))
}
