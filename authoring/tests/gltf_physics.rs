//! Tests that bodies and colliders of `KHR_physics_rigid_bodies` behave as specified in Rapier.

use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, TAU};

pub const G: f32 = 9.81;

pub fn physics(name: &str, at: [f32; 3], physics: Value) -> Value {
    json!({ "name": name, "translation": at, "extensions": { "KHR_physics_rigid_bodies": physics } })
}

pub fn shapes(list: Value) -> Value {
    json!({ "KHR_implicit_shapes": { "shapes": list } })
}

pub fn play(name: &str, nodes: Value, extensions: Value) -> (Folder, Stage, Entity) {
    let folder = Folder::new(name);
    folder.write("a.gltf", gltf(nodes, extensions));
    let mut stage = Stage::new(&folder.0);
    let root = stage.load("a.gltf");
    (folder, stage, root)
}

pub fn mass(stage: &Stage, entity: Entity) -> MassProperties {
    match *stage.get::<AdditionalMassProperties>(entity) {
        AdditionalMassProperties::MassProperties(properties) => properties,
        AdditionalMassProperties::Mass(_) => panic!("mass alone"),
    }
}

#[test]
fn a_motion_arrives_with_its_numbers() {
    let motion = json!({
        "mass": 2.5, "centerOfMass": [0.1, 0.2, 0.3], "inertiaDiagonal": [0.5, 0.25, 0.125],
        "inertiaOrientation": [0.0, 0.70710677, 0.0, 0.70710677],
        "linearVelocity": [0.0, 0.0, 1.0], "angularVelocity": [2.0, 0.0, 0.0], "gravityFactor": 0.0,
    });
    // Velocities are in the local space of the node, which is rotated.
    let mut node = physics("Body", [0.0, 0.0, 0.0], json!({ "motion": motion }));
    node["rotation"] = json!([0.0, 0.70710677, 0.0, 0.70710677]);
    let (_folder, mut stage, root) = play("motion", json!([node]), json!({}));
    let body = stage.node(root, "Body");
    assert_eq!(*stage.get::<RigidBody>(body), RigidBody::Dynamic);
    let wanted = MassProperties {
        mass: 2.5,
        local_center_of_mass: Vec3::new(0.1, 0.2, 0.3),
        principal_inertia: Vec3::new(0.5, 0.25, 0.125),
        principal_inertia_local_frame: Quat::from_rotation_y(FRAC_PI_2),
    };
    let found = mass(&stage, body);
    assert!(
        found
            .principal_inertia_local_frame
            .angle_between(wanted.principal_inertia_local_frame)
            < 1e-3
    );
    assert_eq!(
        MassProperties {
            principal_inertia_local_frame: wanted.principal_inertia_local_frame,
            ..found
        },
        wanted
    );
    run(&mut stage.app, 1.0);
    let at = stage.place(body).translation;
    // The centre of mass moves in a straight line, and the node rotates about it.
    let centre = stage
        .get::<GlobalTransform>(body)
        .transform_point(wanted.local_center_of_mass);
    let started = Quat::from_rotation_y(FRAC_PI_2) * wanted.local_center_of_mass;
    assert!((centre - started).length() > 0.9, "{at}");
    assert!((centre.y - started.y).abs() < 0.3, "no gravity");
}

