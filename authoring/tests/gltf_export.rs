//! Tests that a scene keeps every number when it is exported to glTF and loaded again.

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::export_gltf;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::MotorModel;
use serde_json::{Value, json};

/// Exports a scene, loads it, and exports the loaded scene. Returns both exported files and the stage.
pub fn round_trip(name: &str, build: impl FnOnce(&mut World) -> Entity) -> (Value, Value, Stage) {
    round_trip_losing(name, &[], build)
}

/// [`round_trip`] of a scene of which the export says that it loses something: the ends of its sentences.
pub fn round_trip_losing(
    name: &str,
    lost: &[&str],
    build: impl FnOnce(&mut World) -> Entity,
) -> (Value, Value, Stage) {
    let folder = Folder::new(name);
    let mut stage = Stage::new(&folder.0);
    let root = build(stage.app.world_mut());
    stage.app.update();
    let first = export_gltf(stage.app.world(), [root]);
    let told = &first.left_out;
    assert_eq!(told.len(), lost.len(), "{told:?}");
    let mut pairs = told.iter().zip(lost);
    assert!(pairs.all(|(line, end)| line.ends_with(end)), "{told:?}");
    folder.write("a.gltf", &first.text);
    stage.app.world_mut().despawn(root);
    let loaded = stage.load("a.gltf");
    let again = stage.node(loaded, "Root");
    let second = export_gltf(stage.app.world(), [again]);
    assert_eq!(second.left_out, Vec::<String>::new());
    let json = |text: &str| serde_json::from_str(text).expect("JSON");
    (json(&first.text), json(&second.text), stage)
}

pub fn root(world: &mut World) -> Entity {
    world
        .spawn((
            Name::new("Root"),
            Transform::default(),
            Visibility::default(),
        ))
        .id()
}

/// Asserts equal values, with numbers equal up to rounding: rotating frames forth and back rounds in single precision.
pub fn close(a: &Value, b: &Value, place: &str) {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (
                a.as_f64().unwrap_or(f64::NAN),
                b.as_f64().unwrap_or(f64::NAN),
            );
            assert!(
                (a - b).abs() <= 3e-6 * a.abs().max(1.0),
                "{place}: {a} became {b}"
            );
        }
        (Value::Array(a), Value::Array(b)) => {
            assert_eq!(a.len(), b.len(), "{place}");
            for (i, (a, b)) in a.iter().zip(b).enumerate() {
                close(a, b, &format!("{place}[{i}]"));
            }
        }
        (Value::Object(a), Value::Object(b)) => {
            let keys =
                |map: &serde_json::Map<String, Value>| map.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(a), keys(b), "{place}");
            for (key, a) in a {
                close(a, &b[key], &format!("{place}.{key}"));
            }
        }
        _ => assert_eq!(a, b, "{place}"),
    }
}

/// Asserts that this component is beside the only element of this kind.
fn assert_beside<E: Component, C: Component + PartialEq + std::fmt::Debug>(
    stage: &mut Stage,
    wanted: &C,
) {
    let mut found = stage.app.world_mut().query_filtered::<&C, With<E>>();
    assert_eq!(found.single(stage.app.world()).ok(), Some(wanted));
}

