//! Breaks overloaded elements, after their readouts are written.

use crate::element::{Breakable, SpringBroke, WhenBroken};
use crate::readout::SpringReadout;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;

/// Breaks each element whose force or length exceeds the limits in its [`Breakable`].
pub(crate) fn break_overloaded(
    elements: Query<(Entity, &Breakable, &SpringReadout)>,
    mut commands: Commands,
) {
    for (entity, limit, readout) in &elements {
        let force = readout.force();
        if force.abs() <= limit.force && readout.length.abs() <= limit.length {
            continue;
        }
        if !(limit.force >= 0.0 && limit.length >= 0.0) {
            // A limit that is NaN or negative is reported as a fault.
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
                // When the element is enabled again, its old readout would break it again before the next step.
                let slack = SpringReadout::default();
                commands.entity(entity).try_insert((Disabled, slack));
            }
        }
    }
}
