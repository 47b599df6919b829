//! What a component remembers from step to step, as plain data.

use super::{Caution, Component, Kinks};
use crate::dynamics::bound::Bound;
use crate::dynamics::strut::Twists;
use crate::dynamics::tolerance::Controller;
use bevy::math::DVec3;

/// All that the next step depends on besides bodies and elements. What is only kept for its memory, or can be worked out
/// again to the last bit, is not among it.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Remembered {
    controller: Controller,
    kinks: Kinks,
    caution: Caution,
    bound: Bound,
    /// Accelerations from which iterations start: of a network of points,
    points: Vec<DVec3>,
    /// and of any other.
    network: Twists,
}

impl Component {
    pub(crate) fn remembered(&self) -> Remembered {
        let memory = &self.memory;
        Remembered {
            controller: memory.controller,
            kinks: memory.kinks,
            caution: memory.caution,
            bound: memory.bound,
            points: memory.points.solution().to_vec(),
            network: memory.network.start().cloned().unwrap_or_default(),
        }
    }

    /// Goes on from there, with all bodies and elements read anew.
    pub(crate) fn remember(&mut self, remembered: &Remembered) {
        let Remembered {
            controller,
            kinks,
            caution,
            bound,
            points,
            network,
        } = remembered;
        self.forget_points();
        let memory = &mut self.memory;
        (memory.controller, memory.kinks) = (*controller, *kinks);
        (memory.caution, memory.bound) = (*caution, *bound);
        memory.points.start_from(points);
        memory.network.start_from(network);
    }
}

impl Remembered {
    /// How many numbers it has for iterations to start from.
    pub(crate) fn vectors(&self) -> usize {
        self.points.len() + self.network.linear.len() + self.network.angular.len()
    }
}