#[test]
fn every_element_and_companion_goes_out_and_in_again_bit_for_bit() {
    let (first, second, mut stage) = round_trip("elements_out", |world| {
        let root = root(world);
        let end = |world: &mut World, name: &str, at: Vec3| {
            let body = (
                RigidBody::Dynamic,
                AdditionalMassProperties::MassProperties(MassProperties {
                    mass: 0.1,
                    principal_inertia: Vec3::new(0.1, 0.2, 0.3),
                    ..default()
                }),
            );
            world
                .spawn((
                    Name::new(name.to_owned()),
                    Transform::from_translation(at),
                    body,
                    ChildOf(root),
                ))
                .id()
        };
        let a = end(world, "A", Vec3::new(0.1, 1.0 / 3.0, -7.7));
        let b = end(world, "B", Vec3::new(0.3, -0.7, 1e-6));
        let table = || ForceTable::new([(-1.1, -20.3), (0.0, 0.0), (0.7, 3.3)]);
        let third = 1.0 / 3.0;
        let spawn = |world: &mut World, bundle: &mut dyn FnMut(&mut EntityWorldMut)| {
            bundle(&mut world.spawn((Name::new("Element"), ChildOf(root))));
        };
        spawn(world, &mut |e| {
            e.insert((
                Spring::new(a, b).with_stiffness(third),
                SpringLaw::Cubic,
                Anchors::new(Vec3::splat(third), Vec3::X),
                Breakable::at_force(1e30).disabling(),
                SpringAction::Push,
                Preload(-third),
            ));
        });
        spawn(world, &mut |e| {
            e.insert((
                Damper::new(a, b).with_damping(1e-30),
                DampingLaw::Table(table()),
                MaxForce(0.7),
                Telescope::fitted().with_color(Color::linear_rgb(0.25, 0.5, 0.7)),
            ));
        });
        spawn(world, &mut |e| {
            e.insert((
                SpringDamper::new(a, b)
                    .with_rest_length(1.1)
                    .with_damping(3.3e7),
                SpringLaw::sided(
                    Polynomial::new(0.1, 0.2, 0.3),
                    Polynomial::new(0.4, 0.0, 0.6),
                ),
                DampingLaw::BlowOff {
                    damping: 0.1,
                    knee: 0.2,
                    beyond: 0.3,
                },
                SpringAxis::BodyA(Vec3::new(0.1, 0.7, 0.2)),
                SpringTravel::new(0.1, f32::INFINITY, third)
                    .with_progression(0.7)
                    .with_stop_damping(0.9),
                Coil {
                    ends: HelixEnds::Closed,
                    handedness: Handedness::Left,
                    color: Color::linear_rgb(0.25, 0.5, 0.7),
                    ..Coil::new(0.1, 0.011, 7.7)
                },
                ShowSpringGizmos(false),
            ));
        });
        spawn(world, &mut |e| {
            e.insert((
                TorsionSpring::new(a, b, Vec3::splat(third)).with_rest_angle(-7.1),
                SpringLaw::Table(table()),
            ));
        });
        spawn(world, &mut |e| {
            e.insert((
                TorsionDamper::new(a, b, Vec3::Y),
                DampingLaw::sided(0.1, 0.7),
            ));
        });
        spawn(world, &mut |e| {
            e.insert((
                TorsionSpringDamper::new(b, a, Vec3::Z).with_stiffness(0.1),
                HoldPose::of_b().with_share(0.7).with_mass(0.3),
                SpringTuning::frequency(0.7, 0.1),
            ));
        });
        root
    });
    let elements = |file: &Value| -> Vec<Value> {
        let nodes = file["nodes"].as_array().cloned().unwrap_or_default();
        nodes
            .into_iter()
            .map(|node| node["extensions"]["BEVY_coilover"].clone())
            .filter(|e| !e.is_null())
            .collect()
    };
    assert_eq!(elements(&first).len(), 6);
    for (a, b) in elements(&first).iter().zip(elements(&second)) {
        assert_eq!(*a, b);
    }
    close(&first["nodes"], &second["nodes"], "nodes");
    // Both files would lack the same if the export did.
    let (stage, third) = (&mut stage, 1.0_f32 / 3.0);
    let table = ForceTable::new([(-1.1, -20.3), (0.0, 0.0), (0.7, 3.3)]);
    assert_beside::<Spring, _>(stage, &SpringLaw::Cubic);
    assert_beside::<Spring, _>(stage, &Anchors::new(Vec3::splat(third), Vec3::X));
    assert_beside::<Spring, _>(stage, &Breakable::at_force(1e30).disabling());
    assert_beside::<Spring, _>(stage, &SpringAction::Push);
    assert_beside::<Spring, _>(stage, &Preload(-third));
    assert_beside::<Damper, _>(stage, &DampingLaw::Table(table.clone()));
    assert_beside::<Damper, _>(stage, &MaxForce(0.7));
    let telescope = Telescope::fitted().with_color(Color::linear_rgb(0.25, 0.5, 0.7));
    assert_beside::<Damper, _>(stage, &telescope);
    let (pull, push) = (
        Polynomial::new(0.1, 0.2, 0.3),
        Polynomial::new(0.4, 0.0, 0.6),
    );
    assert_beside::<SpringDamper, _>(stage, &SpringLaw::sided(pull, push));
    let blow_off = DampingLaw::BlowOff {
        damping: 0.1,
        knee: 0.2,
        beyond: 0.3,
    };
    assert_beside::<SpringDamper, _>(stage, &blow_off);
    let axis = SpringAxis::BodyA(Vec3::new(0.1, 0.7, 0.2));
    assert_beside::<SpringDamper, _>(stage, &axis);
    let travel = SpringTravel::new(0.1, f32::INFINITY, third);
    let travel = travel.with_progression(0.7).with_stop_damping(0.9);
    assert_beside::<SpringDamper, _>(stage, &travel);
    let coil = Coil::new(0.1, 0.011, 7.7).with_ends(HelixEnds::Closed);
    let coil = coil.with_handedness(Handedness::Left);
    let coil = coil.with_color(Color::linear_rgb(0.25, 0.5, 0.7));
    assert_beside::<SpringDamper, _>(stage, &coil);
    assert_beside::<SpringDamper, _>(stage, &ShowSpringGizmos(false));
    assert_beside::<TorsionSpring, _>(stage, &SpringLaw::Table(table));
    assert_beside::<TorsionDamper, _>(stage, &DampingLaw::sided(0.1, 0.7));
    let mut springs = stage.app.world_mut().query::<&Spring>();
    let spring = springs.single(stage.app.world()).expect("one");
    // Its rest length was found since.
    assert_eq!(spring.stiffness, third);
    let mut pairs = stage.app.world_mut().query::<&SpringDamper>();
    let pair = pairs.single(stage.app.world()).expect("one");
    assert_eq!((pair.damping, pair.rest_length), (3.3e7, Some(1.1)));
    let mut twists = stage.app.world_mut().query::<&TorsionSpring>();
    let twist = twists.single(stage.app.world()).expect("one");
    assert_eq!(
        (twist.axis, twist.rest_angle),
        (Vec3::splat(third), Some(-7.1))
    );
}

