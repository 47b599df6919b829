//! Reads JSON that may be wrong anywhere. Each error is reported with its place in the file, and the wrong part is
//! left out.

use bevy::prelude::*;
use serde_json::{Map, Value};
use std::cell::RefCell;

/// Errors found in a file.
#[derive(Debug, Default)]
pub(super) struct Told(RefCell<Lines>);

#[derive(Debug, Default)]
struct Lines {
    /// The first errors, at most [`MOST_TOLD`].
    first: Vec<String>,
    /// Number of errors after these.
    more: usize,
}

/// Greatest number of errors that are kept and logged one by one. Of the rest only the number is logged: a broken file may
/// have a million. Pinned by `tests::of_a_million_errors_the_first_are_kept_and_the_rest_are_counted`.
const MOST_TOLD: usize = 32;

impl Told {
    /// Adds an error at a place of the file.
    pub(super) fn tell(&self, place: &str, what: impl std::fmt::Display) {
        let mut lines = self.0.borrow_mut();
        if lines.first.len() < MOST_TOLD {
            lines.first.push(format!("{place}: {what}"));
        } else {
            lines.more += 1;
        }
    }

    /// Logs the errors of a file.
    pub(super) fn log(self, file: &str) {
        let Lines { first, more } = self.0.into_inner();
        for line in first {
            log::warn!("{file}: {line}");
        }
        if more > 0 {
            log::warn!("{file}: and {more} more of that kind");
        }
    }

    /// Returns the errors that are kept.
    #[cfg(test)]
    pub(super) fn lines(&self) -> Vec<String> {
        self.0.borrow().first.clone()
    }

    /// Returns the number of all errors.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        let lines = self.0.borrow();
        lines.first.len() + lines.more
    }
}

/// Greatest magnitude of a number of a body, shape or joint. Larger numbers give infinite squares in Rapier.
const MOST: f32 = 1e12;

/// A JSON object, with its place in the file for messages.
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
    /// Whether the variant has this name. The first letter may be in lower case.
    pub(super) fn is(&self, name: &str) -> bool {
        let first = |text: &str| text.chars().next().map(|c| c.to_ascii_lowercase());
        first(self.name) == first(name) && self.name.get(1..) == name.get(1..)
    }
}

impl<'a> Object<'a> {
    /// Wraps a value that should be an object; reports an error and returns `None` if it is not.
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

    /// Reports an error in the value of a key.
    pub(super) fn tell(&self, key: &str, what: impl std::fmt::Display) {
        self.told.tell(&self.place_of(key), what);
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    pub(super) fn raw(&self, key: &str) -> Option<&'a Value> {
        self.map.get(key)
    }

    /// Reports all keys that are not `known`.
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

    /// Returns a number. One beyond single precision becomes infinite.
    pub(super) fn number(&self, key: &str) -> Option<f32> {
        self.wanted(key, "a number", |v| v.as_f64().map(|x| x as f32))
    }

    /// Returns a number of at most 1e12, which Rapier can use.
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

    /// Returns an array of exactly `N` numbers.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Option<[f32; N]> {
        self.wanted(key, &format!("an array of {N} numbers"), numbers)
    }

    pub(super) fn vector(&self, key: &str) -> Option<Vec3> {
        self.numbers(key).map(Vec3::from_array)
    }

    /// Returns a vector of numbers of at most 1e12, which Rapier can use.
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

    /// Returns the objects of an array, each with its place. An item that is not an object is reported and becomes
    /// `None`.
    pub(super) fn objects(&self, key: &str) -> Vec<Option<Object<'a>>> {
        let place = self.place_of(key);
        let objects = self.list(key).iter().enumerate();
        objects
            .map(|(i, value)| Object::new(value, format!("{place}[{i}]"), self.told))
            .collect()
    }

    /// Returns the strings of an array.
    pub(super) fn texts(&self, key: &str) -> Option<Vec<&'a str>> {
        self.wanted(key, "an array of texts", |value| {
            value.as_array()?.iter().map(Value::as_str).collect()
        })
    }

    /// Returns a variant: a string, or an object with one key.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_million_errors_the_first_are_kept_and_the_rest_are_counted() {
        let told = Told::default();
        for index in 0..1_000_000 {
            told.tell(&format!("node {index}"), "is wrong");
        }
        let lines = told.lines();
        assert_eq!((lines.len(), told.count()), (MOST_TOLD, 1_000_000));
        assert_eq!(lines[MOST_TOLD - 1], "node 31: is wrong");
    }
}
