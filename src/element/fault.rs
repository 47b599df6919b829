use bevy::prelude::*;
use std::fmt;

/// Stands on an element that does not act, and says why; gone once that is mended.
///
/// The same text is logged once as a warning, after the element's `Name` if it has one.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct SpringFault {
    /// The element.
    pub entity: Entity,
    /// Its component and field, such as `Spring::stiffness`.
    pub field: String,
    /// What is wrong with it.
    pub reason: String,
}

impl fmt::Display for SpringFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            entity,
            field,
            reason,
        } = self;
        write!(
            f,
            "{entity}: {field} {reason}; the element is inert until that is mended"
        )
    }
}
