use bevy::prelude::*;
use std::fmt;

/// Says why an element does not act. The crate puts it on the element, and removes it once the reason is gone.
///
/// The same text is logged once as a warning, after the element's `Name` if it has one.
#[derive(Component, Reflect, Clone, Debug, PartialEq, Eq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct SpringFault {
    /// The element that does not act.
    #[entities]
    pub entity: Entity,
    /// Component and field at fault, such as `Spring::stiffness`.
    pub field: String,
    /// What is wrong with this field.
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
