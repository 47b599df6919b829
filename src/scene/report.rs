//! What is wrong with an element is said once.

use crate::element::{AwaitsEnds, EndNames, SpringFault};
use crate::readout::SpringReadout;
use crate::scene::rows::ElementRow;
use bevy::prelude::*;

/// Says once what is wrong with an element, and takes it back once it is mended.
pub(crate) fn report(row: &mut ElementRow, commands: &mut Commands) {
    let Some(news) = row.trouble.news() else {
        return;
    };
    match news {
        Some(fault) => {
            let fault = SpringFault {
                entity: row.entity,
                field: fault.field.into(),
                reason: fault.reason.into(),
            };
            let ends = row.rare.ties.ends;
            let lasts = row.trouble.lasting().is_some();
            let mut element = commands.entity(row.entity);
            element.queue_silenced(move |mut element: EntityWorldMut| {
                match element.get::<Name>() {
                    Some(name) => log::warn!("{name}, {fault}"),
                    None => log::warn!("{fault}"),
                }
                element.insert(fault);
                if !lasts {
                    return;
                }
                // An end that went is looked for by its name again.
                let is_gone = |end| element.world().get_entity(end).is_err();
                if element.contains::<EndNames>() && ends.into_iter().any(is_gone) {
                    element.insert(AwaitsEnds);
                }
                // What it shows would be taken for a force that still acts.
                if let Some(mut readout) = element.get_mut::<SpringReadout>() {
                    *readout = SpringReadout::default();
                }
            });
        }
        None => {
            commands.entity(row.entity).try_remove::<SpringFault>();
        }
    }
}
