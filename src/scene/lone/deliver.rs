//! Gives the bodies of lone elements what takes them where these do.

use super::{Lone, Route, Way};
use crate::backend::Engine;
use crate::scene::push::Given;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow};
use crate::scene::sleep::omega_of;
use crate::scene::step::Step;
use bevy::math::Vec3;
use std::sync::atomic::Ordering;

impl Lone {
    /// Gives all bodies theirs. Says whether some body has colliders now that had none, or the other way round.
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
                    seen.is_none_or(|seen| step.is_restless(body, &seen, omega, engine))
                } else {
                    body.flags.remove(BodyFlags::RESTS);
                    true
                };
            }
            for (end, body) in ends {
                let body = &mut bodies[body];
                body.give_alone(
                    &way.given[end],
                    way.second_substep,
                    restless,
                    step.tick,
                    engine,
                );
            }
            delivered = true;
        }
        if delivered {
            step.delivered.store(true, Ordering::Relaxed);
        }
        touch_changed
    }
}

impl BodyRow {
    /// Gives the body what its only element pushes it with over the coming step; `restless`: it has to be kept awake.
    #[inline(always)]
    fn give_alone(
        &mut self,
        given: &Given,
        second_substep: bool,
        restless: bool,
        tick: u32,
        engine: &mut impl Engine,
    ) {
        let force = if given.force.is_finite() {
            given.force
        } else {
            Vec3::ZERO
        };
        let given = Given { force, ..*given };
        let push = given.push(restless, second_substep);
        engine.give(self.id, &push, &self.user());
        self.share_force = force;
        self.given = tick;
        let flags = &mut self.flags;
        flags.remove(BodyFlags::SHARES_TORQUE | BodyFlags::NOTED);
        flags.insert(BodyFlags::IS_ALONE | BodyFlags::FRESH | BodyFlags::CARRIES_SHARE);
        flags.set(BodyFlags::SECOND_SUBSTEP, second_substep);
    }
}