#[test]
fn bodies_colliders_and_joints_go_out_and_in_again() {
    let lost = ["a motor of its joint comes back as an element"];
    let (first, second, mut stage) = round_trip_losing("bodies_out", &lost, |world| {
        let root = root(world);
        let turned = Quat::from_rotation_x(0.3) * Quat::from_rotation_z(1.1);
        let body = world
            .spawn((
                Name::new("Body"),
                RigidBody::Dynamic,
                Transform::from_xyz(0.1, 3.0, 0.2).with_rotation(turned),
                AdditionalMassProperties::MassProperties(MassProperties {
                    mass: 2.7,
                    principal_inertia: Vec3::new(0.11, 0.13, 0.17),
                    local_center_of_mass: Vec3::new(0.1, 0.0, -0.3),
                    principal_inertia_local_frame: Quat::from_rotation_y(0.4),
                }),
                Velocity {
                    linear: Vec3::new(0.1, 0.2, 0.3),
                    angular: Vec3::new(-0.3, 0.0, 0.7),
                },
                GravityScale(0.7),
                ChildOf(root),
            ))
            .id();
        for (i, collider) in [
            Collider::ball(0.3),
            Collider::cuboid(0.1, 0.2, 0.3),
            Collider::capsule_y(0.4, 0.1),
            Collider::cylinder(0.3, 0.2),
            Collider::cone(0.3, 0.2),
        ]
        .into_iter()
        .enumerate()
        {
            world.spawn((
                Name::new(format!("C{i}")),
                Transform::from_xyz(i as f32, 0.0, 0.0).with_scale(Vec3::splat(0.5)),
                collider,
                ColliderMassProperties::Density(0.0),
                Friction {
                    coefficient: 0.1 * i as f32,
                    combine_rule: CoefficientCombineRule::Multiply,
                },
                Restitution {
                    coefficient: 0.3,
                    combine_rule: CoefficientCombineRule::Max,
                },
                CollisionGroups::new(Group::GROUP_3, Group::GROUP_1 | Group::GROUP_3),
                ChildOf(body),
            ));
        }
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z * 1.1];
        let ground = Collider::trimesh(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh");
        world.spawn((
            Name::new("Ground"),
            Transform::from_xyz(0.0, -5.0, 0.0),
            ground,
            ChildOf(root),
        ));
        let wall = world
            .spawn((
                Name::new("Wall"),
                RigidBody::Fixed,
                Collider::cuboid(0.1, 0.1, 0.1),
                Transform::from_xyz(0.0, 4.0, 0.0),
                ChildOf(root),
            ))
            .id();
        let hinge = GenericJointBuilder::new(JointAxesMask::LOCKED_REVOLUTE_AXES)
            .local_anchor1(Vec3::new(0.0, -0.5, 0.1))
            .local_anchor2(Vec3::new(0.3, 0.7, 0.0))
            .local_basis1(Quat::from_rotation_z(0.3))
            .limits(JointAxis::AngX, [-0.7, 0.3])
            .set_motor(JointAxis::AngX, 0.1, 0.2, 3.3, 0.7)
            .motor_max_force(JointAxis::AngX, 77.0)
            .motor_model(JointAxis::AngX, MotorModel::ForceBased)
            .build();
        world.spawn((
            ImpulseJoint::new(wall, TypedJoint::GenericJoint(hinge)),
            ChildOf(body),
        ));
        root
    });
    let part = |file: &Value, name: &str| -> Value {
        let nodes = file["nodes"].as_array().cloned().unwrap_or_default();
        nodes
            .into_iter()
            .find(|node| node["name"] == name)
            .unwrap_or(Value::Null)
    };
    let motion = |file: &Value| {
        part(file, "Body")["extensions"]["KHR_physics_rigid_bodies"]["motion"].clone()
    };
    assert_eq!(motion(&first)["mass"], json!(2.7));
    close(&motion(&first), &motion(&second), "motion");
    for name in ["C0", "C1", "C2", "C3", "C4", "Ground"] {
        let geometry = |file: &Value| {
            let collider =
                part(file, name)["extensions"]["KHR_physics_rigid_bodies"]["collider"].clone();
            let at = |list: &str, key: &str| {
                collider[key].as_u64().map(|i| {
                    file["extensions"]["KHR_physics_rigid_bodies"][list][i as usize].clone()
                })
            };
            let shape = collider["geometry"]["shape"].as_u64();
            let shape = shape
                .map(|i| file["extensions"]["KHR_implicit_shapes"]["shapes"][i as usize].clone());
            (shape, at("physicsMaterials", "physicsMaterial"))
        };
        let ((shape, material), (shape_again, material_again)) =
            (geometry(&first), geometry(&second));
        assert_eq!(
            (&shape, &material),
            (&shape_again, &material_again),
            "{name}"
        );
        assert_eq!(shape.is_some(), name != "Ground");
    }
    assert_eq!(first["buffers"][0]["uri"], second["buffers"][0]["uri"]);
    // The motor is loaded as an element, the rest of the joint as a joint.
    assert_eq!(stage.count::<ImpulseJoint>(), 1);
    let mut drives = stage
        .app
        .world_mut()
        .query::<(&TorsionSpringDamper, &MaxForce, &Preload)>();
    let (spring, most, preload) = drives.single(stage.app.world()).expect("the drive");
    assert_eq!((spring.stiffness, spring.damping, most.0), (3.3, 0.7, 77.0));
    assert!((preload.0 + 0.7 * 0.2).abs() < 1e-6);
    let limits = |file: &Value| {
        file["extensions"]["KHR_physics_rigid_bodies"]["physicsJoints"][0]["limits"].clone()
    };
    assert_eq!(limits(&first), limits(&second));
}
