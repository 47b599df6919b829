//! Exports bodies and springs of a running game to a glTF file, and loads them in another game.
//!
//! ```sh
//! cargo run --example gltf_round_trip --features gltf
//! ```
//!
//! The file is `renders/round_trip.gltf`. Blender with this crate's add-on reads it too. The exit code tells whether
//! the second game has the same values and its lamp the same sag.

use bevy::gltf::GltfPlugin;
use bevy::image::ImagePlugin;
use bevy::mesh::MeshPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::world_serialization::WorldSerializationPlugin;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::process::ExitCode;
use std::time::Duration;

const FOLDER: &str = "renders";
const FILE: &str = "round_trip.gltf";

fn game() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin {
            file_path: FOLDER.into(),
            ..default()
        },
        ImagePlugin::default(),
        MeshPlugin,
        WorldSerializationPlugin,
        GltfPlugin::default(),
        CoiloverPlugin::at_hz(60.0),
        CoiloverGltfPlugin,
        RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
    ))
    .init_asset::<StandardMaterial>()
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(
        1.0 / 60.0,
    )));
    app.finish();
    app.cleanup();
    app
}

/// Spawns a lamp on a coilover below a hook. Returns the root entity.
fn build(world: &mut World) -> Entity {
    let root = world
        .spawn((
            Name::new("Room"),
            Transform::default(),
            Visibility::default(),
        ))
        .id();
    let hook = world
        .spawn((
            Name::new("Hook"),
            Transform::from_xyz(0.0, 2.0, 0.0),
            ChildOf(root),
        ))
        .id();
    let lamp = world
        .spawn((
            Name::new("Lamp"),
            RigidBody::Dynamic,
            Collider::ball(0.25),
            ColliderMassProperties::Mass(2.0),
            Transform::from_xyz(0.1, 1.0, 0.0),
            ChildOf(root),
        ))
        .id();
    world.spawn((
        Name::new("Spring"),
        SpringDamper::new(hook, lamp)
            .with_stiffness(120.0)
            .with_damping(3.0)
            .with_rest_length(0.9),
        MaxForce(500.0),
        Coil::new(0.08, 0.01, 9.0),
        ChildOf(root),
    ));
    root
}

fn run(app: &mut App, seconds: usize) {
    for _ in 0..60 * seconds {
        app.update();
    }
}

/// Returns the height of the lamp, m, and the spring.
fn look(app: &mut App) -> Option<(f32, SpringDamper)> {
    let world = app.world_mut();
    let mut names = world.query::<(&Name, &GlobalTransform)>();
    let lamp = names.iter(world).find(|(name, _)| name.as_str() == "Lamp");
    let height = lamp?.1.translation().y;
    let mut springs = world.query::<&SpringDamper>();
    Some((height, *springs.iter(world).next()?))
}

fn main() -> ExitCode {
    let mut first = game();
    let root = build(first.world_mut());
    run(&mut first, 1);
    let exported = export_gltf(first.world(), [root]);
    for reason in &exported.left_out {
        println!("left out: {reason}");
    }
    if let Err(error) = std::fs::create_dir_all(FOLDER)
        .and_then(|()| std::fs::write(format!("{FOLDER}/{FILE}"), &exported.text))
    {
        println!("{FOLDER}/{FILE}: {error}");
        return ExitCode::FAILURE;
    }
    println!("{FOLDER}/{FILE}: {} bytes", exported.text.len());

    let mut second = game();
    let server = second.world().resource::<AssetServer>().clone();
    let scene = server.load(GltfAssetLabel::Scene(0).from_asset(FILE));
    second.world_mut().spawn(WorldAssetRoot(scene));
    for _ in 0..2000 {
        second.update();
        if look(&mut second).is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    run(&mut first, 8);
    run(&mut second, 9);
    let (Some((y, spring)), Some((other, again))) = (look(&mut first), look(&mut second)) else {
        println!("the file did not load");
        return ExitCode::FAILURE;
    };
    println!("the lamp rests at {y:.5} m, and in the second game at {other:.5} m");
    let same = (spring.stiffness, spring.damping, spring.rest_length)
        == (again.stiffness, again.damping, again.rest_length);
    let right = same && (y - other).abs() < 1e-3;
    println!(
        "{}",
        if right {
            "as it should be"
        } else {
            "NOT as it should be"
        }
    );
    if right {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
