//! The components of an element, whichever they are, as one set of numbers.

use crate::element::{
    Anchors, AwaitsEnds, Damper, Spring, SpringDamper, SpringFault, TorsionDamper, TorsionSpring,
    TorsionSpringDamper,
};
use crate::input::check::{Fault, Names, Numbers, Parameters, Ties};
use crate::input::lists::with_elements;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// The components that make up an element.
#[derive(QueryData)]
pub(crate) struct Parts {
    pub entity: Entity,
    /// Whether the entity shows a fault.
    pub told: Has<SpringFault>,
    spring: Option<Ref<'static, Spring>>,
    damper: Option<Ref<'static, Damper>>,
    pair: Option<Ref<'static, SpringDamper>>,
    torsion_spring: Option<Ref<'static, TorsionSpring>>,
    torsion_damper: Option<Ref<'static, TorsionDamper>>,
    torsion_pair: Option<Ref<'static, TorsionSpringDamper>>,
    anchors: Option<Ref<'static, Anchors>>,
}

macro_rules! filters {
    ($($element:ident),*) => {
        /// Filter: the entity is an element.
        pub(crate) type IsElement = Or<($(With<$element>,)*)>;

        /// Filter: some part of the element changed.
        pub(crate) type ChangedParts = Or<($(Changed<$element>,)* Changed<Anchors>)>;
    };
}
with_elements!(filters);

/// Filter: the element acts along a line, and not about an axis.
pub(crate) type IsLinear = Or<(With<Spring>, With<Damper>, With<SpringDamper>)>;

/// Filter: the element takes part. One that waits for a named end does not.
pub(crate) type Acts = (IsElement, Without<AwaitsEnds>);

