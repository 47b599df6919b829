//! Tests that components survive being written as text and read back: reflection, serde, scene files, `bsn!`. Elements
//! name their ends.

use crate::harness::*;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::prelude::*;
use bevy::reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::RigidBody;
use bevy_world_serialization::serde::WorldDeserializer;
use bevy_world_serialization::{DynamicWorld, DynamicWorldBuilder, WorldAsset};
use serde::de::DeserializeSeed;
use serde_json::json;

/// Asset loader that panics: the scenes of these tests refer to no assets.
struct NoAssets;

impl bevy::asset::LoadFromPath for NoAssets {
    fn load_from_path_erased(
        &mut self,
        _type_id: std::any::TypeId,
        path: bevy::asset::AssetPath<'static>,
    ) -> UntypedHandle {
        panic!("{path} is asked for")
    }
}

/// Every component that a designer writes, with values that differ from the defaults.
pub fn all() -> Vec<Box<dyn PartialReflect>> {
    let table = || ForceTable::new([(-1.0, -20.0), (0.0, 0.0), (0.5, 3.25)]);
    vec![
        Box::new(Spring::default().with_stiffness(12.5)),
        Box::new(Damper::default().with_damping(0.1)),
        Box::new(SpringDamper::default().with_rest_length(0.3)),
        Box::new(TorsionSpring::default().with_rest_angle(7.0)),
        Box::new(TorsionDamper::default().with_damping(1e-3)),
        Box::new(TorsionSpringDamper {
            axis: Vec3::new(0.1, 0.2, -0.3),
            ..default()
        }),
        Box::new(EndNames::new("Hook \"A\"", "Gewicht ö")),
        Box::new(Anchors::new(Vec3::X, Vec3::NEG_Z)),
        Box::new(WorldAnchors::new(Vec3::X, Vec3::NEG_Z)),
        Box::new(SpringLaw::sided(
            Polynomial::new(1.0, 2.0, 3.0),
            Polynomial::default(),
        )),
        Box::new(SpringLaw::Table(table())),
        Box::new(DampingLaw::sided(1.0, 3.0)),
        Box::new(SpringAction::Pull),
        Box::new(SpringTravel::new(0.1, 0.9, 4e4)),
        Box::new(SpringAxis::BodyA(Vec3::Y)),
        Box::new(Preload(-3.5)),
        Box::new(MaxForce(1e6)),
        Box::new(Breakable {
            length: 4.0,
            ..Breakable::at_force(2.0).disabling()
        }),
        Box::new(SpringTuning::sag(0.1, 0.25)),
        Box::new(HoldPose::of_b().with_share(0.25).with_mass(80.0)),
        Box::new(Coil::new(0.1, 0.01, 5.0)),
        Box::new(Telescope::new(0.1, 0.01).with_stroke(0.5)),
    ]
}

fn registry() -> AppTypeRegistry {
    let mut app = app();
    app.add_plugins((CoiloverPlugin::default(), CoiloverVisualPlugin));
    app.world().resource::<AppTypeRegistry>().clone()
}

#[test]
fn every_component_survives_a_round_trip_through_ron_and_json() {
    let registry = registry();
    let registry = registry.read();
    for value in all() {
        let writer = ReflectSerializer::new(&*value, &registry);
        let name = value.reflect_type_path().to_owned();
        assert!(name.starts_with("bevy_coilover::"), "{name}");
        assert_eq!(
            name.matches("::").count(),
            1,
            "{name} names an inner module"
        );
        let back = |read: Box<dyn PartialReflect>, text: &str| {
            let equal = value.reflect_partial_eq(&*read);
            assert_eq!(equal, Some(true), "{name}: {text} became {read:?}");
        };
        let reader = || ReflectDeserializer::new(&registry);
        let text = ron::to_string(&writer).expect("RON");
        let mut ron = ron::Deserializer::from_str(&text).expect("RON");
        back(reader().deserialize(&mut ron).expect(&text), &text);
        // JSON cannot hold infinity, so no number in `all` is infinite.
        let text = serde_json::to_string(&writer).expect("JSON");
        let mut json = serde_json::Deserializer::from_str(&text);
        back(reader().deserialize(&mut json).expect(&text), &text);
    }
}

