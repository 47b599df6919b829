//! What is known about the chosen element in this frame, apart from its own numbers.

use super::figures::Load;
use super::snapshot::Snapshot;
use crate::element::SpringAction;
use crate::input::curve::Curve;
use crate::readout::SpringReadout;
use bevy::prelude::*;

/// Kind of entity that an end is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum EndKind {
    /// The entity does not exist or has no `GlobalTransform`.
    #[default]
    Missing,
    /// An entity that is not a body and has no ancestor that is one.
    Point,
    Fixed,
    Kinematic,
    Dynamic,
}

/// One end of an element.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct End {
    pub name: String,
    pub kind: EndKind,
    pub asleep: bool,
    /// Position of the anchor in the world, m.
    pub at: Option<Vec3>,
}

/// Settings of the step size and accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stepping {
    /// Length of an engine step, s.
    pub dt: f32,
    pub microsteps: u32,
    pub tolerance: Option<f32>,
}

/// Everything about the chosen element except its own numbers.
#[derive(Clone, Debug)]
pub(crate) struct Facts {
    pub readout: SpringReadout,
    /// Whether the element has Bevy's `Disabled` component.
    pub is_disabled: bool,
    pub fault: Option<String>,
    pub ends: [End; 2],
    /// Magnitude of gravity on its bodies, m/s².
    pub gravity: f32,
    /// Cosine between gravity and the direction from the end that is not dynamic to the dynamic end, the load. It is
    /// 1 for a hanging load and -1 for a load that stands on the element. `None` if not exactly one end is dynamic.
    pub slope: Option<f32>,
    pub stepping: Stepping,
    /// Whether the game's own function replaces the law of the spring and of the damper.
    pub custom: [bool; 2],
    pub curve: Option<Curve>,
}

impl Facts {
    /// Returns the effective mass and the gravity.
    pub fn load(&self) -> Load {
        Load {
            mass: self.readout.effective_mass,
            gravity: self.gravity,
        }
    }

    /// Returns the load if the stiffness alone determines how the element yields: the spring is linear and the mass
    /// is valid.
    pub fn load_of(&self, snapshot: &Snapshot) -> Option<Load> {
        let load = self.load();
        let linear = snapshot.spring_is_linear() && !self.custom[0];
        (linear && load.is_sound()).then_some(load)
    }

    /// Whether the damping of the element alone determines the damper's force.
    pub fn damper_is_linear(&self, snapshot: &Snapshot) -> bool {
        snapshot.damper_is_linear() && !self.custom[1]
    }

    /// Sets the stiffness that gives a sag, m, and the rest length with which the load stays where it rests.
    /// [`SpringTuning::sag`](crate::SpringTuning::sag) does this for a new element.
    pub fn set_sag(&self, element: &mut Snapshot, sag: f32) {
        let Some(load) = self.load_of(element) else {
            return;
        };
        let stiffness = load.stiffness_for_sag(sag);
        let Some(before) = element.part.stiffness() else {
            return;
        };
        if !(stiffness.is_finite() && stiffness > 0.0) {
            return;
        }
        // The part of the weight that a preload carries does not stretch the spring.
        let weight = self.slope.map(|slope| load.mass * load.gravity * slope);
        let carries = |tension: &f32| match element.action {
            Some(SpringAction::Pull) => *tension > 0.0,
            Some(SpringAction::Push) => *tension < 0.0,
            None | Some(SpringAction::Both) => true,
        };
        let tension = weight
            .filter(carries)
            .map_or(0.0, |weight| weight - element.preload.unwrap_or_default().0);
        let least = if element.has_sign() {
            f32::NEG_INFINITY
        } else {
            0.0
        };
        if let Some(Some(rest)) = element.part.rest_mut() {
            let moved = *rest + tension * (before.recip() - stiffness.recip());
            if moved.is_finite() {
                *rest = moved.max(least);
            }
        }
        if let Some(mine) = element.part.stiffness_mut() {
            *mine = stiffness;
        }
    }
}

/// The chosen element, with its numbers and facts.
#[derive(Clone, Debug)]
pub(crate) struct Subject {
    pub entity: Entity,
    pub title: String,
    /// Numbers of the element as they will be at the next tick, with all pending edits.
    pub now: Snapshot,
    pub facts: Facts,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Preload, SpringAxis, SpringDamper};
    use crate::workbench::model::snapshot::Part;
    use crate::workbench::model::verdict::tests::scene;

    /// Returns rest length and stiffness after a sag of 0.2 m is set for an element of 100 N/m and 1 m, under 1 kg at
    /// 10 m/s².
    fn tuned(slope: Option<f32>, change: impl Fn(&mut Snapshot)) -> (f32, f32) {
        let (now, mut facts) = scene();
        let [a, b] = now.part.ends();
        let pair = SpringDamper::new(a, b)
            .with_stiffness(100.0)
            .with_rest_length(1.0);
        let mut element = Snapshot::new(Part::SpringDamper(pair));
        change(&mut element);
        (facts.gravity, facts.slope) = (10.0, slope);
        facts.set_sag(&mut element, 0.2);
        let rest = element.part.rest().expect("a rest length");
        (rest, element.part.stiffness().expect("a spring"))
    }

    #[test]
    fn the_load_stays_where_it_rests() {
        let near = |(rest, stiffness): (f32, f32), expected: f32| {
            assert!((rest - expected).abs() < 1e-6, "{rest} m for {expected} m");
            assert!((stiffness - 50.0).abs() < 1e-4, "{stiffness} N/m");
        };
        // The load hangs 0.1 m below the rest length, and shall hang 0.2 m below the new one.
        near(tuned(Some(1.0), |_| ()), 0.9);
        near(tuned(Some(-1.0), |_| ()), 1.1);
        near(tuned(Some(0.0), |_| ()), 1.0);
        near(tuned(None, |_| ()), 1.0);
        // A preload carries all of the weight, or half of it.
        near(tuned(Some(1.0), |it| it.preload = Some(Preload(10.0))), 1.0);
        near(tuned(Some(1.0), |it| it.preload = Some(Preload(5.0))), 0.95);
        // A rope cannot carry a load above it.
        near(
            tuned(Some(-1.0), |it| it.action = Some(SpringAction::Pull)),
            1.0,
        );
        // A length cannot be negative, except along an axis.
        let short = |it: &mut Snapshot| {
            if let Some(rest) = it.part.rest_mut() {
                *rest = Some(0.05);
            }
        };
        near(tuned(Some(1.0), short), 0.0);
        let along = |it: &mut Snapshot| {
            short(it);
            it.axis = Some(SpringAxis::World(Vec3::NEG_Y));
        };
        near(tuned(Some(1.0), along), -0.05);
    }

    #[test]
    fn a_sag_that_is_no_length_changes_nothing() {
        let (now, mut facts) = scene();
        facts.slope = Some(1.0);
        for sag in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let mut element = now.clone();
            facts.set_sag(&mut element, sag);
            assert_eq!(element, now, "{sag}");
        }
    }
}
