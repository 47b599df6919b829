//! Tests that what stands still in a glTF file is a fixed body where an element or a joint needs one, and that bodies are
//! where the file says.

use crate::gltf_elements::element;
use crate::gltf_export::{root, round_trip};
use crate::gltf_physics::{physics, play, shapes};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// A body without gravity that turns about Z by 1 rad/s.
fn wheel(at: [f32; 3]) -> Value {
    let motion = json!({ "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1], "gravityFactor": 0,
        "angularVelocity": [0, 0, 1] });
    physics("Wheel", at, json!({ "motion": motion }))
}

fn wall(at: [f32; 3]) -> Value {
    let collider = json!({ "geometry": { "shape": 0 } });
    physics("Wall", at, json!({ "collider": collider }))
}

fn boxes() -> Value {
    shapes(json!([{ "type": "box" }]))
}

#[test]
fn a_torsion_spring_holds_a_wheel_at_what_stands_still() {
    let bare = json!({ "name": "Wall" });
    // At a node with a collider, at one below it, and at a node with nothing.
    for (name, stands, a) in [
        ("collider", wall([0.0, 0.0, -2.0]), 0),
        ("below", wall([0.0, 0.0, -2.0]), 3),
        ("bare", bare, 0),
    ] {
        let mut stands = stands;
        stands["children"] = json!([3]);
        let spring = json!({ "a": a, "b": 1, "axis": [0, 0, 1], "stiffness": 10 });
        let spring = element(json!({ "torsionSpring": spring }));
        let nodes = json!([stands, wheel([0.0; 3]), spring, { "name": "Peg" }]);
        let (_folder, mut stage, root) = play(&format!("still_{name}"), nodes, boxes());
        run(&mut stage.app, 0.5);
        assert_eq!(stage.faults(), Vec::<String>::new(), "{name}");
        let kind = stage.get::<RigidBody>(stage.node(root, "Wall"));
        assert_eq!(*kind, RigidBody::Fixed, "{name}");
        assert_eq!(stage.count::<RigidBody>(), 2, "{name}");
        // It swings by (1 rad/s) / √(k/I) = 0.1 rad. Free, it would turn by 0.5 rad.
        let turned = stage.place(stage.node(root, "Wheel")).rotation;
        let angle = turned.angle_between(Quat::IDENTITY);
        assert!(angle < 0.12, "{name}: {angle}");
    }
}

#[test]
fn elements_that_need_a_fixed_body_can_act_after_a_file() {
    let (_, _, mut stage) = round_trip("fixed_out", |world| {
        let root = root(world);
        let quarter = Transform::from_rotation(Quat::from_rotation_z(FRAC_PI_2));
        let rail = (Name::new("Rail"), RigidBody::Fixed, quarter, ChildOf(root));
        let rail = world.spawn(rail).id();
        let wall = (RigidBody::Fixed, Collider::ball(0.1), ChildOf(root));
        let wall = (Name::new("Wall"), Transform::from_xyz(0.0, 0.0, 9.0), wall);
        let wall = world.spawn(wall).id();
        let own = AdditionalMassProperties::MassProperties(MassProperties {
            mass: 1.0,
            principal_inertia: Vec3::splat(0.1),
            ..default()
        });
        let cart = (RigidBody::Dynamic, own, Transform::from_xyz(0.0, 1.0, 0.0));
        let cart = (Name::new("Cart"), cart, ChildOf(root));
        let cart = world.spawn(cart).id();
        let slide = SpringDamper::new(rail, cart)
            .with_stiffness(100.0)
            .with_damping(20.0)
            .with_rest_length(1.0);
        // X of the rail is Y of the world.
        world.spawn((slide, SpringAxis::BodyA(Vec3::X), ChildOf(root)));
        world.spawn((TorsionDamper::new(wall, cart, Vec3::Z), ChildOf(root)));
        root
    });
    run(&mut stage.app, 3.0);
    assert_eq!(stage.faults(), Vec::<String>::new());
    for name in ["Rail", "Wall"] {
        let entity = named(&mut stage.app, name);
        assert_eq!(*stage.get::<RigidBody>(entity), RigidBody::Fixed, "{name}");
    }
    let cart = named(&mut stage.app, "Cart");
    let y = stage.place(cart).translation.y;
    assert!((y - (1.0 - 9.81 / 100.0)).abs() < 1e-3, "{y}");
}

