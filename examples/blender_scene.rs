//! A scene made in Blender: a car on wishbones with four coilovers, a rope bridge, and one of each element.
//! Everything, including bodies and joints, comes from `assets/blender_scene.glb`, which `assets/blender_scene.py`
//! makes.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::asset::handle_internal_asset_events;
use bevy::gltf::GltfPlugin;
use bevy::prelude::*;
use bevy::world_serialization::{WorldAsset, WorldSerializationPlugin};
use bevy_coilover::CoiloverGltfPlugin;
use bevy_coilover::prelude::*;
use stage::{Begin, Finding, PictureAt, Stage, Track};
use std::f32::consts::TAU;
use std::time::{Duration, Instant};

const FILE: &str = "blender_scene.glb#Scene0";
const GRAVITY: f32 = 9.81;
/// Mass on the single spring and on the coilover beside it, as in the file, kg.
const MASS: f32 = 4.0;
/// Stiffness of both, as in the file, N/m.
const STIFFNESS: f32 = 400.0;
/// Rest length of both, as in the file, m.
const REST: f32 = 0.9;
/// Height of the chassis, as in the file, m.
const RIDE: f32 = 0.52;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "blender_scene",
        setup,
        seconds: 8.0,
        again: 12.0,
        check,
        eye: Vec3::new(4.0, 5.6, 10.5),
        target: Vec3::new(0.2, 0.5, 0.0),
    })
}

fn setup(app: &mut App) {
    if !app.is_plugin_added::<GltfPlugin>() {
        // Without a window no plugin that reads files has been added yet.
        app.add_plugins((
            AssetPlugin::default(),
            bevy::image::ImagePlugin::default(),
            bevy::mesh::MeshPlugin,
            WorldSerializationPlugin,
            GltfPlugin::default(),
        ))
        .init_asset::<StandardMaterial>();
    }
    if !app.is_plugin_added::<CoiloverGltfPlugin>() {
        app.add_plugins(CoiloverGltfPlugin);
    }
    app.insert_resource(PictureAt(0.7))
        .add_systems(Begin, load)
        .add_systems(PreUpdate, track);
}

/// Waits until the file is loaded, so that the first tick is also the scene's first.
fn load(world: &mut World) {
    let scene: Handle<WorldAsset> = world.resource::<AssetServer>().load(FILE);
    let begun = Instant::now();
    while !world
        .resource::<AssetServer>()
        .is_loaded_with_dependencies(&scene)
    {
        let state = world.resource::<AssetServer>().load_state(&scene);
        assert!(!state.is_failed(), "{FILE}: {state:?}");
        assert!(begun.elapsed() < Duration::from_secs(60), "{FILE}");
        handle_internal_asset_events(world);
        std::thread::sleep(Duration::from_millis(1));
    }
    world.spawn((WorldAssetRoot(scene), Transform::default()));
}

fn track(mut commands: Commands, elements: Query<Entity, (With<SpringReadout>, Without<Track>)>) {
    for element in &elements {
        commands.entity(element).insert(Track::default());
    }
}

/// Returns the track of the element with this name.
fn tracked<'w>(world: &'w World, name: &str) -> Option<&'w Track> {
    world
        .iter_entities()
        .find(|entity| entity.get::<Name>().is_some_and(|n| n.as_str() == name))
        .and_then(|entity| entity.get::<Track>())
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut faults = world.query::<&SpringFault>();
    let faults = faults.iter(world).count();
    let mut named = world.query::<(&Name, &GlobalTransform)>();
    let ride = named
        .iter(world)
        .find(|(name, _)| name.as_str() == "Chassis")
        .map_or(f32::NAN, |(_, place)| place.translation().y);

    let sag = MASS * GRAVITY / STIFFNESS;
    let wanted = (STIFFNESS / MASS).sqrt() / TAU;
    let swing =
        tracked(world, "Spring Beam Load spring").map_or(f32::NAN, |t| t.frequency(REST + sag));
    let rest =
        tracked(world, "SpringDamper Beam Load springDamper").map_or(f32::NAN, |t| t.last().length);
    vec![
        Finding::small("elements at fault", faults as f32, 0.5, ""),
        Finding::close("frequency of the spring", swing, wanted, "Hz", 2e-3),
        Finding::close("sag of the coilover", rest - REST, sag, "m", 1e-2),
        Finding::small("the car sinks or rises", ride - RIDE, 2e-2, "m"),
    ]
}
