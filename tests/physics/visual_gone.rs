//! Is an element that is no element any more still drawn, and is it drawn again once it is one?

use crate::visual_data::parts;
use crate::visual_rest::Rest;
use crate::visual_torsion::{Door, RADIUS};
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// A load is let go: its spring is removed, and the coil stays on the entity.
#[test]
fn what_is_no_linear_element_any_more_is_not_drawn_until_it_is_one_again() {
    let mut rest = Rest::new();
    let size = |rest: &Rest| rest.lab.get::<GlobalTransform>(rest.coil).scale();
    rest.remove::<Spring>(rest.element);
    rest.lab.tick();
    assert_eq!(size(&rest), Vec3::ZERO);
    let (a, b, element) = (rest.a, rest.b, rest.element);
    rest.insert(element, TorsionSpring::new(a, b, Vec3::Z));
    rest.lab.run(0.1);
    assert_eq!(size(&rest), Vec3::ZERO);
    rest.remove::<TorsionSpring>(element);
    rest.insert(element, Damper::new(a, b));
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
}

/// A telescope that is taken off while an end is missing.
#[test]
fn a_look_that_is_removed_while_an_end_is_missing_is_not_drawn_any_more() {
    let mut rest = Rest::new();
    let element = rest.element;
    rest.insert(element, Telescope::default());
    rest.lab.tick();
    assert!(parts(&rest.lab, element).len() > 1);
    rest.remove::<GlobalTransform>(rest.b);
    rest.lab.tick();
    rest.remove::<Telescope>(element);
    rest.lab.tick();
    assert_eq!(parts(&rest.lab, element).len(), 1);
}

#[test]
fn what_is_no_torsion_element_any_more_has_no_spiral_until_it_is_one_again() {
    let mut door = Door::new(TorsionCoil::new(RADIUS, 4.0));
    let element = door.element;
    let spring = *door.lab.get::<TorsionSpring>(element);
    let sizes = |door: &Door| {
        parts(&door.lab, element)
            .iter()
            .map(|at| at.scale())
            .collect::<Vec<_>>()
    };
    let before = sizes(&door);
    door.lab
        .app
        .world_mut()
        .entity_mut(element)
        .remove::<TorsionSpring>();
    door.lab.tick();
    assert_eq!(sizes(&door), [Vec3::ZERO; 3]);
    door.lab.app.world_mut().entity_mut(element).insert(spring);
    door.lab.tick();
    assert_eq!(sizes(&door), before);
}
