//! Bad input becomes one message with entity and field, never a panic or a NaN.

use crate::element::{Anchors, Damper, Spring, SpringDamper};
use bevy::prelude::*;

/// Why an element does not act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fault {
    pub field: &'static str,
    pub reason: &'static str,
}

impl Fault {
    pub(super) const fn new(field: &'static str, reason: &'static str) -> Self {
        Self { field, reason }
    }
}

/// The numbers of an element, whichever component they came from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    pub ends: [Entity; 2],
    pub stiffness: f32,
    pub damping: f32,
    /// `None` until captured; a damper's is irrelevant.
    pub rest_length: Option<f32>,
    pub anchors: [Vec3; 2],
    /// Component name and its fields, for messages.
    pub names: &'static Names,
}

/// Fields as messages name them.
#[derive(Debug)]
pub(super) struct Names {
    pub ends: [&'static str; 2],
    pub stiffness: &'static str,
    pub damping: &'static str,
    pub rest_length: &'static str,
}

const SPRING: Names = Names {
    ends: ["Spring::body_a", "Spring::body_b"],
    stiffness: "Spring::stiffness",
    damping: "",
    rest_length: "Spring::rest_length",
};
const DAMPER: Names = Names {
    ends: ["Damper::body_a", "Damper::body_b"],
    stiffness: "",
    damping: "Damper::damping",
    rest_length: "",
};
const SPRING_DAMPER: Names = Names {
    ends: ["SpringDamper::body_a", "SpringDamper::body_b"],
    stiffness: "SpringDamper::stiffness",
    damping: "SpringDamper::damping",
    rest_length: "SpringDamper::rest_length",
};

const NO_NAMES: Names = Names {
    ends: ["", ""],
    stiffness: "",
    damping: "",
    rest_length: "",
};

impl Parameters {
    /// Of an element whose components cannot be read.
    pub(super) const NONE: Self = Self {
        ends: [Entity::PLACEHOLDER; 2],
        stiffness: 0.0,
        damping: 0.0,
        rest_length: None,
        anchors: [Vec3::ZERO; 2],
        names: &NO_NAMES,
    };

    /// Whether another set of numbers belongs to the same two ends.
    pub(super) fn is_held_like(&self, other: &Self) -> bool {
        self.ends == other.ends && self.anchors == other.anchors
    }

    /// Reads whichever component is there.
    pub(super) fn read(
        spring: Option<&Spring>,
        damper: Option<&Damper>,
        pair: Option<&SpringDamper>,
        anchors: Option<&Anchors>,
    ) -> Result<Self, Fault> {
        let anchors = anchors.copied().unwrap_or_default();
        let anchors = [anchors.a, anchors.b];
        match (spring, damper, pair) {
            (Some(s), None, None) => Ok(Self {
                ends: [s.body_a, s.body_b],
                stiffness: s.stiffness,
                damping: 0.0,
                rest_length: s.rest_length,
                anchors,
                names: &SPRING,
            }),
            (None, Some(d), None) => Ok(Self {
                ends: [d.body_a, d.body_b],
                stiffness: 0.0,
                damping: d.damping,
                // Any length but zero will do: zero means an isotropic spring.
                rest_length: Some(1.0),
                anchors,
                names: &DAMPER,
            }),
            (None, None, Some(p)) => Ok(Self {
                ends: [p.body_a, p.body_b],
                stiffness: p.stiffness,
                damping: p.damping,
                rest_length: p.rest_length,
                anchors,
                names: &SPRING_DAMPER,
            }),
            _ => Err(Fault::new(
                "Spring, Damper, SpringDamper",
                "stand together on one entity; use one of them, or SpringDamper for both at once",
            )),
        }
    }

    /// Everything that can be judged without looking at the ends.
    pub(super) fn check(&self) -> Result<(), Fault> {
        let number = |value: f32, field| {
            if value.is_nan() {
                Err(Fault::new(field, "is NaN"))
            } else if value.is_infinite() {
                Err(Fault::new(field, "is infinite"))
            } else if value < 0.0 {
                Err(Fault::new(field, "is negative"))
            } else {
                Ok(())
            }
        };
        number(self.stiffness, self.names.stiffness)?;
        number(self.damping, self.names.damping)?;
        if let Some(rest_length) = self.rest_length {
            number(rest_length, self.names.rest_length)?;
        }
        for (anchor, field) in self.anchors.iter().zip(["Anchors::a", "Anchors::b"]) {
            if !anchor.is_finite() {
                return Err(Fault::new(field, "is not finite"));
            }
        }
        if self.ends[0] == self.ends[1] {
            return Err(Fault::new(
                self.names.ends[1],
                "is the same entity as body_a",
            ));
        }
        Ok(())
    }
}
