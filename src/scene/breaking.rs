//! Elements that break.

use crate::element::{Breakable, SpringBroke, WhenBroken};
use crate::readout::SpringReadout;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

/// Breaks what is loaded or stretched too far.
pub(crate) fn break_overloaded(
    elements: Query<(Entity, &Breakable, &SpringReadout)>,
    mut commands: Commands,
) {
    for (entity, limit, readout) in &elements {
        let force = readout.force();
        if force.abs() <= limit.force && readout.length <= limit.length {
            continue;
        }
        if limit.force.is_nan() || limit.length.is_nan() {
            // Told as a fault.
            continue;
        }
        commands.trigger(SpringBroke {
            entity,
            force,
            length: readout.length,
        });
        match limit.then {
            WhenBroken::Despawn => commands.entity(entity).try_despawn(),
            WhenBroken::Disable => {
                // What it shows would break it again before the next step, once it is mended.
                let slack = SpringReadout::default();
                commands.entity(entity).try_insert((Disabled, slack));
            }
        }
    }
}
