//! Builds apps with physics, springs and file loaders, and steps them tick by tick.

use bevy::gltf::{GltfLoaderSettings, GltfPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::HashSet;
use std::path::Path;
use std::time::{Duration, Instant};

pub const DT: f32 = 1.0 / 60.0;

/// A headless app with Rapier, one tick per update. It has neither springs nor file loaders.
pub fn app() -> App {
    let mut app = App::new();
    let tick = Duration::from_secs_f32(DT);
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .insert_resource(TimestepMode::Fixed {
            dt: DT,
            substeps: 1,
        })
        .insert_resource(Time::<Fixed>::from_duration(tick))
        .insert_resource(TimeUpdateStrategy::ManualDuration(tick))
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule());
    app
}

/// [`app`] with Bevy's glTF loader, which reads files from a folder.
pub fn app_with_files(folder: &Path) -> App {
    let mut app = app();
    app.add_plugins((
        AssetPlugin {
            file_path: folder.to_string_lossy().into_owned(),
            watch_for_changes_override: Some(false),
            unapproved_path_mode: bevy::asset::UnapprovedPathMode::Allow,
            ..default()
        },
        bevy::image::ImagePlugin::default(),
        bevy::mesh::MeshPlugin,
        bevy_world_serialization::WorldSerializationPlugin,
        GltfPlugin::default(),
    ))
    .init_asset::<StandardMaterial>()
    .register_type::<Visibility>()
    .register_type::<InheritedVisibility>()
    .register_type::<ViewVisibility>()
    .register_type::<Name>();
    app
}

/// Finishes an app's plugins and makes the first update.
pub fn prime(app: &mut App) {
    app.finish();
    app.cleanup();
    app.update();
}

pub fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / DT).round() as usize {
        app.update();
    }
}

/// Updates until `look` returns something, and returns that. Panics with `what` after five minutes: a file with a
/// million springs takes more than one.
pub fn until<T>(app: &mut App, what: &str, mut look: impl FnMut(&mut App) -> Option<T>) -> T {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(300) {
        app.update();
        if let Some(found) = look(app) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("waited five minutes for {what}");
}

/// The only entity with this name. Panics if there are none or several.
pub fn named(app: &mut App, name: &str) -> Entity {
    let mut names = app.world_mut().query::<(Entity, &Name)>();
    let all: Vec<_> = names
        .iter(app.world())
        .filter(|(_, found)| found.as_str() == name)
        .map(|(entity, _)| entity)
        .collect();
    assert_eq!(all.len(), 1, "entities with the name {name}");
    all[0]
}

/// Spawns a hook at a height of 2 m and a body of 1 kg at the origin.
pub fn spawn_ends(app: &mut App) -> [Entity; 2] {
    let world = app.world_mut();
    let hook = world.spawn((Name::new("Hook"), Transform::from_xyz(0.0, 2.0, 0.0)));
    let hook = hook.id();
    let weight = (
        Name::new("Weight"),
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(1.0),
        Transform::default(),
    );
    [hook, world.spawn(weight).id()]
}

/// A primed app with physics and springs.
pub fn game() -> App {
    let mut app = app();
    app.add_plugins(CoiloverPlugin::default());
    prime(&mut app);
    app
}

/// A temporary folder for a test's files, removed on drop.
pub struct Folder(pub std::path::PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("coilover_{name}_{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), content).expect("writes");
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// An app with springs that loads and simulates glTF files from a folder.
pub struct Stage {
    pub app: App,
    /// Whether Bevy's loader validates files. A validating loader refuses files that require an unknown extension.
    pub validate: bool,
}

impl Stage {
    pub fn new(folder: &Path) -> Self {
        let mut app = app_with_files(folder);
        app.add_plugins((CoiloverPlugin::default(), CoiloverGltfPlugin));
        prime(&mut app);
        Self {
            app,
            validate: true,
        }
    }

    /// Spawns the first scene of a file at a place, waits until it is loaded, and returns its root.
    pub fn load_at(&mut self, file: &str, place: Transform) -> Entity {
        let root = self.spawn(file, place);
        until(&mut self.app, file, |app| {
            app.world().get::<Children>(root).map(|_| ())
        });
        root
    }

    pub fn load(&mut self, file: &str) -> Entity {
        self.load_at(file, Transform::default())
    }

    /// Spawns the first scene of a file, without waiting for it, and returns its root.
    pub fn spawn(&mut self, file: &str, place: Transform) -> Entity {
        let server = self.app.world().resource::<AssetServer>().clone();
        let validate = self.validate;
        let handle = server
            .load_builder()
            .with_settings(move |settings: &mut GltfLoaderSettings| settings.validate = validate)
            .load(GltfAssetLabel::Scene(0).from_asset(file.to_owned()));
        let root = (WorldAssetRoot(handle), place, Visibility::default());
        self.app.world_mut().spawn(root).id()
    }

    /// The node with this name at or below a root.
    pub fn node(&self, root: Entity, name: &str) -> Entity {
        let world = self.app.world();
        let mut open = vec![root];
        while let Some(entity) = open.pop() {
            if world
                .get::<Name>(entity)
                .is_some_and(|n| n.as_str() == name)
            {
                return entity;
            }
            open.extend(world.get::<Children>(entity).into_iter().flatten());
        }
        panic!("no node {name}");
    }

    pub fn get<C: Component>(&self, entity: Entity) -> &C {
        let found = self.app.world().get::<C>(entity);
        found.unwrap_or_else(|| panic!("no {}", std::any::type_name::<C>()))
    }

    pub fn place(&self, entity: Entity) -> Transform {
        self.get::<GlobalTransform>(entity).compute_transform()
    }

    pub fn faults(&mut self) -> Vec<String> {
        let mut faults = self.app.world_mut().query::<&SpringFault>();
        let mut all: Vec<_> = faults
            .iter(self.app.world())
            .map(|f| format!("{} {}", f.field, f.reason))
            .collect();
        all.sort();
        all
    }

    pub fn count<C: Component>(&mut self) -> usize {
        let mut found = self.app.world_mut().query::<&C>();
        found.iter(self.app.world()).count()
    }
}

/// Text of a glTF file with these nodes and root extensions.
pub fn gltf(nodes: serde_json::Value, extensions: serde_json::Value) -> String {
    let children: HashSet<u64> = nodes
        .as_array()
        .into_iter()
        .flatten()
        .flat_map(|node| node["children"].as_array().cloned().unwrap_or_default())
        .filter_map(|child| child.as_u64())
        .collect();
    let count = nodes.as_array().map_or(0, Vec::len) as u64;
    let roots: Vec<u64> = (0..count).filter(|i| !children.contains(i)).collect();
    serde_json::json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["BEVY_coilover", "KHR_physics_rigid_bodies", "KHR_implicit_shapes"],
        "scene": 0,
        "scenes": [{ "nodes": roots }],
        "nodes": nodes,
        "extensions": extensions,
    })
    .to_string()
}
