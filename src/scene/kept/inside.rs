//! Converts an element's data in the engine's solver to the data of a snapshot, and back.

use crate::scene::held::{Inside, Joints};
use crate::scene::kept::KeptInside;
use bevy::prelude::Entity;

impl KeptInside {
    pub(crate) fn of(inside: &Inside) -> Self {
        // Fields that are not kept are found anew before each step.
        let Inside {
            joints,
            hidden,
            context: _,
            active,
            pieces: _,
            from: _,
            direction: _,
            places: _,
            facings: _,
            rates,
            debt,
            turn: _,
            slipped,
            leeway,
        } = inside;
        Self {
            joints: joints.kept().collect(),
            hidden: *hidden,
            active: *active,
            slipped: *slipped,
            rates: *rates,
            debt: *debt,
            leeway: *leeway,
        }
    }

    pub(crate) fn put(&self, context: Entity) -> Box<Inside> {
        Box::new(Inside {
            joints: Joints::of(&self.joints),
            hidden: self.hidden,
            context: Some(context),
            active: self.active,
            slipped: self.slipped,
            rates: self.rates,
            debt: self.debt,
            leeway: self.leeway,
            ..Inside::default()
        })
    }
}
