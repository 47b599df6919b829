//! What is known of the chosen element in this frame.

use super::figures::Load;
use super::snapshot::Snapshot;
use crate::engine::Curve;
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
    pub fault: Option<String>,
    pub ends: [End; 2],
    pub gravity: f32,
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
