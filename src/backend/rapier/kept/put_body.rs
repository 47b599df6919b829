//! Restores a body: its row, and its forces in the components.

use crate::backend::rapier::forces::SpringLoad;
use crate::backend::{BodyId, Wrench};
use crate::scene::kept::KeptBody;
use crate::scene::rows::{BodyFlags, BodyRow, RareBody};
use bevy::ecs::change_detection::Tick;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

impl KeptBody {
    pub(super) fn row(&self, id: BodyId, context: Entity) -> BodyRow {
        let [force, torque] = self.user;
        let new = BodyRow::new(self.entity, id, context);
        let mut row = BodyRow {
            flags: self.flags & BodyFlags::KEPT,
            clear: self.clear,
            rare: Box::new(RareBody {
                rank: self.rank,
                lingers: self.lingers,
                now: self.now,
                searched: self.searched,
                rest: self.rest,
                raised: self.raised,
                substep: self.substep,
                pulled: self.pulled,
                turned: self.turned,
                ..*new.rare
            }),
            ..new
        };
        row.set_user(Wrench { force, torque });
        row
    }

    /// Writes both shares of the force without marking the component as changed, because a change would wake the body.
    pub(super) fn show(&self, slot: usize, mut body: EntityWorldMut, now: Tick) {
        let [user, elements] =
            [self.user, self.elements].map(|[force, torque]| ExternalForce { force, torque });
        let (load, sum) = SpringLoad::again([user, elements], slot, self.raised_iterations);
        match body.get_mut::<SpringLoad>() {
            Some(mut known) => *known.bypass_change_detection() = load,
            None => {
                body.insert(load);
            }
        }
        if let Some(mut force) = body.get_mut::<ExternalForce>() {
            *force.bypass_change_detection() = sum;
        } else {
            body.insert(sum);
        }
        if let Some(mut force) = body.get_mut::<ExternalForce>() {
            // Half the range of ticks ago, so before the last run of any system.
            let long_ago = Tick::new(now.get().wrapping_sub(u32::MAX / 2));
            force.set_last_added(long_ago);
            force.set_last_changed(long_ago);
        }
    }
}
