//! A world in which everything that holds elements sleeps is not looked at.
//!
//! What sleeps is woken by the engine's step, after which its bodies are among the active ones, or by
//! somebody who changes the engine's bodies, which the ECS tells.

use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{RapierContextSimulation, RapierRigidBodySet};

/// Contexts whose every component was found asleep in their last step, and when their bodies had been
/// changed last at the end of that tick.
#[derive(Default)]
pub(super) struct Still(EntityHashMap<Option<Tick>>);

impl Still {
    /// After bevy_rapier's write-back, which marks every set as changed in every tick.
    pub(super) fn mark(&mut self, changed: impl Fn(Entity) -> Option<Tick>) {
        for (context, tick) in &mut self.0 {
            *tick = changed(*context);
        }
    }

    /// Keeps in mind what a step has found.
    pub(super) fn note(&mut self, context: Entity, all_asleep: bool) {
        if all_asleep {
            self.0.insert(context, None);
        } else {
            self.0.remove(&context);
        }
    }

    /// Whether all slept in the last step, and neither it nor anybody since has woken or moved a body.
    pub(super) fn holds(
        &self,
        context: Entity,
        simulation: &RapierContextSimulation,
        set: &Mut<RapierRigidBodySet>,
    ) -> bool {
        self.0.get(&context) == Some(&Some(set.last_changed()))
            && simulation.islands.num_active_bodies() == 0
    }
}
