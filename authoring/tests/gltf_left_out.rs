//! Tests that the export reports everything that a glTF file cannot hold.

use crate::gltf_export::root;
use crate::harness::*;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{JointEnabled, MotorModel, SpringCoefficients};
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

/// Asserts that the export says each of these of the entity with that name, once.
pub fn assert_told(left_out: &[String], wanted: &[(&str, &str)]) {
    for (name, what) in wanted {
        let lines = left_out.iter();
        let lines = lines.filter(|line| line.starts_with(name) && line.contains(what));
        assert_eq!(lines.count(), 1, "{what}, of {name}, in {left_out:#?}");
    }
}

#[test]
fn what_only_rapier_has_is_said() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let bullet = world.spawn((
        Name::new("Bullet"),
        RigidBody::Dynamic,
        (Ccd::enabled(), SoftCcd { prediction: 1.0 }),
        (Sleeping::disabled(), AdditionalSolverIterations(2)),
        TransformInterpolation::default(),
        KinematicCharacterController::default(),
        ExternalForce {
            force: Vec3::X,
            ..default()
        },
        ExternalImpulse {
            impulse: Vec3::X,
            ..default()
        },
        ChildOf(root),
    ));
    let bullet = bullet.id();
    world.spawn((
        Name::new("Bell"),
        Collider::ball(1.0),
        (
            ActiveHooks::FILTER_CONTACT_PAIRS,
            ActiveCollisionTypes::all(),
        ),
        ActiveEvents::CONTACT_FORCE_EVENTS,
        ContactForceEventThreshold(1.0),
        ChildOf(root),
    ));
    // What a trigger comes back with, and a force of nothing.
    world.spawn((
        Name::new("Gate"),
        (Collider::ball(1.0), Sensor),
        (ActiveEvents::COLLISION_EVENTS, ActiveCollisionTypes::all()),
        (ExternalForce::default(), ExternalImpulse::default()),
        ChildOf(root),
    ));
    world.spawn((Name::new("Fin"), RigidBody::Fixed, ChildOf(bullet)));
    let exported = export_gltf(world, [root]);
    assert_told(
        &exported.left_out,
        &[
            ("Bullet", ": Ccd is not written"),
            ("Bullet", ": SoftCcd is not written"),
            ("Bullet", "Sleeping is not written"),
            ("Bullet", "AdditionalSolverIterations is not written"),
            ("Bullet", "TransformInterpolation is not written"),
            ("Bullet", "KinematicCharacterController is not written"),
            ("Bullet", "ExternalForce is not written"),
            ("Bullet", "ExternalImpulse is not written"),
            ("Bell", "ActiveHooks is not written"),
            ("Bell", "ActiveEvents is not written"),
            ("Bell", "ActiveCollisionTypes is not written"),
            ("Bell", "ContactForceEventThreshold is not written"),
            ("Fin", "comes back as a part of that body"),
        ],
    );
    let of_gate = |line: &&String| line.starts_with("Gate");
    assert_eq!(exported.left_out.iter().find(of_gate), None);
}

#[test]
fn what_a_joint_loses_is_said() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let [frame, door] = [0.0, 1.0].map(|x| {
        let body = (RigidBody::Dynamic, Transform::from_xyz(x, 0.0, 0.0));
        world.spawn((body, ChildOf(root))).id()
    });
    let mut spawn = |name: &str, model: MotorModel, enabled: JointEnabled, frequency: f32| {
        let mut joint = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
            .set_motor(JointAxis::AngX, 0.0, 1.0, 0.0, 2.0)
            .motor_model(JointAxis::AngX, model)
            .build();
        joint.raw.enabled = enabled;
        joint.raw.softness.natural_frequency = frequency;
        let joint = ImpulseJoint::new(frame, TypedJoint::GenericJoint(joint));
        world.spawn((Name::new(name.to_owned()), joint, ChildOf(door)));
    };
    let usual = SpringCoefficients::<f32>::joint_defaults().natural_frequency;
    spawn(
        "Brake",
        MotorModel::ForceBased,
        JointEnabled::Enabled,
        usual,
    );
    spawn(
        "Hinge",
        MotorModel::AccelerationBased,
        JointEnabled::Disabled,
        10.0,
    );
    // A motor in acceleration mode without stiffness comes back as a motor.
    spawn(
        "Fan",
        MotorModel::AccelerationBased,
        JointEnabled::Enabled,
        usual,
    );
    let exported = export_gltf(world, [root]);
    assert_told(
        &exported.left_out,
        &[
            ("Brake", "a motor of its joint comes back as an element"),
            ("Hinge", "its joint is not enabled"),
            ("Hinge", "the softness of its joint is not written"),
        ],
    );
    assert_eq!(exported.left_out.len(), 3, "{:#?}", exported.left_out);
}