/// Makes the [`Names`] of a component, with the arguments in the order of the fields.
const fn names(
    ends: [&'static str; 2],
    stiffness: &'static str,
    damping: &'static str,
    rest_length: &'static str,
    axis: &'static str,
) -> Names {
    Names {
        ends,
        stiffness,
        damping,
        rest_length,
        axis,
    }
}

const SPRING: Names = names(
    ["Spring::body_a", "Spring::body_b"],
    "Spring::stiffness",
    "",
    "Spring::rest_length",
    "",
);
const DAMPER: Names = names(
    ["Damper::body_a", "Damper::body_b"],
    "",
    "Damper::damping",
    "",
    "",
);
const PAIR: Names = names(
    ["SpringDamper::body_a", "SpringDamper::body_b"],
    "SpringDamper::stiffness",
    "SpringDamper::damping",
    "SpringDamper::rest_length",
    "",
);
const TORSION_SPRING: Names = names(
    ["TorsionSpring::body_a", "TorsionSpring::body_b"],
    "TorsionSpring::stiffness",
    "",
    "TorsionSpring::rest_angle",
    "TorsionSpring::axis",
);
const TORSION_DAMPER: Names = names(
    ["TorsionDamper::body_a", "TorsionDamper::body_b"],
    "",
    "TorsionDamper::damping",
    "",
    "TorsionDamper::axis",
);
const TORSION_PAIR: Names = names(
    ["TorsionSpringDamper::body_a", "TorsionSpringDamper::body_b"],
    "TorsionSpringDamper::stiffness",
    "TorsionSpringDamper::damping",
    "TorsionSpringDamper::rest_angle",
    "TorsionSpringDamper::axis",
);

/// Rest length of a damper. Any value but zero will do, because zero means an isotropic spring.
const NO_MATTER: Option<f32> = Some(1.0);

impl PartsItem<'_, '_> {
    pub(crate) fn is_changed(&self) -> bool {
        fn changed<T: Component>(part: &Option<Ref<T>>) -> bool {
            part.as_ref().is_some_and(Ref::is_changed)
        }
        changed(&self.pair)
            || changed(&self.spring)
            || changed(&self.damper)
            || changed(&self.anchors)
            || changed(&self.torsion_spring)
            || changed(&self.torsion_damper)
            || changed(&self.torsion_pair)
    }

    /// Whether some part changed after the tick `since`.
    pub(crate) fn is_changed_after(&self, since: Tick, now: Tick) -> bool {
        let after = |changed: Option<Tick>| changed.is_some_and(|at| at.is_newer_than(since, now));
        fn at<T: Component>(part: &Option<Ref<T>>) -> Option<Tick> {
            part.as_ref().map(Ref::last_changed)
        }
        after(at(&self.pair))
            || after(at(&self.spring))
            || after(at(&self.damper))
            || after(at(&self.anchors))
            || after(at(&self.torsion_spring))
            || after(at(&self.torsion_damper))
            || after(at(&self.torsion_pair))
    }

    /// Returns both ends, if the element can be read.
    #[cfg(feature = "workbench")]
    pub(crate) fn ends(&self) -> Option<[Entity; 2]> {
        self.parameters().ok().map(|p| p.ties.ends)
    }

    /// Reads the element component of the entity; a fault if there is not exactly one.
    pub(crate) fn parameters(&self) -> Result<Parameters, Fault> {
        let anchors = self.anchors.as_deref().copied().unwrap_or_default();
        let mut found = None;
        let mut count = 0;
        let mut add = |ends, stiffness, damping, rest_length, twist, names| {
            count += 1;
            found = Some(Parameters {
                ties: Ties {
                    ends,
                    anchors: [anchors.a, anchors.b],
                    twist,
                    names,
                },
                numbers: Numbers {
                    stiffness,
                    damping,
                    rest_length,
                },
            });
        };
        if let Some(s) = &self.spring {
            let ends = [s.body_a, s.body_b];
            add(ends, s.stiffness, 0.0, s.rest_length, None, &SPRING);
        }
        if let Some(d) = &self.damper {
            let ends = [d.body_a, d.body_b];
            add(ends, 0.0, d.damping, NO_MATTER, None, &DAMPER);
        }
        if let Some(p) = &self.pair {
            let ends = [p.body_a, p.body_b];
            add(ends, p.stiffness, p.damping, p.rest_length, None, &PAIR);
        }
        if let Some(s) = &self.torsion_spring {
            let (ends, axis) = ([s.body_a, s.body_b], Some(s.axis));
            add(ends, s.stiffness, 0.0, s.rest_angle, axis, &TORSION_SPRING);
        }
        if let Some(d) = &self.torsion_damper {
            let (ends, axis) = ([d.body_a, d.body_b], Some(d.axis));
            add(ends, 0.0, d.damping, NO_MATTER, axis, &TORSION_DAMPER);
        }
        if let Some(p) = &self.torsion_pair {
            let (ends, axis) = ([p.body_a, p.body_b], Some(p.axis));
            add(
                ends,
                p.stiffness,
                p.damping,
                p.rest_angle,
                axis,
                &TORSION_PAIR,
            );
        }
        match (found, count) {
            (Some(found), 1) => Ok(found),
            _ => Err(self.several()),
        }
    }

    /// The fault of an entity that has several elements.
    fn several(&self) -> Fault {
        let lines = self.spring.is_some() || self.damper.is_some() || self.pair.is_some();
        let twists = self.torsion_spring.is_some()
            || self.torsion_damper.is_some()
            || self.torsion_pair.is_some();
        let (field, reason) = match (lines, twists) {
            (true, true) => (
                "Spring, Damper, SpringDamper",
                "stand together with a torsion element on one entity; give each an entity of its own",
            ),
            (_, false) => (
                "Spring, Damper, SpringDamper",
                "stand together on one entity; use one of them, or SpringDamper for both at once",
            ),
            (false, true) => (
                "TorsionSpring, TorsionDamper, TorsionSpringDamper",
                "stand together on one entity; use one of them, or TorsionSpringDamper for both at once",
            ),
        };
        Fault::new(field, reason)
    }
}
