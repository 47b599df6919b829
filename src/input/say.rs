//! Reports once what is wrong with an entity: in the log, and by a component.

use crate::element::SpringFault;
use crate::readout::SpringReadout;
use bevy::prelude::*;

/// How long a fault lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stays {
    /// Until it is corrected; the element takes no part.
    UntilMended,
    /// For this step: the next may be without it.
    ForNow,
}

/// Reports a fault, unless the entity has the same one already.
pub(crate) fn say(element: &mut EntityWorldMut, fault: SpringFault, stays: Stays) {
    if element.get() == Some(&fault) {
        return;
    }
    match element.get::<Name>() {
        Some(name) => log::warn!("{name}, {fault}"),
        None => log::warn!("{fault}"),
    }
    element.insert(fault);
    // Otherwise the old readout would be taken for a force that still acts.
    if stays == Stays::UntilMended
        && let Some(mut readout) = element.get_mut::<SpringReadout>()
    {
        readout.set_if_neq(SpringReadout::default());
    }
}
