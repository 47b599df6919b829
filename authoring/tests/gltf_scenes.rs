//! Tests that springs from glTF files attach where their nodes are, leave nothing behind when they are despawned, and do
//! no harm when they are invalid.

use crate::gltf_elements::{element, hook, rig, weight};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::json;

#[test]
fn nested_scaled_and_mirrored_nodes_are_held_where_the_file_says() {
    let folder = Folder::new("nested");
    let spring = |a: usize, b: usize| {
        element(json!({
            "spring": { "a": a, "b": b, "stiffness": 1 },
            "anchors": { "a": [0, 0.5, 0], "b": [0.25, 0, 0] },
        }))
    };
    // The hook is a child of a frame that is rotated, scaled and mirrored. The node of the weight is scaled.
    let mut body = weight();
    body["scale"] = json!([2, 2, 2]);
    body["translation"] = json!([1, 0, 0]);
    let frame = json!({ "name": "Frame", "children": [1], "translation": [0, 1, 0],
        "rotation": [0, 0, 0.70710677, 0.70710677], "scale": [2, -1, 3] });
    let mut hook = hook();
    hook["translation"] = json!([0.5, 2, 0]);
    folder.write(
        "nested.gltf",
        gltf(json!([frame, hook, body, spring(1, 2)]), json!({})),
    );
    let mut stage = Stage::new(&folder.0);
    // World position computed by hand: frame · hook · anchor.
    let frame = Transform::from_xyz(0.0, 1.0, 0.0)
        .with_rotation(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::new(2.0, -1.0, 3.0));
    let a = frame.transform_point(Vec3::new(0.5, 2.5, 0.0));
    let b = Vec3::new(1.5, 0.0, 0.0);
    for place in [
        Transform::default(),
        Transform::from_xyz(5.0, 0.0, 0.0).with_rotation(Quat::from_rotation_y(1.0)),
    ] {
        let root = stage.load_at("nested.gltf", place);
        run(&mut stage.app, 2.0 * DT);
        let element = stage.node(root, "Element");
        let length = stage.get::<SpringReadout>(element).length;
        assert!(
            (length - a.distance(b)).abs() < 0.01,
            "{length} against {}",
            a.distance(b)
        );
        stage.app.world_mut().despawn(root);
    }
}

#[test]
fn a_scene_loaded_twice_is_two_scenes_and_nothing_stays_behind() {
    let folder = Folder::new("twice");
    folder.write(
        "a.gltf",
        rig(&json!({ "springDamper": { "a": 0, "b": 1, "stiffness": 100, "damping": 2 } })),
    );
    let mut stage = Stage::new(&folder.0);
    run(&mut stage.app, 0.1);
    let before = stage.app.world().entities().count_spawned();
    for _ in 0..3 {
        let one = stage.spawn("a.gltf", Transform::default());
        let two = stage.spawn("a.gltf", Transform::from_xyz(3.0, 0.0, 0.0));
        for root in [one, two] {
            until(&mut stage.app, "both", |app| {
                app.world().get::<Children>(root).map(|_| ())
            });
        }
        run(&mut stage.app, 0.5);
        for root in [one, two] {
            let pair = *stage.get::<SpringDamper>(stage.node(root, "Element"));
            assert_eq!(
                [pair.body_a, pair.body_b],
                ["Hook", "Weight"].map(|n| stage.node(root, n))
            );
        }
        let [y, other] =
            [one, two].map(|root| stage.place(stage.node(root, "Weight")).translation.y);
        assert!(y < -0.05 && (y - other).abs() < 1e-4, "{y} and {other}");
        stage.app.world_mut().despawn(one);
        stage.app.world_mut().despawn(two);
        run(&mut stage.app, 0.1);
        assert_eq!(stage.app.world().entities().count_spawned(), before);
        assert_eq!(stage.count::<RigidBody>(), 0);
        let mut sets = stage.app.world_mut().query::<&RapierRigidBodySet>();
        let bodies: usize = sets
            .iter(stage.app.world())
            .map(|set| set.bodies.len())
            .sum();
        assert_eq!(bodies, 0, "in Rapier");
    }
}

#[test]
fn the_engine_gets_the_bodies_in_the_order_of_the_file_each_time_it_is_loaded() {
    const COUNT: usize = 12;
    let folder = Folder::new("order");
    let name = |i: usize| format!("Body {i}");
    let mut nodes = Vec::new();
    for i in 0..COUNT {
        let mut body = weight();
        body["name"] = json!(name(i));
        body["translation"] = json!([i, 0, 0]);
        nodes.push(body);
    }
    // A tree that a depth-first walk visits in another order than that of the file.
    nodes.push(json!({ "children": [7, 3, 11] }));
    nodes.push(json!({ "children": [12, 5, 0] }));
    folder.write("a.gltf", gltf(nodes.into(), json!({})));
    let mut stage = Stage::new(&folder.0);
    for _ in 0..3 {
        let root = stage.load("a.gltf");
        run(&mut stage.app, 2.0 * DT);
        let world = stage.app.world_mut();
        // The engine inserts bodies in the order of a query.
        let mut bodies = world.query_filtered::<&Name, With<RigidBody>>();
        let names = bodies.iter(world).map(|name| name.as_str().to_owned());
        let found: Vec<String> = names.collect();
        assert_eq!(found, (0..COUNT).map(name).collect::<Vec<_>>());
        world.despawn(root);
        run(&mut stage.app, 2.0 * DT);
    }
}

