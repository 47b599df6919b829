//! Reading of JSON that may be wrong anywhere: what is wrong is told with its place and left out.

use bevy::prelude::*;
use serde_json::{Map, Value};
use std::cell::RefCell;

/// What was wrong with a file, each thing once.
#[derive(Debug, Default)]
pub(super) struct Told(RefCell<Vec<String>>);

/// Beyond this many, only their number is told: a broken file may have a million of them.
const MOST_TOLD: usize = 32;

impl Told {
    /// Notes that something at a place is wrong.
    pub(super) fn tell(&self, place: &str, what: impl std::fmt::Display) {
        self.0.borrow_mut().push(format!("{place}: {what}"));
    }

    /// Logs all that was told of a file.
    pub(super) fn log(self, file: &str) {
        let told = self.0.into_inner();
        for line in told.iter().take(MOST_TOLD) {
            log::warn!("{file}: {line}");
        }
        if told.len() > MOST_TOLD {
            log::warn!("{file}: and {} more of that kind", told.len() - MOST_TOLD);
        }
    }

    #[cfg(test)]
    pub(super) fn lines(&self) -> Vec<String> {
        self.0.borrow().clone()
    }
}

/// Most that a number of a body, shape or joint can be: beyond, Rapier's squares are infinite.
const MOST: f32 = 1e12;

/// An object of the file, with its place for messages.
#[derive(Clone)]
pub(super) struct Object<'a> {
    map: &'a Map<String, Value>,
    place: String,
    told: &'a Told,
}

/// A variant of an enum: its name, and its data if it has any.
pub(super) struct Variant<'a> {
    pub(super) name: &'a str,
    pub(super) data: Option<&'a Value>,
    pub(super) place: String,
}

impl Variant<'_> {
    /// Whether it has that name; the first letter may be small.
    pub(super) fn is(&self, name: &str) -> bool {
        let first = |text: &str| text.chars().next().map(|c| c.to_ascii_lowercase());
        first(self.name) == first(name) && self.name.get(1..) == name.get(1..)
    }
}

impl<'a> Object<'a> {
    /// A value that should be an object; told if it is none.
    pub(super) fn new(value: &'a Value, place: String, told: &'a Told) -> Option<Self> {
        let map = value.as_object();
        if map.is_none() {
            told.tell(&place, "is not an object; left out");
        }
        Some(Self {
            map: map?,
            place,
            told,
        })
    }

    pub(super) fn place(&self) -> &str {
        &self.place
    }

    pub(super) fn told(&self) -> &'a Told {
        self.told
    }

    pub(super) fn place_of(&self, key: &str) -> String {
        format!("{}.{key}", self.place)
    }

    /// Tells that the value of a key is wrong.
    pub(super) fn tell(&self, key: &str, what: impl std::fmt::Display) {
        self.told.tell(&self.place_of(key), what);
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    pub(super) fn raw(&self, key: &str) -> Option<&'a Value> {
        self.map.get(key)
    }

    /// Tells of keys that nobody reads.
    pub(super) fn only(&self, known: &[&str]) {
        for key in self.map.keys() {
            if !known.contains(&key.as_str()) && key != "extensions" && key != "extras" {
                self.tell(key, "is not known; left out");
            }
        }
    }

    fn wanted<T>(
        &self,
        key: &str,
        kind: &str,
        read: impl FnOnce(&'a Value) -> Option<T>,
    ) -> Option<T> {
        let value = self.map.get(key)?;
        let read = read(value);
        if read.is_none() {
            self.tell(key, format_args!("is not {kind}; left out"));
        }
        read
    }

    /// A number as it is, which may be beyond single precision and then is infinite.
    pub(super) fn number(&self, key: &str) -> Option<f32> {
        self.wanted(key, "a number", |v| v.as_f64().map(|x| x as f32))
    }

    /// A number that an engine can do with.
    pub(super) fn finite(&self, key: &str) -> Option<f32> {
        self.wanted(key, "a number below 1e12", |v| {
            v.as_f64().map(|x| x as f32).filter(|x| x.abs() <= MOST)
        })
    }

    pub(super) fn flag(&self, key: &str) -> Option<bool> {
        self.wanted(key, "true or false", Value::as_bool)
    }

    pub(super) fn index(&self, key: &str) -> Option<usize> {
        self.wanted(key, "an index", index)
    }

    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        self.wanted(key, "a text", Value::as_str)
    }

    /// So many numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Option<[f32; N]> {
        self.wanted(key, &format!("an array of {N} numbers"), numbers)
    }

    pub(super) fn vector(&self, key: &str) -> Option<Vec3> {
        self.numbers(key).map(Vec3::from_array)
    }

    /// A vector that an engine can do with.
    pub(super) fn finite_vector(&self, key: &str) -> Option<Vec3> {
        let vector = self.vector(key)?;
        if !vector.abs().cmple(Vec3::splat(MOST)).all() {
            self.tell(key, "has a number above 1e12; left out");
            return None;
        }
        Some(vector)
    }

    pub(super) fn object(&self, key: &str) -> Option<Object<'a>> {
        Object::new(self.map.get(key)?, self.place_of(key), self.told)
    }

    pub(super) fn list(&self, key: &str) -> &'a [Value] {
        let list = self.wanted(key, "an array", Value::as_array);
        list.map_or(&[], Vec::as_slice)
    }

    /// The objects of an array, each with its place; those that are none are told of and left out.
    pub(super) fn objects(&self, key: &str) -> Vec<Option<Object<'a>>> {
        let place = self.place_of(key);
        let objects = self.list(key).iter().enumerate();
        objects
            .map(|(i, value)| Object::new(value, format!("{place}[{i}]"), self.told))
            .collect()
    }

    /// Texts of an array.
    pub(super) fn texts(&self, key: &str) -> Option<Vec<&'a str>> {
        self.wanted(key, "an array of texts", |value| {
            value.as_array()?.iter().map(Value::as_str).collect()
        })
    }

    /// A text, or an object with one key.
    pub(super) fn variant(&self, key: &str) -> Option<Variant<'a>> {
        let place = self.place_of(key);
        self.wanted(key, "the name of a variant, or an object of one", |value| {
            let (name, data) = match value {
                Value::String(name) => (name, None),
                Value::Object(map) if map.len() == 1 => {
                    let (name, data) = map.iter().next()?;
                    (name, Some(data))
                }
                _ => return None,
            };
            let place = format!("{place}.{name}");
            Some(Variant { name, data, place })
        })
    }
}

pub(super) fn index(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|index| usize::try_from(index).ok())
}

pub(super) fn numbers<const N: usize>(value: &Value) -> Option<[f32; N]> {
    let list = value.as_array().filter(|list| list.len() == N)?;
    let mut found = [0.0; N];
    for (to, from) in found.iter_mut().zip(list) {
        *to = from.as_f64()? as f32;
    }
    Some(found)
}
