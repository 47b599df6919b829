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

/// A JSON object under construction. Values that are `null` are left out.
#[derive(Default)]
pub(super) struct Fields(Map<String, Value>);

impl Fields {
    pub(super) fn with(mut self, key: &str, value: Value) -> Self {
        self.add(key, value);
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
