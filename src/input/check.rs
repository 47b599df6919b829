//! Checks input: bad values become one message with entity and field, never a panic or a NaN.

use crate::dynamics::guide::Guide;
use bevy::math::DVec3;
use bevy::prelude::*;

/// Why an element does not act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    pub field: &'static str,
    pub reason: &'static str,
}

impl Fault {
    /// Fault of a custom law that gives NaN or infinity.
    pub(crate) const UNSOUND_LAW: Self = Self::new("ForceLaw", "gives NaN or infinity");

    pub(crate) const fn new(field: &'static str, reason: &'static str) -> Self {
        Self { field, reason }
    }
}

/// What is wrong with an element. Boxed: mostly nothing is wrong, and then it takes little room in rows that every step
/// reads.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trouble(Option<Box<Faults>>);

#[derive(Clone, Debug, Default)]
struct Faults {
    /// Why the element takes no part at all, found before the step.
    lasting: Option<Fault>,
    /// Why the element does not act in this step, found during the step.
    passing: Option<Fault>,
    /// The fault that was reported last, so that each message comes once.
    said: Option<Fault>,
}

impl Trouble {
    /// Why the element takes no part at all.
    pub(crate) fn lasting(&self) -> Option<Fault> {
        self.0.as_ref()?.lasting
    }

    /// Why the element does not act in this step.
    pub(crate) fn passing(&self) -> Option<Fault> {
        self.0.as_ref()?.passing
    }

    pub(crate) fn set_lasting(&mut self, fault: Option<Fault>) {
        self.set(fault, |faults| &mut faults.lasting);
    }

    pub(crate) fn set_passing(&mut self, fault: Option<Fault>) {
        self.set(fault, |faults| &mut faults.passing);
    }

    /// Takes note that the entity shows a fault. One that was reported before the element was here, such as before it was
    /// disabled, is then replaced or removed like any other.
    pub(crate) fn recall(&mut self) {
        let faults = self.0.get_or_insert_default();
        faults.said.get_or_insert(Fault::new("", ""));
    }

    /// Whether a fault was reported and is still there.
    pub(crate) fn is_told(&self) -> bool {
        self.0.as_ref().is_some_and(|faults| faults.said.is_some())
    }

    fn set(&mut self, fault: Option<Fault>, which: fn(&mut Faults) -> &mut Option<Fault>) {
        if fault.is_some() || self.0.is_some() {
            *which(self.0.get_or_insert_default()) = fault;
        }
    }

    /// Whether there is something to report that was not reported before.
    pub(crate) fn has_news(&self) -> bool {
        let news = |faults: &Faults| faults.said != faults.lasting.or(faults.passing);
        self.0.as_deref().is_some_and(news)
    }

    /// Returns what was not reported before, and marks it as reported: `Some(fault)`, or `Some(None)` if there is no
    /// fault any more. `None` if there is nothing to report.
    pub(crate) fn news(&mut self) -> Option<Option<Fault>> {
        let has_news = self.has_news();
        let faults = self.0.as_mut().filter(|_| has_news)?;
        faults.said = faults.lasting.or(faults.passing);
        Some(faults.said)
    }
}

/// Parameters of an element, whichever component they come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    pub ties: Ties,
    pub numbers: Numbers,
}

/// What holds an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ties {
    pub ends: [Entity; 2],
    pub anchors: [Vec3; 2],
    /// Axis of a torsion element, in body A's frame.
    pub twist: Option<Vec3>,
    /// Component name and its fields, for messages.
    pub names: &'static Names,
}

/// Coefficients and rest length of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Numbers {
    /// Stiffness, N/m or N m/rad.
    pub stiffness: f32,
    /// Damping, N s/m or N m s/rad.
    pub damping: f32,
    /// Rest length, m or rad; `None` until it is captured. That of a damper is irrelevant.
    pub rest_length: Option<f32>,
}

