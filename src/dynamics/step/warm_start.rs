//! A network of points from step to step, its bodies and elements left aside.

use super::kinks::Kinks;
use super::{Caution, Component};
use crate::dynamics::body::Body;
use crate::dynamics::points::Points;
use crate::dynamics::tolerance::Controller;

impl Component {
    /// The points, if the last step was as long and they can go on from it.
    pub(crate) fn points_to_continue(&mut self, time: f64) -> Option<&mut Points> {
        let can_go_on = self.memory.carriable == Some(time);
        can_go_on.then_some(&mut self.memory.points)
    }

    /// Has it taken in anew for the next step.
    pub(crate) fn forget_points(&mut self) {
        self.memory.carriable = None;
    }

    /// Forgets all that it knows of the steps so far: the next one is of something else.
    pub(crate) fn forget(&mut self) {
        self.forget_points();
        self.forget_solutions();
        self.memory.kinks = Kinks::default();
        self.memory.bound.forget();
        self.memory.controller = Controller::default();
        self.memory.caution = Caution::default();
    }

    /// Has iterations start from nothing: from what is no number they would come to none.
    pub(crate) fn forget_solutions(&mut self) {
        self.memory.points.forget_solution();
        self.memory.network.forget_solution();
    }

    /// After a step that was [warm](Self::is_warm) to its end: what came of it.
    pub(crate) fn warm_points(&mut self) -> &mut Points {
        &mut self.memory.points
    }

    /// Bodies as they were at the start of a step that could not be carried to its end.
    pub(crate) fn start_bodies(&self) -> &[Body] {
        &self.memory.saved[0].bodies
    }

    /// Bodies and elements take part again, as they were at the start of the step.
    pub(super) fn put_down(&mut self) {
        if std::mem::take(&mut self.is_warm) {
            let points = &self.memory.points;
            points.restore(&mut self.elements, &mut self.bodies);
        }
    }
}
