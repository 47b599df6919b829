//! Writes `f32` numbers as JSON, in the shortest form that reads back as the same number.

use bevy::prelude::*;
use serde_json::{Map, Number, Value};

/// Returns a number as JSON; `null` for NaN and infinity, which JSON does not have.
pub(super) fn number(x: f32) -> Value {
    let shortest = x.to_string().parse().ok().filter(|_| x.is_finite());
    shortest
        .and_then(Number::from_f64)
        .map_or(Value::Null, Value::Number)
}

pub(super) fn numbers(list: impl IntoIterator<Item = f32>) -> Value {
    list.into_iter().map(number).collect()
}

pub(super) fn vector(v: Vec3) -> Value {
    numbers(v.to_array())
}

/// Returns the path of a number that is NaN or infinite, which is a `null` in JSON, such as `coil.radius`.
pub(super) fn not_finite(value: &Value) -> Option<String> {
    let inside = |key: &str, value: &Value| {
        if value.is_null() {
            return Some(key.to_owned());
        }
        let inner = not_finite(value)?;
        Some(if inner.is_empty() {
            key.to_owned()
        } else {
            format!("{key}.{inner}")
        })
    };
    match value {
        Value::Object(map) => map.iter().find_map(|(key, value)| inside(key, value)),
        // An item has no name of its own.
        Value::Array(list) => list.iter().find_map(|value| inside("", value)),
        _ => None,
    }
}

/// A JSON object under construction. Values that are `null` are left out, but for numbers that are not finite.
#[derive(Default)]
pub(super) struct Fields(Map<String, Value>);

impl Fields {
    pub(super) fn with(mut self, key: &str, value: Value) -> Self {
        self.add(key, value);
        self
    }

    /// Adds a number, or nothing for `None`. One that is NaN or infinite becomes a `null` that stays, so that
    /// [`not_finite`] finds it.
    pub(super) fn add_number(&mut self, key: &str, x: impl Into<Option<f32>>) {
        if let Some(x) = x.into() {
            self.0.insert(key.into(), number(x));
        }
    }

    /// As [`add_number`](Self::add_number).
    pub(super) fn number(mut self, key: &str, x: impl Into<Option<f32>>) -> Self {
        self.add_number(key, x);
        self
    }

    pub(super) fn add(&mut self, key: &str, value: Value) {
        if !value.is_null() {
            self.0.insert(key.into(), value);
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn value(self) -> Value {
        Value::Object(self.0)
    }
}