#[test]
fn mass_comes_from_the_shapes_where_the_file_leaves_it_open() {
    let brick = json!({ "geometry": { "shape": 0 } });
    let nodes = json!([
        physics("Water", [0.0; 3], json!({ "motion": {}, "collider": brick })),
        physics("Light", [9.0, 0.0, 0.0], json!({ "motion": { "mass": 3 }, "collider": brick })),
        // Two bricks side by side on child nodes, one of them scaled and mirrored.
        { "name": "Pair", "translation": [0, 9, 0], "children": [3, 4],
            "extensions": { "KHR_physics_rigid_bodies": { "motion": {} } } },
        physics("Left", [-2.0, 0.0, 0.0], json!({ "collider": brick })),
        { "name": "Right", "translation": [2, 0, 0], "scale": [-1, 2, 1],
            "extensions": { "KHR_physics_rigid_bodies": { "collider": brick } } },
        physics("Nothing", [0.0, 0.0, 9.0], json!({ "motion": { "mass": 6 } })),
        physics("Infinite", [0.0, 0.0, 5.0], json!({ "motion": { "mass": 0, "inertiaDiagonal": [0, 0, 0] } })),
    ]);
    let (_folder, mut stage, root) = play(
        "mass",
        nodes,
        shapes(json!([{ "type": "box", "box": { "size": [1, 2, 3] } }])),
    );
    let of = |stage: &Stage, name: &str| mass(stage, stage.node(root, name));
    let close = |a: f32, b: f32| (a - b).abs() < 1e-3 * b.abs();
    let water = of(&stage, "Water");
    assert!(close(water.mass, 6000.0), "{water:?}");
    let light = of(&stage, "Light");
    let frame = light.principal_inertia_local_frame;
    // Independent of the order of the principal axes.
    let about = |axis: Vec3| {
        let local = frame.inverse() * axis;
        (light.principal_inertia * local * local).element_sum()
    };
    for (axis, wanted) in [
        (Vec3::X, 4.0 + 9.0),
        (Vec3::Y, 1.0 + 9.0),
        (Vec3::Z, 1.0 + 4.0),
    ] {
        assert!(close(about(axis), 3.0 / 12.0 * wanted), "{light:?}");
    }
    let pair = of(&stage, "Pair");
    assert!(close(pair.mass, 18_000.0), "{pair:?}");
    assert!(
        close(pair.local_center_of_mass.x, (12.0 * 2.0 - 6.0 * 2.0) / 18.0),
        "{pair:?}"
    );
    assert_eq!(of(&stage, "Nothing").principal_inertia, Vec3::ONE);
    run(&mut stage.app, 1.0);
    let infinite = stage.node(root, "Infinite");
    assert!(stage.place(infinite).translation.y.abs() < 1e-6);
    // Rapier does not add the mass of the collider.
    let water = stage.node(root, "Water");
    let mut sets = stage.app.world_mut().query::<&RapierRigidBodySet>();
    let handle = stage.get::<RapierRigidBodyHandle>(water).0;
    let set = sets.single(stage.app.world()).expect("one");
    assert!(close(set.bodies[handle].mass(), 6000.0));
}

#[test]
fn every_shape_is_as_large_as_it_says() {
    let all = [
        (
            json!({ "type": "sphere", "sphere": { "radius": 0.5 } }),
            TAU * 2.0 / 3.0 * 0.125,
        ),
        (json!({ "type": "box", "box": { "size": [1, 2, 3] } }), 6.0),
        (json!({ "type": "box" }), 1.0),
        (
            json!({ "type": "cylinder", "cylinder": { "height": 2, "radiusTop": 0.5, "radiusBottom": 0.5 } }),
            TAU * 0.25,
        ),
        (
            json!({ "type": "cylinder", "cylinder": { "height": 3, "radiusTop": 0, "radiusBottom": 1 } }),
            TAU / 2.0,
        ),
        (
            json!({ "type": "cylinder", "cylinder": { "height": 3, "radiusTop": 1, "radiusBottom": 0 } }),
            TAU / 2.0,
        ),
        (
            json!({ "type": "cylinder", "cylinder": { "height": 1, "radiusTop": 1, "radiusBottom": 2 } }),
            TAU / 6.0 * (1.0 + 2.0 + 4.0),
        ),
        (
            json!({ "type": "capsule", "capsule": { "height": 2, "radiusTop": 0.5, "radiusBottom": 0.5 } }),
            TAU * 0.25 + TAU * 2.0 / 3.0 * 0.125,
        ),
        (
            json!({ "type": "capsule", "capsule": { "height": 1, "radiusTop": 0.5, "radiusBottom": 0.501 } }),
            TAU * 0.125 + TAU * 2.0 / 3.0 * 0.125,
        ),
    ];
    let mut nodes = Vec::new();
    for (i, _) in all.iter().enumerate() {
        // On a mirrored node the size follows the absolute value of the scale.
        let mut node = physics(
            &format!("S{i}"),
            [10.0 * i as f32, 0.0, 0.0],
            json!({ "motion": {}, "collider": { "geometry": { "shape": i } } }),
        );
        node["scale"] = json!([-2, -2, -2]);
        nodes.push(node);
    }
    let list: Vec<_> = all.iter().map(|(shape, _)| shape.clone()).collect();
    let (_folder, mut stage, root) = play("shapes", nodes.into(), shapes(list.into()));
    run(&mut stage.app, 2.0 * DT);
    for (i, (shape, volume)) in all.iter().enumerate() {
        let found = mass(&stage, stage.node(root, &format!("S{i}"))).mass / 1000.0 / 8.0;
        // A tapered shape becomes a hull whose round rims have 32 corners.
        assert!(
            (found / volume - 1.0).abs() < 0.02,
            "{shape}: {found} is not {volume}"
        );
        let collider = stage.get::<Collider>(stage.node(root, &format!("S{i}")));
        let real = collider.raw.mass_properties(1.0).mass() / 8.0;
        assert!(
            (real / volume - 1.0).abs() < 0.02,
            "in Rapier, {shape}: {real} is not {volume}"
        );
    }
}

