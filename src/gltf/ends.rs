//! Which entities an element names as its ends.

use super::carry::LoadedEnd;
use crate::element::*;
use crate::input::lists::with_elements;
use bevy::prelude::*;

/// Returns the ends of an element; `None` if the entity is not an element.
pub(super) fn ends(entity: EntityRef) -> Option<[Entity; 2]> {
    macro_rules! ends {
        ($($element:ident),*) => {
            $(if let Some(element) = entity.get::<$element>() {
                return Some([element.body_a, element.body_b]);
            })*
        };
    }
    with_elements!(ends);
    None
}

/// Returns those ends of an element that must be on bodies, because the element acts in the frames of these: both of a
/// torsion element, and A beside `SpringAxis::BodyA`.
pub(super) fn framed_ends(entity: EntityRef) -> Vec<Entity> {
    let Some([a, b]) = ends(entity) else {
        return Vec::new();
    };
    let turns = entity.contains::<TorsionSpring>()
        || entity.contains::<TorsionDamper>()
        || entity.contains::<TorsionSpringDamper>();
    if turns {
        vec![a, b]
    } else if matches!(entity.get::<SpringAxis>(), Some(SpringAxis::BodyA(_))) {
        vec![a]
    } else {
        Vec::new()
    }
}

/// Marks the ends of a loaded element that must be on bodies.
pub(super) fn mark(element: &mut EntityWorldMut) {
    for end in framed_ends(element.as_readonly()) {
        element.world_scope(|world| {
            // The file may name a node that this scene has not.
            if let Ok(mut end) = world.get_entity_mut(end) {
                end.insert(LoadedEnd);
            }
        });
    }
}