#[test]
fn an_end_whose_fixed_body_is_another_after_a_file_is_said() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let wheel = (RigidBody::Dynamic, Transform::from_xyz(0.0, 3.0, 0.0));
    let wheel = world.spawn((wheel, ChildOf(root))).id();
    let wall = (RigidBody::Fixed, Transform::default());
    let wall = world.spawn((wall, ChildOf(root))).id();
    for (name, angle) in [("Straight", 0.0), ("Turned", 0.5)] {
        let peg = Transform::from_rotation(Quat::from_rotation_x(angle));
        let peg = world.spawn((peg, ChildOf(wall))).id();
        let damper = TorsionDamper::new(peg, wheel, Vec3::Z);
        world.spawn((Name::new(name), damper, ChildOf(root)));
    }
    let exported = export_gltf(world, [root]);
    assert_told(&exported.left_out, &[("Turned", "turned against it")]);
    assert_eq!(exported.left_out.len(), 1, "{:#?}", exported.left_out);
}

#[test]
fn what_only_some_colliders_joints_and_elements_lose_is_said() {
    let mut app = game();
    let world = app.world_mut();
    let root = root(world);
    let (friction, bounce) = (Friction::coefficient(0.1), Restitution::coefficient(0.1));
    let gate = (Collider::ball(1.0), Sensor, friction, bounce);
    world.spawn((Name::new("Gate"), gate, ChildOf(root)));
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let flags = TriMeshFlags::MERGE_DUPLICATE_VERTICES;
    let ground = Collider::trimesh_with_flags(corners, vec![[0, 1, 2]], flags);
    world.spawn((Name::new("Ground"), ground.expect("a mesh"), ChildOf(root)));
    let a = world.spawn((Transform::default(), ChildOf(root))).id();
    let outside = world
        .spawn((Name::new("Outside"), Transform::default()))
        .id();
    let rope = (Spring::new(a, outside), EndNames::new("A", "Outside"));
    let rope = world.spawn((Name::new("Rope"), rope, ChildOf(root))).id();
    world.spawn((Name::new("Skin"), SpringSkin::default(), ChildOf(rope)));
    let [frame, arm] = [0.0, 1.0].map(|x| {
        let body = (RigidBody::Dynamic, Transform::from_xyz(x, 0.0, 0.0));
        world.spawn((body, ChildOf(root))).id()
    });
    let cone = GenericJointBuilder::new(JointAxesMask::LIN_AXES)
        .coupled_axes(JointAxesMask::ANG_X | JointAxesMask::ANG_Y)
        .limits(JointAxis::AngX, [0.25, 0.5])
        .build();
    let cone = ImpulseJoint::new(frame, TypedJoint::GenericJoint(cone));
    world.spawn((Name::new("Cone"), cone, ChildOf(arm)));
    let exported = export_gltf(world, [root]);
    assert_told(
        &exported.left_out,
        &[
            ("Gate", "Friction of a Sensor is not written"),
            ("Gate", "Restitution of a Sensor is not written"),
            ("Ground", "TriMeshFlags are not written"),
            ("Rope", "its body_b is not among"),
            ("Rope", "EndNames is not written"),
            ("Skin", "SpringSkin is not written"),
            ("Cone", "the min of a limit of its coupled angles"),
        ],
    );
    assert_eq!(exported.left_out.len(), 7, "{:#?}", exported.left_out);
}
