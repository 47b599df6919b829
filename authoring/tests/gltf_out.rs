//! Tests that a scene behaves the same after a round trip through a glTF file.

use crate::gltf_export::{close, root, round_trip};
use crate::harness::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::{Value, json};
use std::f32::consts::{FRAC_PI_2, PI};

fn json_of(world: &World, roots: impl IntoIterator<Item = Entity>) -> Value {
    serde_json::from_str(&export_gltf(world, roots).text).expect("JSON")
}

/// All nodes with this name.
fn nodes<'a>(file: &'a Value, name: &str) -> Vec<&'a Value> {
    let nodes = file["nodes"].as_array().into_iter().flatten();
    nodes.filter(|node| node["name"] == name).collect()
}

#[test]
fn the_same_bodies_fall_through_the_same_floors() {
    let (_, _, mut stage) = round_trip("filters_out", |world| {
        let root = root(world);
        let slab = |name: &str, at: Vec3, half: Vec3| {
            (
                Name::new(name.to_owned()),
                Transform::from_translation(at),
                Collider::cuboid(half.x, half.y, half.z),
                ChildOf(root),
            )
        };
        let ball = |name: &str, x: f32| {
            (
                Name::new(name.to_owned()),
                Transform::from_xyz(x, 4.0, 0.0),
                RigidBody::Dynamic,
                Collider::ball(0.5),
                ChildOf(root),
            )
        };
        // A shelf in group 1 above a floor without collision groups.
        world.spawn(slab("Floor", Vec3::ZERO, Vec3::new(9.0, 0.5, 9.0)));
        let shelf = slab("Shelf", Vec3::Y * 2.0, Vec3::new(9.0, 0.1, 1.0));
        world.spawn((shelf, CollisionGroups::new(Group::GROUP_1, Group::GROUP_1)));
        world.spawn(ball("Plain", -4.0));
        let [one, two] = [Group::GROUP_1, Group::GROUP_2];
        world.spawn((ball("Other", -1.0), CollisionGroups::new(two, two)));
        world.spawn((ball("Either", 2.0), CollisionGroups::new(one | two, one)));
        world.spawn((ball("Ghost", 5.0), CollisionGroups::new(one, Group::NONE)));
        root
    });
    for (name, memberships, filters) in [
        ("Floor", Group::ALL, Group::ALL),
        ("Shelf", Group::GROUP_1, Group::GROUP_1),
        ("Other", Group::GROUP_2, Group::GROUP_2),
        ("Either", Group::GROUP_1 | Group::GROUP_2, Group::GROUP_1),
        ("Ghost", Group::GROUP_1, Group::NONE),
    ] {
        let entity = named(&mut stage.app, name);
        let wanted = CollisionGroups::new(memberships, filters);
        assert_eq!(*stage.get::<CollisionGroups>(entity), wanted, "{name}");
    }
    run(&mut stage.app, 4.0);
    let mut height = |name: &str| {
        let entity = named(&mut stage.app, name);
        stage.place(entity).translation.y
    };
    for (name, wanted) in [("Plain", 2.6), ("Other", 1.0), ("Either", 2.6)] {
        let found = height(name);
        assert!((found - wanted).abs() < 0.05, "{name} rests at {found} m");
    }
    assert!(height("Ghost") < -9.0, "nothing stops the ghost");
}

