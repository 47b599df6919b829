//! The memory of a component between steps, as plain data.

use super::{Caution, Component, Kinks};
use crate::dynamics::bound::Bound;
use crate::dynamics::network::Network;
use crate::dynamics::strut::Twists;
use crate::dynamics::tolerance::Controller;
use bevy::math::DVec3;

/// Everything that the next step depends on besides bodies and elements. It contains no buffers, and no values that can
/// be recomputed bit for bit.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Remembered {
    controller: Controller,
    kinks: Kinks,
    caution: Caution,
    bound: Bound,
    /// Accelerations from which the iterations of a network of points start, m/s².
    points: Vec<DVec3>,
    /// Accelerations from which the iterations of any other network start.
    network: Twists,
}

impl Component {
    pub(crate) fn remembered(&self) -> Remembered {
        let memory = &self.memory;
        let points = memory.points.as_deref();
        let network = memory.network.as_deref().and_then(Network::start);
        Remembered {
            controller: memory.controller,
            kinks: memory.kinks,
            caution: memory.caution,
            bound: memory.bound,
            points: points.map_or_else(Vec::new, |points| points.solution().to_vec()),
            network: network.cloned().unwrap_or_default(),
        }
    }

    /// Continues from `remembered`. All bodies and elements are read again.
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
        (memory.caution, memory.bound) = (*caution, bound.if_finite());
        if memory.points.is_some() || !points.is_empty() {
            memory.points.get_or_insert_default().start_from(points);
        }
        if memory.network.is_some() || !network.linear.is_empty() {
            memory.network.get_or_insert_default().start_from(network);
        }
    }
}

impl Remembered {
    /// Number of vectors from which iterations start.
    pub(crate) fn vectors(&self) -> usize {
        self.points.len() + self.network.linear.len() + self.network.angular.len()
    }
}
