//! Applies edits to the world, before a tick.

use super::bench::Bench;
use super::model::snapshot::Snapshot;
use bevy::prelude::*;

pub(super) fn has_edits(bench: Res<Bench>) -> bool {
    !bench.pending.is_empty()
}

/// Applies the pending edits. Everything that was not edited stays as it is.
pub(super) fn apply(world: &mut World) {
    let edits = std::mem::take(&mut world.resource_mut::<Bench>().pending);
    for (entity, from, to) in edits {
        let Ok(mut element) = world.get_entity_mut(entity) else {
            let wrong = "the element of this edit is gone".to_owned();
            world.resource_mut::<Bench>().message = Some(wrong);
            continue;
        };
        if let Some(mut now) = Snapshot::read(element.as_readonly()) {
            now.carry(&from, &to);
            now.write(&mut element);
        }
    }
}