#[test]
fn a_file_has_the_same_masses_before_the_first_step_as_after_it() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let body = |name: &str, x: f32| {
        (
            Name::new(name.to_owned()),
            RigidBody::Dynamic,
            GravityScale(0.0),
            Transform::from_xyz(x, 0.0, 0.0),
            ChildOf(root),
        )
    };
    let cube = Collider::cuboid(0.5, 0.5, 0.5);
    let own = MassProperties {
        mass: 0.7,
        principal_inertia: Vec3::new(0.1, 0.2, 0.3),
        ..default()
    };
    // Cubes of Rapier's density, 1 kg/m³: 1 m³, 8 m³, with additional mass, and with a second collider.
    world.spawn((body("Cube", 0.0), cube.clone()));
    let mut large = world.spawn((body("Large", 5.0), cube.clone()));
    large.insert(Transform::from_xyz(5.0, 0.0, 0.0).with_scale(Vec3::splat(2.0)));
    let more = AdditionalMassProperties::Mass(1.5);
    world.spawn((body("More", 10.0), cube.clone(), more));
    let none = ColliderMassProperties::Density(0.0);
    world.spawn((body("Spread", 15.0), cube.clone(), none, more));
    let given = AdditionalMassProperties::MassProperties(own);
    world.spawn((body("Both", 20.0), cube.clone(), given));
    let pair = world.spawn((body("Pair", 25.0), cube.clone())).id();
    world.spawn((
        cube,
        ColliderMassProperties::Mass(3.0),
        Transform::from_xyz(0.0, 2.0, 0.0),
        ChildOf(pair),
    ));
    let before = json_of(world, [root]);
    run(&mut app, 0.1);
    let after = json_of(app.world(), [root]);
    for (name, mass) in [
        ("Cube", 1.0),
        ("Large", 8.0),
        ("More", 2.5),
        ("Spread", 1.5),
        ("Both", 1.7),
        ("Pair", 4.0),
    ] {
        let motion = |file: &Value| {
            let node = nodes(file, name)[0];
            node["extensions"]["KHR_physics_rigid_bodies"]["motion"].clone()
        };
        close(&motion(&before), &motion(&after), name);
        // Mass and moments of inertia are the same as in Rapier.
        let entity = named(&mut app, name);
        let world = app.world_mut();
        let handle = world
            .get::<RapierRigidBodyHandle>(entity)
            .expect("a body")
            .0;
        let mut sets = world.query::<&RapierRigidBodySet>();
        let set = sets.single(world).expect("one");
        let engine = set.bodies[handle].mass_properties().local_mprops;
        let written = motion(&before);
        let sum = |list: &Value| -> f64 {
            let numbers = list.as_array().into_iter().flatten();
            numbers.filter_map(Value::as_f64).sum()
        };
        let inertia: f64 = engine.principal_inertia().element_sum().into();
        let found = [
            written["mass"].as_f64().unwrap_or(f64::NAN),
            sum(&written["inertiaDiagonal"]),
        ];
        for (found, wanted) in found.into_iter().zip([mass, inertia]) {
            assert!((found / wanted - 1.0).abs() < 1e-4, "{name}: {written}");
        }
        let engine_mass: f64 = engine.mass().into();
        assert!((engine_mass / mass - 1.0).abs() < 1e-4, "{name} in Rapier");
    }
}

#[test]
fn a_root_below_another_root_is_written_once() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let quarter = Quat::from_rotation_y(FRAC_PI_2);
    let arm = Transform::from_xyz(1.0, 0.0, 0.0).with_rotation(quarter);
    let arm = world.spawn((Name::new("Arm"), arm, ChildOf(root))).id();
    let hand = Transform::from_xyz(0.0, 0.5, 2.0);
    let hand = world.spawn((Name::new("Hand"), hand, ChildOf(arm))).id();
    let file = json_of(world, [hand, root, hand]);
    assert_eq!(nodes(&file, "Hand").len(), 1);
    // Its position is relative to the arm, not to the world.
    assert_eq!(
        nodes(&file, "Hand")[0]["translation"],
        json!([0.0, 0.5, 2.0])
    );
    let tops = &file["scenes"][0]["nodes"];
    assert_eq!(tops.as_array().map(Vec::len), Some(1), "{file}");
    // Exported alone, it has its world position.
    let file = json_of(world, [hand]);
    close(
        &nodes(&file, "Hand")[0]["translation"],
        &json!([3.0, 0.5, 0.0]),
        "hand",
    );
}

#[test]
fn what_stands_beside_an_element_is_the_same_after_a_file() {
    let travel = SpringTravel::new(f32::NEG_INFINITY, 0.2, 1e4);
    let (first, _, mut stage) = round_trip("beside_out", |world| {
        let root = root(world);
        let hook = (Transform::from_xyz(0.0, 2.0, 0.0), ChildOf(root));
        let a = world.spawn((Name::new("Hook"), hook)).id();
        let weight = (RigidBody::Dynamic, AdditionalMassProperties::Mass(1.0));
        let weight = (weight, Transform::default(), ChildOf(root));
        let b = world.spawn((Name::new("Weight"), weight)).id();
        let slide = (Damper::new(a, b), SpringAxis::World(Vec3::Y), travel);
        world.spawn((slide, ChildOf(root)));
        world.spawn((Spring::new(a, b), Disabled, ChildOf(root)));
        root
    });
    let mut travels = stage.app.world_mut().query::<(&Damper, &SpringTravel)>();
    let (_, found) = travels.single(stage.app.world()).expect("the slide");
    assert_eq!(*found, travel);
    let world = stage.app.world_mut();
    let mut springs = world.query_filtered::<Has<Disabled>, With<Spring>>();
    assert_eq!(springs.iter(world).collect::<Vec<_>>(), [true]);
    let disabled: Vec<_> = first["nodes"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|node| node["extensions"]["BEVY_coilover"]["disabled"].as_bool())
        .collect();
    assert_eq!(disabled, [true]);
}

