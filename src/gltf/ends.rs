//! Which entities an element names as its ends.

use crate::MouseSpring;
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

/// Returns the ends of an element that a file holds; `None` if the entity is not one. An element that a [`MouseSpring`]
/// has spawned is not: it acts only while the mouse holds the body.
pub(super) fn written_ends(entity: EntityRef, world: &World) -> Option<[Entity; 2]> {
    let ends = ends(entity)?;
    let parent = entity.get::<ChildOf>().map(ChildOf::parent);
    let is_of_mouse =
        |parent: Entity| ends[0] == parent && world.get::<MouseSpring>(parent).is_some();
    (!parent.is_some_and(is_of_mouse)).then_some(ends)
}

/// Returns how many elements are on an entity. More than one is a fault.
pub(super) fn count(entity: EntityRef) -> usize {
    macro_rules! there {
        ($($element:ident),*) => {
            [$(entity.contains::<$element>()),*]
        };
    }
    let there = with_elements!(there);
    there.into_iter().filter(|is_there| *is_there).count()
}

/// Whether the entity is a torsion element.
pub(super) fn is_torsion(entity: EntityRef) -> bool {
    entity.contains::<TorsionSpring>()
        || entity.contains::<TorsionDamper>()
        || entity.contains::<TorsionSpringDamper>()
}

/// Returns those ends of an element that must be on bodies, because the element acts in the frames of these: both of a
/// torsion element, and A beside `SpringAxis::BodyA`.
pub(super) fn framed_ends(entity: EntityRef) -> Vec<Entity> {
    let Some([a, b]) = ends(entity) else {
        return Vec::new();
    };
    if is_torsion(entity) {
        vec![a, b]
    } else if matches!(entity.get::<SpringAxis>(), Some(SpringAxis::BodyA(_))) {
        vec![a]
    } else {
        Vec::new()
    }
}
