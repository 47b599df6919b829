//! Is a spring that a game saves with its world and loads again drawn once?

use crate::harness::*;
use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_world_serialization::DynamicWorldBuilder;
use std::path::Path;

/// A game saves its world as a Bevy scene, with all components that Bevy can save, and loads it again in the same app.
#[test]
fn an_element_from_a_saved_world_has_each_part_once() {
    let mut app = app_with_files(Path::new("."));
    app.add_plugins(CoiloverPlugins)
        .register_type::<Mesh3d>()
        .register_type::<MeshMaterial3d<StandardMaterial>>()
        .register_type::<ChildOf>();
    prime(&mut app);
    let world = app.world_mut();
    let [a, b] = [Vec3::ZERO, Vec3::Y].map(|at| world.spawn(Transform::from_translation(at)).id());
    let spiral = TorsionCoil::new(0.2, 4.0);
    let elements = [
        world.spawn(coilover(a, b)).id(),
        world
            .spawn((TorsionSpring::new(a, b, Vec3::Z), spiral))
            .id(),
    ];
    run(&mut app, 0.1);
    let parts = |app: &App, element: Entity| {
        let parts = app.world().get::<Children>(element);
        parts.map_or(0, |parts| parts.len())
    };
    let before = elements.map(|element| parts(&app, element));
    assert_eq!(before, [6, 3]);
    let world = app.world_mut();
    let all: Vec<Entity> = world.query::<Entity>().iter(world).collect();
    let all = all
        .into_iter()
        .filter(|entity| world.get::<Transform>(*entity).is_some());
    let all: Vec<Entity> = all.collect();
    let registry = world.resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let saved = DynamicWorldBuilder::from_world(world, &registry)
        .extract_entities(all.into_iter())
        .build();
    let mut names = EntityHashMap::default();
    let loaded = saved.write_to_world_with(world, &mut names, &registry);
    assert!(loaded.is_ok(), "{loaded:?}");
    drop(registry);
    run(&mut app, 0.1);
    let again = elements.map(|element| names[&element]);
    assert_eq!(again.map(|element| parts(&app, element)), before);
    assert_eq!(elements.map(|element| parts(&app, element)), before);
}
