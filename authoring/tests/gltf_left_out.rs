//! Tests that the export reports everything that a glTF file cannot hold.

use crate::gltf_export::root;
use crate::harness::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use serde_json::Value;

#[test]
fn what_the_format_has_not_is_said() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let a = world.spawn((Transform::default(), ChildOf(root))).id();
    let outside = world.spawn(Transform::default()).id();
    world.spawn((
        Spring::new(a, outside),
        CustomSpringLaw::new(|x: f64| x),
        ChildOf(root),
    ));
    world.spawn((
        Transform::default(),
        Collider::round_cuboid(1.0, 1.0, 1.0, 0.1),
        ChildOf(root),
    ));
    world.spawn((
        Name::new("Lift"),
        RigidBody::KinematicPositionBased,
        Damping::default(),
        Dominance::group(1),
        RigidBodyDisabled,
        ChildOf(root),
    ));
    world.spawn((
        Name::new("Wall"),
        Collider::ball(1.0),
        ColliderDisabled,
        SolverGroups::default(),
        ContactSkin(0.1),
        Disabled,
        ChildOf(root),
    ));
    world.spawn((
        Name::new("Clock"),
        TorsionSpring::new(a, root, Vec3::Y),
        TorsionCoil::default(),
        ChildOf(root),
    ));
    world.spawn((
        Name::new("Lost"),
        Spring::new(a, Entity::PLACEHOLDER),
        WorldAnchors::default(),
        ChildOf(root),
    ));
    let links = [0.0, 1.0].map(|x| {
        let link = (RigidBody::Dynamic, Transform::from_xyz(x, 0.0, 0.0));
        world.spawn((Name::new("Link"), link, ChildOf(root))).id()
    });
    let hinge = TypedJoint::RevoluteJoint(RevoluteJoint::new(Vec3::Y));
    let hinge = MultibodyJoint::new(links[0], hinge);
    world.entity_mut(links[1]).insert(hinge);
    let exported = export_gltf(world, [root]);
    let told = exported.left_out.join("\n");
    for part in [
        "body_b is not among",
        "is a function",
        "a shape that glTF has not",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    for (name, what) in [
        ("Lift", "RigidBody::KinematicPositionBased comes back"),
        ("Lift", "Damping is not written"),
        ("Lift", "Dominance is not written"),
        ("Lift", "RigidBodyDisabled is not written"),
        ("Wall", "ColliderDisabled is not written"),
        ("Wall", "SolverGroups is not written"),
        ("Wall", "ContactSkin is not written"),
        ("Wall", "Disabled is written of elements only"),
        ("Clock", "TorsionCoil is not written"),
        ("Lost", "WorldAnchors are not written"),
        ("Link", "MultibodyJoint comes back as an ImpulseJoint"),
    ] {
        let lines: Vec<_> = exported
            .left_out
            .iter()
            .filter(|line| line.starts_with(name) && line.contains(what))
            .collect();
        assert_eq!(lines.len(), 1, "{what}, of {name}, in {told}");
    }
    // The hinge is written nevertheless.
    let file: Value = serde_json::from_str(&exported.text).expect("JSON");
    let joints = &file["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"];
    assert_eq!(joints.as_array().map(Vec::len), Some(1));
}