/// Names of fields, for messages. A field that the component does not have is an empty string.
#[derive(Debug, PartialEq)]
pub(crate) struct Names {
    pub ends: [&'static str; 2],
    pub stiffness: &'static str,
    pub damping: &'static str,
    pub rest_length: &'static str,
    pub axis: &'static str,
}

const NO_NAMES: Names = Names {
    ends: ["", ""],
    stiffness: "",
    damping: "",
    rest_length: "",
    axis: "",
};

/// Greatest magnitude of a number that a user gives, in SI units. It is far beyond any real scene, and the product of
/// two such numbers, divided by the least mass and time, still fits into f32. Pinned by the workspace member `attack`.
pub(crate) const MOST: f32 = 1e12;

/// Checks that a number is finite and at most [`MOST`] in magnitude.
pub(crate) fn finite(value: f32, field: &'static str) -> Result<f64, Fault> {
    if value.is_nan() {
        Err(Fault::new(field, "is NaN"))
    } else if value.is_infinite() {
        Err(Fault::new(field, "is infinite"))
    } else if value.abs() > MOST {
        Err(Fault::new(field, "is larger than 1e12"))
    } else {
        Ok(f64::from(value))
    }
}

/// Checks that a number is finite, not negative and at most [`MOST`].
pub(crate) fn number(value: f32, field: &'static str) -> Result<f64, Fault> {
    let value = finite(value, field)?;
    if value < 0.0 {
        return Err(Fault::new(field, "is negative"));
    }
    Ok(value)
}

/// Returns the unit vector along `axis`; a fault if that is zero or not finite.
pub(crate) fn direction(axis: Vec3, field: &'static str) -> Result<DVec3, Fault> {
    let unit = axis.as_dvec3().try_normalize();
    unit.filter(|_| axis.is_finite())
        .ok_or(Fault::new(field, "is zero or not finite"))
}

impl Ties {
    /// Ties of an element whose components cannot be read.
    pub(crate) const NONE: Self = Self {
        ends: [Entity::PLACEHOLDER; 2],
        anchors: [Vec3::ZERO; 2],
        twist: None,
        names: &NO_NAMES,
    };

    /// Whether both are held at the same ends and anchors, about the same axis.
    pub(crate) fn is_held_like(&self, other: &Self) -> bool {
        self.anchors == other.anchors && self.turns_like(other)
    }

    /// Whether an element acts alike on both. Where a torsion element holds its ends has no effect.
    pub(crate) fn acts_like(&self, other: &Self) -> bool {
        self.turns_like(other) && (self.twist.is_some() || self.anchors == other.anchors)
    }

    /// Whether both have the same ends, and the same axis if they have one.
    pub(crate) fn turns_like(&self, other: &Self) -> bool {
        self.ends == other.ends && self.twist == other.twist
    }
}

impl Parameters {
    /// Parameters of an element whose components cannot be read.
    pub(crate) const NONE: Self = Self {
        ties: Ties::NONE,
        numbers: Numbers {
            stiffness: 0.0,
            damping: 0.0,
            rest_length: None,
        },
    };

    /// Axis about which a torsion element acts. Other elements act along the line of centres.
    pub(crate) fn guide(&self) -> Guide {
        self.ties
            .twist
            .and_then(|axis| axis.as_dvec3().try_normalize())
            .map_or(Guide::Centres, Guide::Twist)
    }

    /// Checks the rest length: a length cannot be negative, but an angle or a distance along an axis can.
    pub(crate) fn check_rest(&self, guide: Guide) -> Result<(), Fault> {
        match self.numbers.rest_length {
            Some(length) if guide == Guide::Centres && length < 0.0 => {
                Err(Fault::new(self.ties.names.rest_length, "is negative"))
            }
            _ => Ok(()),
        }
    }

    /// Checks everything that does not depend on where the ends are.
    pub(crate) fn check(&self) -> Result<(), Fault> {
        let Self { ties, numbers } = self;
        let names = ties.names;
        number(numbers.stiffness, names.stiffness)?;
        number(numbers.damping, names.damping)?;
        if let Some(rest_length) = numbers.rest_length {
            finite(rest_length, names.rest_length)?;
        }
        if let Some(axis) = ties.twist {
            direction(axis, names.axis)?;
        }
        for (anchor, field) in ties.anchors.iter().zip(["Anchors::a", "Anchors::b"]) {
            for coordinate in anchor.to_array() {
                finite(coordinate, field)?;
            }
        }
        for (end, field) in ties.ends.iter().zip(names.ends) {
            if *end == Entity::PLACEHOLDER {
                return Err(Fault::new(
                    field,
                    "does not exist yet: give the element its end, or put EndNames beside it",
                ));
            }
        }
        if ties.ends[0] == ties.ends[1] {
            return Err(Fault::new(names.ends[1], "is the same entity as body_a"));
        }
        Ok(())
    }
}
