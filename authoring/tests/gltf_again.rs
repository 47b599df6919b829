//! Tests that bodies and joints of Rapier are the same after a file, where the drafts of Khronos have no words for them.

use crate::gltf_export::{root, round_trip, round_trip_losing};
use crate::gltf_physics::mass;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::Value;

#[test]
fn a_locked_body_is_as_heavy_after_a_file_when_it_is_unlocked() {
    let own = MassProperties {
        mass: 7.5,
        principal_inertia: Vec3::new(0.3, 0.2, 0.7),
        principal_inertia_local_frame: Quat::from_rotation_x(0.5),
        ..default()
    };
    for (name, locked) in [
        ("translation", LockedAxes::TRANSLATION_LOCKED),
        ("rotation", LockedAxes::ROTATION_LOCKED),
        ("both", LockedAxes::all()),
    ] {
        let (first, _, mut stage) = round_trip(&format!("locked_{name}"), |world| {
            let root = root(world);
            let body = (RigidBody::Dynamic, Transform::default(), locked);
            let given = AdditionalMassProperties::MassProperties(own);
            world.spawn((Name::new("Body"), body, given, ChildOf(root)));
            root
        });
        let body = named(&mut stage.app, "Body");
        assert_eq!(*stage.get::<LockedAxes>(body), locked, "{name}");
        let found = mass(&stage, body);
        assert_eq!(found.mass, own.mass, "{name}");
        assert_eq!(found.principal_inertia, own.principal_inertia, "{name}");
        let frame = found.principal_inertia_local_frame;
        let turned = frame.angle_between(own.principal_inertia_local_frame);
        assert!(turned < 2e-3, "{name}: {turned} rad");
        // For other programs, what is locked is infinite, which is zero in the draft.
        let nodes = first["nodes"].as_array().into_iter().flatten();
        let mut motions =
            nodes.map(|node| &node["extensions"]["KHR_physics_rigid_bodies"]["motion"]);
        let motion = motions.find(|motion| !motion.is_null());
        let written = motion.expect("a motion")["mass"].as_f64();
        assert_eq!(written == Some(0.0), name != "rotation", "{name}");
    }
}

#[test]
fn a_spring_joint_of_rapier_is_a_spring_along_the_distance_after_a_file() {
    let lost = ["a motor of its joint comes back as an element"];
    let (_, _, mut stage) = round_trip_losing("spring_joint", &lost, |world| {
        let root = root(world);
        let [hook, weight] = [2.0, 0.0].map(|y| {
            let kind = if y > 1.0 {
                RigidBody::Fixed
            } else {
                RigidBody::Dynamic
            };
            let mass = ColliderMassProperties::Mass(2.0);
            // Without gravity, it stays where the spring has no force.
            let body = (kind, Collider::ball(0.1), mass, GravityScale(0.0));
            let place = Transform::from_xyz(0.0, y, 0.0);
            world.spawn((body, place, ChildOf(root))).id()
        });
        let spring = SpringJointBuilder::new(1.75, 80.0, 3.0).local_anchor2(Vec3::Y * 0.25);
        world.spawn((ImpulseJoint::new(hook, spring), ChildOf(weight)));
        root
    });
    assert_eq!(stage.count::<ImpulseJoint>(), 0);
    assert_eq!(stage.count::<SpringAxis>(), 0);
    let mut springs = stage.app.world_mut().query::<&SpringDamper>();
    let spring = springs.single(stage.app.world()).expect("one");
    assert_eq!((spring.stiffness, spring.damping), (80.0, 3.0));
    assert_eq!(spring.rest_length, Some(1.75));
    let ends = [spring.body_a, spring.body_b];
    let [a, b] = ends.map(|end| stage.place(end).translation);
    assert!(a.distance(Vec3::Y * 2.0) < 1e-4, "{a}");
    assert!(b.distance(Vec3::Y * 0.25) < 1e-4, "{b}");
}

#[test]
fn colliders_with_one_shape_share_its_mesh_in_a_file() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let hull = Collider::convex_hull(&corners).expect("a hull");
    let faces = vec![[0, 1, 2], [0, 2, 3]];
    let ground = Collider::trimesh(corners.to_vec(), faces).expect("a mesh");
    for i in 0..100 {
        let place = Transform::from_xyz(2.0 * i as f32, 0.0, 0.0);
        let crates = (RigidBody::Dynamic, hull.clone(), place);
        world.spawn((crates, ChildOf(root)));
        world.spawn((ground.clone(), place, ChildOf(root)));
    }
    // Equal, and not the same.
    let another = Collider::convex_hull(&corners).expect("a hull");
    world.spawn((another, Transform::default(), ChildOf(root)));
    app.update();
    let exported = export_gltf(app.world(), [root]);
    assert_eq!(exported.left_out, Vec::<String>::new());
    let file: Value = serde_json::from_str(&exported.text).expect("JSON");
    assert_eq!(file["meshes"].as_array().map(Vec::len), Some(3));
    // The root, the colliders, and a node for each mesh.
    assert_eq!(file["nodes"].as_array().map(Vec::len), Some(1 + 201 + 3));
}
