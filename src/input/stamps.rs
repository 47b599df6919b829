//! When what stands beside an element changed last.

use crate::element::*;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::query::QueryData;
use bevy::prelude::*;

/// Of each, when that was.
#[derive(QueryData)]
pub(crate) struct Stamps {
    laws: (
        Option<Ref<'static, SpringLaw>>,
        Option<Ref<'static, CustomSpringLaw>>,
        Option<Ref<'static, DampingLaw>>,
        Option<Ref<'static, CustomDampingLaw>>,
    ),
    action: Option<Ref<'static, SpringAction>>,
    travel: Option<Ref<'static, SpringTravel>>,
    preload: Option<Ref<'static, Preload>>,
    max_force: Option<Ref<'static, MaxForce>>,
    axis: Option<Ref<'static, SpringAxis>>,
    breakable: Option<Ref<'static, Breakable>>,
    tuning: Option<Ref<'static, SpringTuning>>,
    pose: Option<Ref<'static, HoldPose>>,
}

impl StampsItem<'_, '_> {
    /// Whether any of them changed after a tick.
    pub(crate) fn is_after(&self, since: Tick, now: Tick) -> bool {
        fn at<T: Component>(part: &Option<Ref<T>>) -> Option<Tick> {
            part.as_ref().map(Ref::last_changed)
        }
        let all = [
            at(&self.laws.0),
            at(&self.laws.1),
            at(&self.laws.2),
            at(&self.laws.3),
            at(&self.action),
            at(&self.travel),
            at(&self.preload),
            at(&self.max_force),
            at(&self.axis),
            at(&self.breakable),
            at(&self.tuning),
            at(&self.pose),
        ];
        all.into_iter()
            .flatten()
            .any(|at| at.is_newer_than(since, now))
    }
}
