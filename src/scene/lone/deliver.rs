//! Gives the bodies of lone elements their pushes.

use super::{Lone, Route, Way};
use crate::backend::Engine;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow};
use crate::scene::sleep::omega_of;
use crate::scene::step::Step;
use std::sync::atomic::Ordering;

impl Lone {
    /// Gives the bodies of all solved elements their pushes. Returns whether some body gained or lost its colliders.
    pub(crate) fn deliver(
        &self,
        step: &Step,
        ways: &[Way],
        elements: &[ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
    ) -> bool {
        let mut touch_changed = false;
        let mut delivered = false;
        let solved = self.pairs.iter().zip(ways);
        for (pair, way) in solved.filter(|(_, way)| way.route == Route::Solved) {
            let mut restless = way.disturbed;
            let ends = [0, 1].into_iter();
            let ends = ends.filter_map(|end| Some((end, pair.movable(end)?.0)));
            for (end, body) in ends.clone() {
                let body = &mut bodies[body];
                touch_changed |= body.notice_colliders(way.can_touch[end]);
                body.flags.remove(BodyFlags::DISTURBED);
                restless |= if way.slow[end] {
                    let seen = engine.see(body.id);
                    let omega = omega_of(&elements[pair.element as usize]);
                    seen.is_none_or(|seen| step.is_restless(body, &seen, false, omega, engine))
                } else {
                    body.flags.remove(BodyFlags::RESTS);
                    true
                };
            }
            for (end, body) in ends {
                let body = &mut bodies[body];
                let push = way.given[end].push(restless, way.second_substep);
                body.give(&push, step.tick, engine);
                body.flags.remove(BodyFlags::NOTED);
                body.flags.insert(BodyFlags::IS_ALONE);
            }
            delivered = true;
        }
        if delivered {
            step.delivered.store(true, Ordering::Relaxed);
        }
        touch_changed
    }
}