#[test]
fn triggers_tell_and_do_not_push() {
    let nodes = json!([
        physics(
            "Gate",
            [0.0, -2.0, 0.0],
            json!({ "trigger": { "geometry": { "shape": 0 } } })
        ),
        physics(
            "Ball",
            [0.0; 3],
            json!({ "motion": { "mass": 1 }, "collider": { "geometry": { "shape": 0 } } })
        ),
    ]);
    let (_folder, mut stage, root) = play("trigger", nodes, shapes(json!([{ "type": "sphere" }])));
    let mut met = 0;
    for _ in 0..90 {
        stage.app.update();
        let messages = stage.app.world().resource::<Messages<CollisionEvent>>();
        met += messages.iter_current_update_messages().count();
    }
    assert!(met >= 1, "nobody was told");
    let y = stage.place(stage.node(root, "Ball")).translation.y;
    assert!((y + 0.5 * G * 1.5 * 1.5).abs() < 0.4, "it fell freely: {y}");
}

#[test]
fn filters_and_materials_arrive() {
    let kinds = json!({
        "KHR_implicit_shapes": { "shapes": [{ "type": "sphere" }, { "type": "plane" }] },
        "KHR_physics_rigid_bodies": {
            "physicsMaterials": [{ "staticFriction": 0.25, "dynamicFriction": 0.25, "restitution": 0.75,
                "frictionCombine": "minimum", "restitutionCombine": "maximum" }],
            "collisionFilters": [{ "collisionSystems": ["ghost"], "notCollideWithSystems": ["floor"] },
                { "collisionSystems": ["floor"] }],
        },
    });
    let ball = |filter: Value| {
        let mut collider = json!({ "geometry": { "shape": 0 }, "physicsMaterial": 0 });
        if !filter.is_null() {
            collider["collisionFilter"] = filter;
        }
        json!({ "motion": { "mass": 1 }, "collider": collider })
    };
    let nodes = json!([
        physics(
            "Floor",
            [0.0; 3],
            json!({ "collider": { "geometry": { "shape": 1 }, "collisionFilter": 1 } })
        ),
        physics("Ball", [0.0, 1.0, 0.0], ball(Value::Null)),
        physics("Ghost", [5.0, 1.0, 0.0], ball(json!(0))),
    ]);
    let (_folder, mut stage, root) = play("filters", nodes, kinds);
    let [ball, ghost] = ["Ball", "Ghost"].map(|name| stage.node(root, name));
    let friction = stage.get::<Friction>(ball);
    assert_eq!(
        (friction.coefficient, friction.combine_rule),
        (0.25, CoefficientCombineRule::Min)
    );
    let bounce = stage.get::<Restitution>(ball);
    assert_eq!(
        (bounce.coefficient, bounce.combine_rule),
        (0.75, CoefficientCombineRule::Max)
    );
    run(&mut stage.app, 3.0);
    assert!(stage.place(ball).translation.y > 0.4);
    assert!(stage.place(ghost).translation.y < -5.0);
}

#[test]
fn what_cannot_be_honoured_does_not_stop_the_rest() {
    let nodes = json!([
        physics(
            "Hook",
            [0.0; 3],
            json!({ "joint": { "connectedNode": 9, "joint": 0 } })
        ),
        physics(
            "Lost",
            [0.0; 3],
            json!({ "joint": { "connectedNode": 2, "joint": 7 } })
        ),
        physics(
            "Body",
            [0.0; 3],
            json!({ "motion": { "mass": -1, "shoe": 3 }, "collider": { "geometry": { "shape": 5 } } })
        ),
        physics(
            "Alone",
            [0.0; 3],
            json!({ "joint": { "connectedNode": 0, "joint": 0 } })
        ),
        physics(
            "Odd",
            [0.0; 3],
            json!({ "joint": { "connectedNode": 2, "joint": 0 } })
        ),
        physics("Wrong", [0.0; 3], json!([1, 2])),
        physics(
            "Flat",
            [9.0, 0.0, 0.0],
            json!({ "collider": { "geometry": { "node": 0 } } })
        ),
    ]);
    let kinds = json!({ "KHR_physics_rigid_bodies": { "physicsJoints": [{ "limits": [
        { "angularAxes": [0, 1, 2], "max": 1 }, { "linearAxes": [0, 5], "max": -3 }, 7] }] } });
    let (_folder, mut stage, root) = play("odd", nodes, kinds);
    run(&mut stage.app, 1.0);
    let body = stage.node(root, "Body");
    assert!(stage.place(body).translation.is_finite());
    assert!(mass(&stage, body).mass > 0.0);
}