#[test]
fn what_a_file_leaves_out_is_as_new_makes_it() {
    let read: SpringDamper = serde_json::from_value(json!({ "stiffness": 40.0 })).expect("reads");
    assert_eq!(read, SpringDamper::default().with_stiffness(40.0));
    let read: TorsionDamper = ron::from_str("(axis: (0.0, 1.0, 0.0))").expect("reads");
    assert_eq!((read.axis, read.damping), (Vec3::Y, 1.0));
    assert_eq!(read.body_a, Entity::PLACEHOLDER);
}

#[test]
fn reflection_makes_elements_without_ends() {
    let registry = registry();
    let registry = registry.read();
    for name in [
        "Spring",
        "Damper",
        "SpringDamper",
        "TorsionSpring",
        "TorsionDamper",
        "TorsionSpringDamper",
        "EndNames",
    ] {
        let path = format!("bevy_coilover::{name}");
        let found = registry.get_with_type_path(&path).expect(&path);
        let default = found.data::<ReflectDefault>().expect("a default").default();
        assert_eq!(default.reflect_type_path(), path);
        assert!(found.data::<ReflectComponent>().is_some());
    }
}

#[test]
fn a_scene_file_ties_its_springs_in_another_world() {
    let text = {
        let mut app = game();
        let ends = spawn_ends(&mut app);
        let element = app
            .world_mut()
            .spawn((
                SpringDamper::default().with_stiffness(100.0),
                EndNames::new("Hook", "Weight"),
                Preload(2.0),
            ))
            .id();
        run(&mut app, 0.1);
        let world = app.world();
        let registry = world.resource::<AppTypeRegistry>().read();
        let scene = DynamicWorldBuilder::from_world(world, &registry)
            .deny_all_components()
            .allow_component::<Name>()
            .allow_component::<Transform>()
            .allow_component::<RigidBody>()
            .allow_component::<bevy_rapier3d::prelude::AdditionalMassProperties>()
            .allow_component::<SpringDamper>()
            .allow_component::<EndNames>()
            .allow_component::<Preload>()
            .extract_entities(ends.into_iter().chain([element]))
            .build();
        scene.serialize(&registry).expect("a scene file")
    };
    assert!(text.contains("\"bevy_coilover::EndNames\""), "{text}");
    let mut app = game();
    // Shifts the entity indices, so that they differ from those in the file.
    for _ in 0..7 {
        app.world_mut().spawn_empty();
    }
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let read = |text: &str| -> DynamicWorld {
        let registry = registry.read();
        let seed = WorldDeserializer {
            type_registry: &registry,
            load_from_path: &mut NoAssets,
        };
        let mut ron = ron::Deserializer::from_str(text).expect("RON");
        seed.deserialize(&mut ron).expect("a scene")
    };
    let scene = read(&text);
    scene
        .write_to_world(app.world_mut(), &mut default())
        .expect("spawns");
    run(&mut app, 0.5);
    let (a, b) = (named(&mut app, "Hook"), named(&mut app, "Weight"));
    let mut pairs = app
        .world_mut()
        .query::<(&SpringDamper, &SpringReadout, Has<SpringFault>)>();
    let (pair, readout, fault) = pairs.single(app.world()).expect("one");
    assert_eq!([pair.body_a, pair.body_b], [a, b]);
    assert!(!fault && readout.force() > 2.0, "{readout:?}");
}

