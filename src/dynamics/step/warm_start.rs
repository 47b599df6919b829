//! Continues a network of points from step to step without its bodies and elements.

use super::kinks::Kinks;
use super::{Caution, Component};
use crate::dynamics::body::Body;
use crate::dynamics::bound::Bound;
use crate::dynamics::points::Points;
use crate::dynamics::tolerance::Controller;

impl Component {
    /// The points, if they can continue from the last step and it was as long as this one.
    pub(crate) fn points_to_continue(&mut self, time: f64) -> Option<&mut Points> {
        let can_go_on = self.memory.carriable == Some(time);
        self.memory.points.as_deref_mut().filter(|_| can_go_on)
    }

    /// Makes the next step load the points anew.
    pub(crate) fn forget_points(&mut self) {
        self.memory.carriable = None;
    }

    /// Forgets everything about earlier steps, because the next step is that of another component.
    pub(crate) fn forget(&mut self) {
        self.forget_points();
        self.forget_solutions();
        self.memory.kinks = Kinks::default();
        self.memory.bound = Bound::default();
        self.memory.controller = Controller::default();
        self.memory.caution = Caution::default();
    }

    /// Makes iterations start from zero. From values that are not finite they would never converge.
    pub(crate) fn forget_solutions(&mut self) {
        if let Some(points) = &mut self.memory.points {
            points.forget_solution();
        }
        if let Some(network) = &mut self.memory.network {
            network.forget_solution();
        }
    }

    /// The points after a step that was [warm](Self::is_warm) to its end.
    pub(crate) fn warm_points(&self) -> Option<&Points> {
        self.memory.points.as_deref()
    }

    /// Bodies at the start of a step that did not end [warm](Self::is_warm).
    pub(crate) fn start_bodies(&self) -> &[Body] {
        match self.memory.saved.first() {
            Some(start) => &start.bodies,
            None => &[],
        }
    }

    /// Ends a warm step. Bodies and elements are used again, in their state at the start of the step.
    pub(super) fn put_down(&mut self) {
        if std::mem::take(&mut self.is_warm)
            && let Some(points) = &self.memory.points
        {
            points.restore(&mut self.elements, &mut self.bodies);
        }
    }
}
