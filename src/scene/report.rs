//! Reports faults of elements, and elements that are too stiff. Each is reported once.

use crate::element::*;
use crate::input::lists::with_elements;
use crate::input::say::{Stays, say};
use crate::scene::rows::ElementRow;
use bevy::prelude::*;

/// Reports a new fault of an element once. When the fault is gone, removes its [`SpringFault`].
pub(crate) fn report(row: &mut ElementRow, commands: &mut Commands) {
    let Some(news) = row.trouble.news() else {
        return;
    };
    let Some(fault) = news else {
        commands.entity(row.entity).try_remove::<SpringFault>();
        return;
    };
    let fault = SpringFault {
        entity: row.entity,
        field: fault.field.into(),
        reason: fault.reason.into(),
    };
    let ends = row.rare.ties.ends;
    let stays = match row.trouble.lasting() {
        Some(_) => Stays::UntilMended,
        None => Stays::ForNow,
    };
    let mut element = commands.entity(row.entity);
    element.queue_silenced(move |mut element: EntityWorldMut| {
        say(&mut element, fault, stays);
        // If an end was despawned, look for it by its name again.
        let is_gone = |end| element.world().get_entity(end).is_err();
        if stays == Stays::UntilMended
            && element.contains::<EndNames>()
            && ends.into_iter().any(is_gone)
        {
            element.insert(AwaitsEnds);
        }
    });
}

/// Removes the [`SpringFault`] of an entity that is no element any more. One that is disabled or waits for its ends keeps it.
pub(crate) fn forget(entity: Entity, commands: &mut Commands) {
    let mut entity = commands.entity(entity);
    entity.queue_silenced(|mut entity: EntityWorldMut| {
        macro_rules! is_any {
            ($($element:ident),*) => { [$(entity.contains::<$element>()),*].contains(&true) };
        }
        let is_element = with_elements!(is_any);
        if !is_element {
            entity.remove::<SpringFault>();
        }
    });
}

/// Greatest number of elements that one message names. Pinned by
/// `messages::a_network_beyond_its_budget_is_told_in_one_message`.
const MOST_NAMED: usize = 3;

/// Reports elements whose vibration is too stiff to be followed, in one message for all that were found in a step.
pub(crate) fn report_unresolved(elements: Vec<Entity>, commands: &mut Commands) {
    if elements.is_empty() {
        return;
    }
    commands.queue(move |world: &mut World| {
        let named = elements.iter().take(MOST_NAMED);
        let named = named.map(|entity| match world.get::<Name>(*entity) {
            Some(name) => format!("{name} ({entity})"),
            None => entity.to_string(),
        });
        let mut who = named.collect::<Vec<_>>().join(", ");
        if let Some(others) = elements.len().checked_sub(MOST_NAMED).filter(|n| *n > 0) {
            who += &format!(" and {others} others");
        }
        log::info!(
            "bevy_coilover: {who}: too stiff for the vibration to be followed (SpringReadout::omega_dt, microsteps). It stays stable, \
             at a wrong frequency. Use less stiffness, more mass, or a larger CoiloverSettings::resolve (where contacts or \
             joints hold a body, max_substeps)"
        );
    });
}