/// Bevy spawns a loaded glTF scene in the same way.
#[test]
fn every_component_can_be_in_a_scene_that_is_spawned() {
    let mut app = app();
    app.add_plugins((CoiloverPlugin::default(), CoiloverVisualPlugin));
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let mut scene = World::new();
    for value in all() {
        let registry = registry.read();
        let known = registry.get_with_type_path(value.reflect_type_path());
        let component = known.and_then(|known| known.data::<ReflectComponent>());
        let mut entity = scene.spawn_empty();
        let component = component.expect("a component");
        component.insert(&mut entity, &*value, &registry);
    }
    scene.spawn((TorsionSpring::default(), TorsionCoil::default()));
    let scene = WorldAsset::new(scene);
    let spawned = scene.write_to_world_with(app.world_mut(), &mut default(), &registry);
    assert!(spawned.is_ok(), "{spawned:?}");
}

#[test]
fn a_scene_file_written_by_hand_needs_names_only() {
    let text = r#"(
        resources: {},
        entities: {
            1: (components: {
                "bevy_ecs::name::Name": "Hook",
                "bevy_transform::components::transform::Transform": (
                    translation: (0.0, 2.0, 0.0), rotation: (0.0, 0.0, 0.0, 1.0), scale: (1.0, 1.0, 1.0),
                ),
            }),
            2: (components: {
                "bevy_coilover::Spring": (stiffness: 80.0, rest_length: Some(1.0)),
                "bevy_coilover::EndNames": (a: "Hook", b: "Weight"),
            }),
        },
    )"#;
    let mut app = game();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry_now = registry.read();
    let seed = WorldDeserializer {
        type_registry: &registry_now,
        load_from_path: &mut NoAssets,
    };
    let mut ron = ron::Deserializer::from_str(text).expect("RON");
    let scene: DynamicWorld = seed.deserialize(&mut ron).expect("a scene");
    drop(registry_now);
    scene
        .write_to_world(app.world_mut(), &mut default())
        .expect("spawns");
    run(&mut app, 0.1);
    let mut faults = app.world_mut().query::<&SpringFault>();
    let fault = faults.single(app.world()).expect("it waits").to_string();
    assert!(fault.contains("'Weight'"), "{fault}");
    spawn_ends(&mut app);
    // Now there are two hooks.
    run(&mut app, 0.1);
    let fault = faults.single(app.world()).expect("it waits").to_string();
    assert!(
        fault.contains("'Hook', which 2 entities of the world have"),
        "{fault}"
    );
}

#[test]
fn a_scene_macro_takes_names_as_text() {
    let mut app = app();
    app.add_plugins((
        CoiloverPlugin::default(),
        AssetPlugin::default(),
        bevy::scene::ScenePlugin,
    ));
    prime(&mut app);
    let [a, b] = spawn_ends(&mut app);
    fn rig() -> impl Scene {
        bsn! {
            SpringDamper { stiffness: 100.0 }
            EndNames { a: "Hook", b: "Weight" }
        }
    }
    let element = app.world_mut().spawn_scene(rig()).expect("spawns").id();
    run(&mut app, 0.1);
    let pair = app.world().get::<SpringDamper>(element).expect("a pair");
    assert_eq!([pair.body_a, pair.body_b], [a, b]);
    assert_eq!((pair.stiffness, pair.damping), (100.0, 1.0));
}

#[test]
fn elements_with_handles_for_ends_survive_a_round_trip_through_json() {
    let entity = Entity::from_raw_u32(7).expect("an index");
    let pair = SpringDamper::new(entity, Entity::PLACEHOLDER)
        .with_stiffness(12.5)
        .with_rest_length(0.25);
    let text = serde_json::to_string(&pair).expect("writes");
    assert_eq!(
        serde_json::from_str::<SpringDamper>(&text).expect("reads"),
        pair
    );
    let anchors = Anchors::new(Vec3::X, Vec3::NEG_Z);
    let text = serde_json::to_string(&anchors).expect("writes");
    assert_eq!(
        serde_json::from_str::<Anchors>(&text).expect("reads"),
        anchors
    );
}