#[test]
fn points_of_the_world_are_points_of_the_ends_in_a_file() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let hook = world.spawn((Transform::from_xyz(0.0, 2.0, 0.0), ChildOf(root)));
    let hook = hook.id();
    let turned = Quat::from_rotation_z(FRAC_PI_2);
    let beam = Transform::from_xyz(1.0, 0.0, 0.0).with_rotation(turned);
    let beam = world.spawn((RigidBody::Dynamic, beam, ChildOf(root))).id();
    let points = WorldAnchors::new(Vec3::Y * 1.5, Vec3::new(1.0, 0.25, 0.0));
    let rope = (Name::new("Rope"), Spring::new(hook, beam), points);
    world.spawn((rope, ChildOf(root)));
    let file = json_of(world, [root]);
    let anchors = &nodes(&file, "Rope")[0]["extensions"]["BEVY_coilover"]["anchors"];
    let wanted = json!({ "a": [0.0, -0.5, 0.0], "b": [0.25, 0.0, 0.0] });
    close(anchors, &wanted, "anchors");
}

#[test]
fn a_bounce_given_alone_keeps_the_friction_of_rapier() {
    let (_, _, mut stage) = round_trip("bounce_out", |world| {
        let root = root(world);
        let ball = (
            RigidBody::Dynamic,
            Collider::ball(0.5),
            Transform::default(),
        );
        let bounce = Restitution::coefficient(0.75);
        world.spawn((Name::new("Ball"), ball, bounce, ChildOf(root)));
        root
    });
    let ball = named(&mut stage.app, "Ball");
    assert_eq!(stage.get::<Restitution>(ball).coefficient, 0.75);
    assert_eq!(*stage.get::<Friction>(ball), Friction::default());
}

#[test]
fn a_collider_with_a_scale_of_its_own_is_as_large_after_a_file() {
    for (name, scale) in [
        ("absolute", ColliderScale::Absolute(Vec3::splat(3.0))),
        ("relative", ColliderScale::Relative(Vec3::splat(1.5))),
    ] {
        let (_, _, mut stage) = round_trip(&format!("{name}_out"), |world| {
            let root = root(world);
            let place = Transform::from_scale(Vec3::splat(2.0));
            let ball = (RigidBody::Dynamic, Collider::ball(0.5), place, scale);
            world.spawn((Name::new("Ball"), ball, ChildOf(root)));
            root
        });
        run(&mut stage.app, 2.0 * DT);
        let mut colliders = stage.app.world_mut().query::<&Collider>();
        let collider = colliders.single(stage.app.world()).expect("one");
        let size = collider.raw.compute_local_aabb().extents();
        assert!((size - 3.0).abs().max_element() < 1e-3, "{name}: {size}");
        let ball = named(&mut stage.app, "Ball");
        let mass = crate::gltf_physics::mass(&stage, ball).mass;
        let wanted = 4.0 / 3.0 * PI * 1.5_f32.powi(3);
        assert!((mass / wanted - 1.0).abs() < 1e-3, "{name}: {mass} kg");
    }
}

#[test]
fn a_joint_on_an_uneven_or_mirrored_body_has_the_same_frames_after_a_file() {
    let turned = |x: f32, z: f32| Quat::from_rotation_z(z) * Quat::from_rotation_x(x);
    let frames = [
        (Vec3::new(0.1, -0.2, 0.3), turned(0.4, 1.1)),
        (Vec3::new(0.3, 0.7, -0.4), turned(-0.7, 0.5)),
    ];
    for (name, scale) in [
        ("uneven", Vec3::new(1.0, 3.0, 0.5)),
        ("mirrored", Vec3::new(-2.0, 1.0, 1.0)),
    ] {
        let (_, _, mut stage) = round_trip(&format!("{name}_joint_out"), |world| {
            let root = root(world);
            let wall = (RigidBody::Fixed, Collider::ball(0.1), Transform::default());
            let wall = world.spawn((wall, ChildOf(root))).id();
            let own = AdditionalMassProperties::MassProperties(MassProperties {
                mass: 1.0,
                principal_inertia: Vec3::splat(0.1),
                ..default()
            });
            let place = Transform::from_xyz(0.0, 2.0, 0.0)
                .with_rotation(turned(0.9, -0.3))
                .with_scale(scale);
            let body = world.spawn((RigidBody::Dynamic, own, place, ChildOf(root)));
            let body = body.id();
            let hinge = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
                .local_anchor1(frames[0].0)
                .local_basis1(frames[0].1)
                .local_anchor2(frames[1].0)
                .local_basis2(frames[1].1)
                .build();
            let hinge = ImpulseJoint::new(wall, TypedJoint::GenericJoint(hinge));
            world.spawn((hinge, ChildOf(body)));
            root
        });
        let mut joints = stage.app.world_mut().query::<&ImpulseJoint>();
        let joint = joints.single(stage.app.world()).expect("one joint");
        let raw = &joint.data.as_ref().raw;
        for (found, (at, basis)) in [raw.local_frame1, raw.local_frame2].iter().zip(frames) {
            assert!(found.translation.distance(at) < 1e-5, "{name}: {found:?}");
            assert!(
                found.rotation.angle_between(basis) < 2e-3,
                "{name}: {found:?}"
            );
        }
    }
}
