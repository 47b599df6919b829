//! A world in which everything that holds elements sleeps is not looked at.
//!
//! What sleeps is woken by the engine's step, after which its bodies are among the active ones, or by
//! somebody who changes the engine's bodies, which the ECS tells.

use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;

/// What is stepped in this tick.
#[derive(Default)]
pub(crate) struct Stepped {
    pub worlds: Vec<Entity>,
    /// Some world is not.
    pub some_rest: bool,
}

/// Contexts whose every component was found asleep in their last step, and when their bodies had been
/// changed last at the end of that tick.
#[derive(Default)]
pub(crate) struct Still(EntityHashMap<Option<Tick>>);

impl Still {
    /// At the end of a tick, after all that changes bodies in every tick.
    pub(crate) fn mark(&mut self, changed: impl Fn(Entity) -> Option<Tick>) {
        for (context, tick) in &mut self.0 {
            *tick = changed(*context);
        }
    }

    pub(crate) fn retain(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.0.retain(|context, _| is_there(*context));
    }

    /// Keeps in mind what a step has found.
    pub(crate) fn note(&mut self, context: Entity, all_asleep: bool) {
        if all_asleep {
            self.0.insert(context, None);
        } else {
            self.0.remove(&context);
        }
    }

    /// Whether all slept in the last step, and nobody has moved a body since, of a context whose bodies were changed then
    /// last.
    pub(crate) fn holds(&self, context: Entity, changed: Tick) -> bool {
        self.0.get(&context) == Some(&Some(changed))
    }
}