#[test]
fn hot_reload_puts_the_new_spring_in_the_place_of_the_old() {
    let folder = Folder::new("reload");
    let file =
        |k: f32| rig(&json!({ "springDamper": { "a": 0, "b": 1, "stiffness": k, "damping": 2 } }));
    folder.write("a.gltf", file(100.0));
    let mut stage = Stage::new(&folder.0);
    // Keeps the asset alive, so that the server can reload it.
    let server = stage.app.world().resource::<AssetServer>().clone();
    let _held: Handle<Gltf> = server.load("a.gltf");
    stage.load("a.gltf");
    run(&mut stage.app, 0.2);
    let entities = stage.app.world().entities().count_spawned();
    folder.write("a.gltf", file(250.0));
    stage.app.world().resource::<AssetServer>().reload("a.gltf");
    until(&mut stage.app, "the new stiffness", |app| {
        let mut pairs = app.world_mut().query::<&SpringDamper>();
        let pair = pairs.single(app.world()).ok()?;
        (pair.stiffness == 250.0).then_some(())
    });
    run(&mut stage.app, 0.2);
    assert_eq!(stage.app.world().entities().count_spawned(), entities);
    assert_eq!(stage.count::<RigidBody>(), 1);
    assert!(stage.faults().is_empty());
    let mut seen = stage.app.world_mut().query::<&SpringReadout>();
    assert!(seen.single(stage.app.world()).expect("one").force() > 0.0);
}

#[test]
fn broken_springs_have_faults_and_their_neighbour_swings_on() {
    let folder = Folder::new("broken");
    let mut nodes = vec![hook(), weight()];
    nodes.push(element(
        json!({ "springDamper": { "a": 0, "b": 1, "stiffness": 100, "damping": 2 } }),
    ));
    let broken = [
        json!({ "spring": { "a": 0, "b": 1, "stiffness": -5 } }),
        json!({ "spring": { "a": 0, "b": 99 } }),
        json!({ "spring": { "a": 1, "b": 1 } }),
        json!({ "spring": { "a": 0, "b": 1, "stiffness": 1e300 } }),
        json!({ "springDamper": { "b": 1 } }),
        json!({ "torsionSpring": { "a": 0, "b": 1, "axis": [0, 0, 0] } }),
    ];
    nodes.extend(broken.iter().cloned().map(element));
    // These spawn no elements.
    for nonsense in [json!([]), json!(null), json!({ "spring": 3 }), json!({})] {
        nodes.push(element(nonsense));
    }
    folder.write("a.gltf", gltf(nodes.into(), json!({})));
    let mut stage = Stage::new(&folder.0);
    stage.load("a.gltf");
    run(&mut stage.app, 0.5);
    let faults = stage.faults();
    assert_eq!(faults.len(), broken.len(), "{faults:#?}");
    let all = faults.join("\n");
    for part in [
        "stiffness is negative",
        "stiffness is infinite",
        "same entity",
        "body_b is an entity that does not exist",
        "axis is zero",
    ] {
        assert!(all.contains(part), "{part} in {all}");
    }
    let weight = named(&mut stage.app, "Weight");
    assert!(stage.place(weight).translation.y < -0.05);
}

#[test]
fn broken_files_do_not_load_and_do_not_stop_the_game() {
    let folder = Folder::new("files");
    let right = rig(&json!({ "spring": { "a": 0, "b": 1 } }));
    folder.write("right.gltf", &right);
    folder.write("cut.gltf", &right[..right.len() / 2]);
    folder.write("huge.gltf", right.replace("\"a\":0", "\"a\":1e999"));
    folder.write("nan.gltf", right.replace("\"a\":0", "\"a\":NaN"));
    folder.write(
        "circle.gltf",
        gltf(
            json!([{ "children": [1] }, { "children": [0] }, hook()]),
            json!({}),
        ),
    );
    let mut stage = Stage::new(&folder.0);
    for file in ["cut.gltf", "huge.gltf", "nan.gltf", "circle.gltf"] {
        stage.spawn(file, Transform::default());
    }
    run(&mut stage.app, 0.5);
    let root = stage.load("right.gltf");
    run(&mut stage.app, 0.1);
    stage.node(root, "Element");
    assert_eq!(stage.count::<Spring>(), 1);
}

#[test]
fn springs_by_the_hundred_thousand_load_in_seconds() {
    // `COILOVER_SPRINGS=1000000` tests with a million.
    let many = std::env::var("COILOVER_SPRINGS").ok();
    let many = many.map_or(100_000, |many| many.parse().expect("a number"));
    let folder = Folder::new("many");
    let mut nodes = vec![hook(), weight()];
    for _ in 0..many {
        nodes.push(json!({ "extensions": { "BEVY_coilover": { "spring": { "a": 0, "b": 1, "stiffness": -1 } } } }));
    }
    let children: Vec<usize> = (2..nodes.len()).collect();
    nodes.push(json!({ "children": children }));
    folder.write("many.gltf", gltf(nodes.into(), json!({})));
    let mut stage = Stage::new(&folder.0);
    let started = std::time::Instant::now();
    stage.load("many.gltf");
    let took = started.elapsed();
    println!("{many} springs: {took:?}");
    assert!(
        took.as_secs() < 60 * (1 + many as u64 / 200_000),
        "{took:?}"
    );
    assert_eq!(stage.count::<Spring>(), many);
}
