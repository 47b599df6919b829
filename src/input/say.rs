//! What is wrong with an entity is said once, in the log and by a component.

use crate::element::SpringFault;
use crate::readout::SpringReadout;
use bevy::prelude::*;

/// How long a fault stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stays {
    /// Until it is mended; the element takes no part.
    UntilMended,
    /// For this step: the next may be without it.
    ForNow,
}

/// Says what is wrong, if the same does not stand there already.
pub(crate) fn say(element: &mut EntityWorldMut, fault: SpringFault, stays: Stays) {
    if element.get() == Some(&fault) {
        return;
    }
    match element.get::<Name>() {
        Some(name) => log::warn!("{name}, {fault}"),
        None => log::warn!("{fault}"),
    }
    element.insert(fault);
    // What it shows would be taken for a force that still acts.
    if stays == Stays::UntilMended
        && let Some(mut readout) = element.get_mut::<SpringReadout>()
    {
        readout.set_if_neq(SpringReadout::default());
    }
}
