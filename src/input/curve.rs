//! The law of an element as curves, for display in the workbench.

use crate::dynamics::law::Law;
use crate::input::companions::Beside;
use crate::input::parts::Parts;
use bevy::prelude::*;
use std::sync::Arc;

/// The forces of an element as functions of its length and rate.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    law: Arc<Law>,
    rest: f64,
}

impl Curve {
    /// Returns the forces of an element; `None` if its numbers are wrong or its rest length is not known yet.
    pub(crate) fn of(elements: &Query<(Parts, Beside)>, entity: Entity) -> Option<Self> {
        let (parts, beside) = elements.get(entity).ok()?;
        let p = parts.parameters().ok()?;
        p.check().ok()?;
        let companion = beside.companion(&p).ok()?;
        let law = companion.law.unwrap_or_else(|| {
            let [stiffness, damping] = [p.numbers.stiffness, p.numbers.damping].map(f64::from);
            Arc::new(Law::linear(stiffness, damping))
        });
        let rest = f64::from(p.numbers.rest_length?);
        Some(Self { law, rest })
    }

    /// Tension of spring and stops at a length (m), N.
    pub(crate) fn spring(&self, length: f64) -> f64 {
        self.law.elastic(length, self.rest).force
    }

    /// Tension of the damper and of the stops' dampers at a length (m) and a rate (m/s), N.
    pub(crate) fn damper(&self, length: f64, rate: f64) -> f64 {
        self.law.drag(length, self.rest, rate).force
    }
}
