//! Are elements plain data: reflected, mapped between worlds, written in scenes?

use crate::compat::rig;
use crate::harness::*;
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::reflect::AppTypeRegistry;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::BTreeSet;

/// Type paths of this crate's types in the type registry. A saved scene contains these paths.
pub fn paths(lab: &Lab) -> BTreeSet<&'static str> {
    let registry = lab.app.world().resource::<AppTypeRegistry>().read();
    registry
        .iter()
        .map(|registration| registration.type_info().type_path())
        .filter(|path| path.starts_with("bevy_coilover"))
        .collect()
}

const COMPONENTS: [&str; 23] = [
    "Spring",
    "Damper",
    "SpringDamper",
    "Anchors",
    "SpringReadout",
    "SpringLoad",
    "SpringFault",
    "TorsionSpring",
    "TorsionDamper",
    "TorsionSpringDamper",
    "SpringLaw",
    "DampingLaw",
    "SpringAction",
    "SpringTravel",
    "SpringAxis",
    "Preload",
    "MaxForce",
    "Breakable",
    "SpringTuning",
    "HoldPose",
    "WorldAnchors",
    "MouseSpring",
    "EndNames",
];

#[test]
fn every_public_component_is_in_the_type_registry() {
    let lab = Lab::new();
    let registry = lab.app.world().resource::<AppTypeRegistry>().read();
    for name in COMPONENTS {
        let registration = registry.get_with_short_type_path(name);
        let registration = registration.unwrap_or_else(|| panic!("{name} is registered"));
        assert!(registration.data::<ReflectComponent>().is_some(), "{name}");
    }
}

#[test]
fn a_saved_scene_names_types_by_paths_that_no_moved_file_changes() {
    let found = paths(&Lab::new());
    // A saved scene also contains the types of the components' fields.
    let inside = [
        "SpringMethod",
        "ForceTable",
        "Polynomial",
        "HeldEnd",
        "WhenBroken",
    ];
    for name in COMPONENTS.into_iter().chain(inside) {
        let path = format!("bevy_coilover::{name}");
        assert!(found.contains(path.as_str()), "{path} is not in {found:?}");
    }
    for path in found {
        assert_eq!(path.matches("::").count(), 1, "{path} follows the modules");
    }
}

#[test]
fn a_clone_of_both_ends_and_element_points_at_the_clones() {
    let (a, b, c, d) = {
        let mut world = World::new();
        (
            world.spawn_empty().id(),
            world.spawn_empty().id(),
            world.spawn_empty().id(),
            world.spawn_empty().id(),
        )
    };
    let mut map = EntityHashMap::from_iter([(a, c), (b, d)]);
    let mut spring = Spring::new(a, b);
    Component::map_entities(&mut spring, &mut map);
    assert_eq!((spring.body_a, spring.body_b), (c, d));
    let mut damper = Damper::new(a, b);
    Component::map_entities(&mut damper, &mut map);
    assert_eq!((damper.body_a, damper.body_b), (c, d));
    let mut pair = SpringDamper::new(a, b);
    Component::map_entities(&mut pair, &mut map);
    assert_eq!((pair.body_a, pair.body_b), (c, d));
    let mut spring = TorsionSpring::new(a, b, Vec3::X);
    Component::map_entities(&mut spring, &mut map);
    assert_eq!((spring.body_a, spring.body_b), (c, d));
    let mut damper = TorsionDamper::new(a, b, Vec3::X);
    Component::map_entities(&mut damper, &mut map);
    assert_eq!((damper.body_a, damper.body_b), (c, d));
    let mut pair = TorsionSpringDamper::new(a, b, Vec3::X);
    Component::map_entities(&mut pair, &mut map);
    assert_eq!((pair.body_a, pair.body_b), (c, d));
}

#[test]
fn a_pointer_and_a_fault_name_the_clones_too() {
    let mut world = World::new();
    let [before, clone] = [(), ()].map(|()| world.spawn_empty().id());
    let mut map = EntityHashMap::from_iter([(before, clone)]);
    let mut pointer = MouseSpring::new(before, Vec3::ZERO, Vec3::ZERO);
    Component::map_entities(&mut pointer, &mut map);
    assert_eq!(pointer.body, clone);
    let mut fault = SpringFault {
        entity: before,
        field: "Spring::stiffness".into(),
        reason: "is NaN".into(),
    };
    Component::map_entities(&mut fault, &mut map);
    assert_eq!(fault.entity, clone);
}

#[test]
fn a_scene_macro_names_the_ends() {
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app.add_plugins((
        CoiloverPlugin::default(),
        bevy::asset::AssetPlugin::default(),
        bevy::scene::ScenePlugin,
    ));
    lab.prime();
    lab.app
        .world_mut()
        .spawn_scene(rig())
        .expect("the scene spawns");
    lab.run(0.2);
    let mut elements = lab
        .app
        .world_mut()
        .query::<(&SpringDamper, &SpringReadout)>();
    let (pair, readout) = elements.single(lab.app.world()).expect("one element");
    assert_eq!(pair.rest_length, Some(2.0));
    assert!(readout.length > 2.01, "the weight hangs on it: {readout:?}");
    let name = |e: Entity| lab.app.world().get::<Name>(e).map(ToString::to_string);
    assert_eq!(name(pair.body_a).as_deref(), Some("Hook"));
    assert_eq!(name(pair.body_b).as_deref(), Some("Weight"));
}

#[test]
fn builders_work_in_constants() {
    const SPRING: Spring = Spring::new(Entity::PLACEHOLDER, Entity::PLACEHOLDER)
        .with_stiffness(3.0)
        .with_rest_length(0.5);
    const DAMPER: Damper = Damper::new(Entity::PLACEHOLDER, Entity::PLACEHOLDER).with_damping(2.0);
    const PAIR: SpringDamper = SpringDamper::new(Entity::PLACEHOLDER, Entity::PLACEHOLDER)
        .with_stiffness(1.5)
        .with_damping(0.25)
        .with_rest_length(2.0);
    assert_eq!(
        (SPRING.stiffness, SPRING.rest_length, DAMPER.damping),
        (3.0, Some(0.5), 2.0)
    );
    assert_eq!(
        (PAIR.stiffness, PAIR.damping, PAIR.rest_length),
        (1.5, 0.25, Some(2.0))
    );
}
