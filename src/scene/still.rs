//! Skips contexts in which all components sleep.
//!
//! Only two things can wake a sleeping body: the engine's step, after which the engine has active bodies, or other code that
//! changes the engine's bodies, which the ECS detects.

use crate::backend::BodyId;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity::EntityHashMap;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

/// Contexts that are stepped in this tick.
#[derive(Default)]
pub(crate) struct Stepped {
    pub worlds: Vec<Entity>,
    /// Whether some context is not stepped.
    pub some_rest: bool,
    /// Mean velocity (m/s) and angular velocity (rad/s) over the tick of bodies that the game moves from place to place, by context
    /// and handle. The engine's own velocities of these bodies are not valid after this tick.
    pub led: HashMap<(Entity, BodyId), [Vec3; 2]>,
    /// Simulated time of this tick, s, of each context that is not stepped for as long as the first one.
    pub times: EntityHashMap<f64>,
}

/// Contexts in which all components were asleep in the last step. For each, the tick of the last change of its
/// bodies, as of the end of that step's tick.
#[derive(Default)]
pub(crate) struct Still(EntityHashMap<Option<Tick>>);

impl Still {
    /// Stores the ticks of the last changes. Call it at the end of a tick, after the systems that change bodies in every tick.
    pub(crate) fn mark(&mut self, changed: impl Fn(Entity) -> Option<Tick>) {
        for (context, tick) in &mut self.0 {
            *tick = changed(*context);
        }
    }

    pub(crate) fn retain(&mut self, is_there: impl Fn(Entity) -> bool) {
        self.0.retain(|context, _| is_there(*context));
    }

    /// Stores whether all components of a context were asleep in its step.
    pub(crate) fn note(&mut self, context: Entity, all_asleep: bool) {
        if all_asleep {
            self.0.insert(context, None);
        } else {
            self.0.remove(&context);
        }
    }

    /// Whether all components of a context were asleep in the last step and its bodies have not been changed since.
    /// `changed` is the tick of their last change.
    pub(crate) fn holds(&self, context: Entity, changed: Tick) -> bool {
        self.0.get(&context) == Some(&Some(changed))
    }
}
