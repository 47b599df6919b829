//! The scenes give the same bits with another executor, and with springs drawn.

use super::film::*;
use super::scenes::*;
use crate::dice::in_turn;
use bevy::ecs::schedule::MultiThreadedExecutor;
use bevy::prelude::*;

#[test]
fn threads_and_executors_change_no_bit_of_any_scene() {
    for (name, plugin, scene) in in_turn(all()) {
        let first = scene(plugin).watch(150);
        let mut film = scene(plugin);
        let world = film.lab.app.world_mut();
        for (_, schedule) in world.resource_mut::<Schedules>().iter_mut() {
            schedule.set_executor(MultiThreadedExecutor::new());
        }
        assert_same(&name, &first, &film.watch(150));
    }
}

#[cfg(feature = "visual")]
#[test]
fn that_springs_are_drawn_changes_no_bit_of_any_scene() {
    use bevy_coilover::prelude::*;
    IN_ORDER.set(true);
    for (name, plugin, scene) in in_turn(all()) {
        let first = scene(plugin).watch(100);
        DRAWN.set(true);
        let mut film = scene(plugin);
        DRAWN.set(false);
        for element in film.cast.clone() {
            let world = film.lab.app.world_mut();
            let Ok(mut entity) = world.get_entity_mut(element) else {
                continue;
            };
            if entity.contains::<SpringDamper>() || entity.contains::<Spring>() {
                entity.insert(Coil::default());
            } else if entity.contains::<TorsionSpringDamper>() {
                entity.insert(TorsionCoil::default());
            }
        }
        assert_same(&name, &first, &film.watch(100));
    }
}