#[test]
fn bodies_below_a_turned_and_unevenly_scaled_node_are_where_the_file_says() {
    let frame = Transform::from_xyz(1.0, 0.0, 0.0)
        .with_rotation(Quat::from_rotation_z(FRAC_PI_4))
        .with_scale(Vec3::new(1.0, 2.0, 1.0));
    let [at_wall, at_wheel] = [Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, 1.0, 3.0)];
    let above = json!({ "name": "Frame", "children": [1, 2], "translation": frame.translation.to_array(),
        "rotation": frame.rotation.to_array(), "scale": frame.scale.to_array() });
    let damper = json!({ "torsionDamper": { "a": 1, "b": 2, "axis": [0, 0, 1], "damping": 1 } });
    let [wall, wheel] = [wall(at_wall.to_array()), wheel(at_wheel.to_array())];
    let nodes = json!([above, wall, wheel, element(damper)]);
    let (_folder, mut stage, root) = play("below_uneven", nodes, boxes());
    run(&mut stage.app, 0.5);
    assert_eq!(stage.faults(), Vec::<String>::new());
    for (name, at) in [("Wall", at_wall), ("Wheel", at_wheel)] {
        let found = stage.place(stage.node(root, name)).translation;
        let wanted = frame.transform_point(at);
        assert!(
            found.distance(wanted) < 1e-4,
            "{name}: {found}, not {wanted}"
        );
    }
}

#[test]
fn colliders_below_a_body_in_a_scaled_scene_are_where_the_scene_shows_them() {
    let folder = Folder::new("compound");
    let motion = json!({ "mass": 1, "inertiaDiagonal": [1, 1, 1], "gravityFactor": 0 });
    let mut body = physics("Body", [1.0, 2.0, 3.0], json!({ "motion": motion }));
    body["children"] = json!([2]);
    body["scale"] = json!([1.5, 1.5, 1.5]);
    let collider = json!({ "geometry": { "shape": 0 } });
    let arm = physics("Arm", [0.5, 0.0, 0.25], json!({ "collider": collider }));
    let frame =
        json!({ "name": "Frame", "children": [1], "scale": [1, 3, 1], "translation": [0, 1, 0] });
    folder.write("a.gltf", gltf(json!([frame, body, arm]), boxes()));
    let mut stage = Stage::new(&folder.0);
    // A rotation of 3e-4 rad is below what the scalar product of two quaternions can tell from none.
    let turned = Quat::from_rotation_z(3e-4);
    for place in [
        Transform::from_scale(Vec3::splat(2.0)),
        Transform::from_rotation(turned).with_scale(Vec3::splat(2.0)),
    ] {
        let root = stage.load_at("a.gltf", place);
        run(&mut stage.app, 3.0 * DT);
        let arm = stage.node(root, "Arm");
        let wanted = place.transform_point(Vec3::new(1.75, 1.0 + 6.0, 3.375));
        let shown = stage.place(arm).translation;
        assert!(shown.distance(wanted) < 1e-4, "{shown}, not {wanted}");
        let handle = stage.get::<RapierColliderHandle>(arm).0;
        let mut contexts = stage.app.world_mut().query::<&RapierContextColliders>();
        let context = contexts.single(stage.app.world()).expect("one");
        let found = context.colliders[handle].position().translation;
        assert!(found.distance(wanted) < 1e-4, "{found}, not {wanted}");
        stage.app.world_mut().despawn(root);
    }
}