#[test]
fn bodies_below_turned_nodes_and_turned_scenes_fall_down() {
    let folder = Folder::new("turned");
    let ball = json!({ "motion": { "mass": 1, "linearVelocity": [0, 0, 1] } });
    let mut frame = json!({ "name": "Frame", "children": [1], "translation": [1, 0, 0] });
    frame["rotation"] = json!([0.5, 0.5, 0.5, 0.5]);
    let nodes = json!([frame, physics("Ball", [0.0, 0.0, 2.0], ball)]);
    folder.write("a.gltf", gltf(nodes, json!({})));
    let mut stage = Stage::new(&folder.0);
    let turned = Quat::from_rotation_x(1.0);
    let before = stage.app.world().entities().count_spawned();
    for place in [
        Transform::default(),
        Transform::from_xyz(0.0, 3.0, 0.0).with_rotation(turned),
    ] {
        let root = stage.load_at("a.gltf", place);
        let ball = stage.node(root, "Ball");
        // The frame maps (x, y, z) to (z, x, y).
        let start = place.transform_point(Vec3::new(1.0 + 2.0, 0.0, 0.0));
        let velocity = place.rotation * Vec3::X;
        let (at, moving) = (stage.place(ball).translation, *stage.get::<Velocity>(ball));
        let ticks = moving.linear.y - velocity.y;
        assert!(at.distance(start) < 0.1, "{at} is not {start} ({ticks})");
        run(&mut stage.app, 1.0);
        let now = stage.place(ball).translation;
        let seconds = -(stage.get::<Velocity>(ball).linear.y - velocity.y) / G;
        let wanted = start + velocity * seconds - Vec3::Y * 0.5 * G * seconds * seconds;
        assert!((0.9..1.2).contains(&seconds), "{seconds}");
        assert!(
            now.distance(wanted) < 0.1,
            "{now} is not {wanted} after {seconds} s"
        );
        stage.app.world_mut().despawn(root);
    }
    run(&mut stage.app, 0.1);
    assert_eq!(stage.app.world().entities().count_spawned(), before);
}

#[test]
fn a_body_below_a_turning_one_goes_its_own_way() {
    let folder = Folder::new("own_way");
    let spins = json!({ "motion": { "mass": 1, "inertiaDiagonal": [1, 1, 1], "angularVelocity": [0, 3, 0],
        "linearVelocity": [1, 0, 0], "gravityFactor": 0 } });
    let flies = json!({ "motion": { "mass": 1, "inertiaDiagonal": [1, 1, 1], "linearVelocity": [0, 0, 2],
        "gravityFactor": 0 } });
    let mut top = physics("Top", [1.0, 2.0, 3.0], spins);
    top["children"] = json!([1]);
    let mut arm = json!({ "name": "Arm", "translation": [0, 1, 0], "children": [2] });
    arm["rotation"] = json!([0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]);
    let ball = physics("Ball", [0.0, 0.0, 2.0], flies);
    folder.write("a.gltf", gltf(json!([top, arm, ball]), json!({})));
    let mut stage = Stage::new(&folder.0);
    let before = stage.app.world().entities().count_spawned();
    let root = stage.load("a.gltf");
    let (top, ball) = (stage.node(root, "Top"), stage.node(root, "Ball"));
    let start = [top, ball].map(|body| stage.place(body).translation);
    run(&mut stage.app, 1.0);
    let now = [top, ball].map(|body| stage.place(body).translation);
    let gone = [0, 1].map(|i| now[i] - start[i]);
    // The ball's velocity is in its own frame, which is rotated by 90° about Y.
    assert!(gone[0].distance(Vec3::X) < 0.02, "{}", gone[0]);
    assert!(gone[1].distance(2.0 * Vec3::X) < 0.04, "{}", gone[1]);
    // The ball starts 2 m along the rotated arm and 1 m above the top body.
    assert!((start[1].y - 3.0).abs() < 0.01, "{}", start[1]);
    stage.app.world_mut().despawn(root);
    run(&mut stage.app, 0.1);
    assert_eq!(stage.app.world().entities().count_spawned(), before);
}
