//! What is known of the chosen element in this frame.

use super::figures::Load;
use super::snapshot::Snapshot;
use crate::element::SpringAction;
use crate::input::curve::Curve;
use crate::readout::SpringReadout;
use bevy::prelude::*;

/// What an end is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum EndKind {
    /// It does not exist.
    #[default]
    Missing,
    /// An entity that is no body, nor below one.
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
    /// Its anchor, in the world.
    pub at: Option<Vec3>,
}

/// How finely the crate is told to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stepping {
    /// Of an engine step, s.
    pub dt: f32,
    pub microsteps: u32,
    pub tolerance: Option<f32>,
}

/// All about the chosen element that is not its own numbers.
#[derive(Clone, Debug)]
pub(crate) struct Facts {
    pub readout: SpringReadout,
    /// By Bevy's `Disabled`.
    pub is_disabled: bool,
    pub fault: Option<String>,
    pub ends: [End; 2],
    /// In the world of the engine where its bodies are, m/s².
    pub gravity: f32,
    /// Cosine between gravity and the element, from its still end to its load: 1 of what hangs on it, -1 of what stands on
    /// it. None where nothing says which end is the load.
    pub slope: Option<f32>,
    pub stepping: Stepping,
    /// A function of the game's own takes the place of spring or damper.
    pub custom: [bool; 2],
    pub curve: Option<Curve>,
}

impl Facts {
    /// What the element carries.
    pub fn load(&self) -> Load {
        Load {
            mass: self.readout.effective_mass,
            gravity: self.gravity,
        }
    }

    /// The load where the stiffness of the element says how it gives way.
    pub fn load_of(&self, snapshot: &Snapshot) -> Option<Load> {
        let load = self.load();
        let linear = snapshot.spring_is_linear() && !self.custom[0];
        (linear && load.is_sound()).then_some(load)
    }

    /// Gives an element the stiffness that sags so far, m, and the rest length with which its load stays where it rests:
    /// the same as a [`SpringTuning::sag`](crate::SpringTuning::sag) does for one that is new.
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
        // What a preload carries does not stretch the spring.
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

/// The chosen element.
#[derive(Clone, Debug)]
pub(crate) struct Subject {
    pub entity: Entity,
    pub title: String,
    /// As it is, or will be before the next tick.
    pub now: Snapshot,
    pub facts: Facts,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Preload, SpringAxis, SpringDamper};
    use crate::workbench::model::snapshot::Part;
    use crate::workbench::model::verdict::tests::scene;

    /// Rest length and stiffness for a sag of 0.2 m, of an element with 100 N/m and 1 m under 1 kg at 10 m/s².
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
        // It hangs 0.1 m below the rest length, and shall be 0.2 m below another.
        near(tuned(Some(1.0), |_| ()), 0.9);
        near(tuned(Some(-1.0), |_| ()), 1.1);
        near(tuned(Some(0.0), |_| ()), 1.0);
        near(tuned(None, |_| ()), 1.0);
        // A preload carries all of it, or half.
        near(tuned(Some(1.0), |it| it.preload = Some(Preload(10.0))), 1.0);
        near(tuned(Some(1.0), |it| it.preload = Some(Preload(5.0))), 0.95);
        // A rope below its load does not carry it.
        near(
            tuned(Some(-1.0), |it| it.action = Some(SpringAction::Pull)),
            1.0,
        );
        // No length is below zero, but along an axis.
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
