//! Are the drawn parts of an element visible to the cameras that see the element?

use crate::harness::*;
use crate::visual_data::lab;
use bevy::camera::visibility::RenderLayers;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// Asserts that the element has parts, and that all of them are on the layers `wanted`.
fn are_on(lab: &Lab, element: Entity, wanted: &Option<RenderLayers>) {
    let world = lab.app.world();
    let children = world.get::<Children>(element).expect("parts");
    let drawn = children
        .iter()
        .filter(|child| world.get::<Mesh3d>(*child).is_some());
    let layers: Vec<_> = drawn
        .map(|child| world.get::<RenderLayers>(child).cloned())
        .collect();
    assert!(!layers.is_empty());
    let all = layers.iter().all(|layers| layers == wanted);
    assert!(all, "{layers:?}, not {wanted:?}");
}

/// A coilover and a spiral.
fn elements(lab: &mut Lab, beside: impl Bundle + Clone) -> [Entity; 2] {
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let spiral = (TorsionSpring::new(a, b, Vec3::Z), TorsionCoil::default());
    [
        lab.spawn((coilover(a, b), beside.clone())),
        lab.spawn((spiral, beside)),
    ]
}

#[test]
fn parts_follow_the_layers_of_their_element_also_when_it_has_none_any_more() {
    let mut lab = lab();
    let elements = elements(&mut lab, ());
    lab.run(0.1);
    for element in elements {
        are_on(&lab, element, &None);
        for wanted in [
            Some(RenderLayers::layer(2)),
            Some(RenderLayers::from_layers(&[1, 3])),
            None,
        ] {
            let mut entity = lab.app.world_mut().entity_mut(element);
            match &wanted {
                Some(layers) => entity.insert(layers.clone()),
                None => entity.remove::<RenderLayers>(),
            };
            lab.tick();
            are_on(&lab, element, &wanted);
        }
    }
}

#[test]
fn parts_are_on_the_layers_of_their_element_from_their_first_frame_on() {
    let mut lab = lab();
    let layers = RenderLayers::layer(5);
    let [pair, spiral] = elements(&mut lab, layers.clone());
    let wanted = Some(layers);
    lab.tick();
    are_on(&lab, pair, &wanted);
    are_on(&lab, spiral, &wanted);
    // The parts are created again.
    lab.get_mut::<Coil>(pair).turns = 5.0;
    lab.get_mut::<TorsionCoil>(spiral).turns = 3.0;
    lab.tick();
    are_on(&lab, pair, &wanted);
    are_on(&lab, spiral, &wanted);
}

#[test]
fn what_users_bring_along_keeps_its_own_layers() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let element = lab.spawn((Spring::new(a, b), RenderLayers::layer(2)));
    let skin = SpringSkin { length: 1.0 };
    let own = lab.spawn((skin, RenderLayers::layer(7), ChildOf(element)));
    let plain = lab.spawn((skin, ChildOf(element)));
    lab.run(0.1);
    *lab.get_mut::<RenderLayers>(element) = RenderLayers::layer(3);
    lab.run(0.1);
    assert_eq!(*lab.get::<RenderLayers>(own), RenderLayers::layer(7));
    assert!(lab.app.world().get::<RenderLayers>(plain).is_none());
}
