//! Spring ends and colliders on child entities of a body that stands on the ground.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const LOAD: f32 = 8.0;
const LAW: [f32; 2] = [800.0, 40.0];
/// Anchors of the strut: on the sledge, and on the load.
const ENDS: [Vec3; 2] = [Vec3::new(0.125, 0.25, 0.0), Vec3::new(0.125, -0.25, 0.0)];
const RUNNERS: [Vec3; 2] = [Vec3::new(0.0, 0.0, 0.5), Vec3::new(0.0, 0.0, -0.5)];

#[derive(Clone, Copy)]
struct Way {
    ends: bool,
    colliders: bool,
    ground: bool,
    turned: bool,
}

/// An entity at a point of a body, the child of an intermediate entity. With `turned`, their two rotations cancel.
fn nested(scene: &mut Stand, body: Entity, at: Vec3, turned: bool) -> Entity {
    let turn = if turned {
        Quat::from_rotation_y(0.7)
    } else {
        Quat::IDENTITY
    };
    let first = Transform::from_translation(Vec3::Y * 0.125).with_rotation(turn);
    let outer = scene.lab.spawn((first, ChildOf(body)));
    let second = Transform::from_translation(turn.inverse() * (at - Vec3::Y * 0.125))
        .with_rotation(turn.inverse());
    scene.lab.spawn((second, ChildOf(outer)))
}

/// A load on a strut over a sledge with two runners. Returns the strut's sag at rest over that of statics, the greatest
/// energy over the first, and the number of bodies awake.
fn sledge(way: Way) -> (f64, f64, usize) {
    let mut scene = Stand::new(CoiloverPlugin::default(), Engine::default());
    if way.ground {
        let land = scene
            .lab
            .spawn((RigidBody::Fixed, Transform::from_xyz(3.0, -2.0, 0.0)));
        let field = nested(&mut scene, land, Vec3::new(-3.0, 2.0, 0.0), way.turned);
        let shape = Collider::halfspace(Vec3::Y).expect("up");
        let world = scene.lab.app.world_mut();
        world.entity_mut(field).insert((shape, Friction::new(0.8)));
    } else {
        scene.ground();
    }
    let sledge = scene.body(Transform::from_xyz(0.0, 0.125, 0.0), ());
    let runner = || {
        (
            Collider::cuboid(0.5, 0.125, 0.0625),
            ColliderMassProperties::Mass(5.0),
        )
    };
    if way.colliders {
        for at in RUNNERS {
            let child = nested(&mut scene, sledge, at, way.turned);
            scene.lab.app.world_mut().entity_mut(child).insert(runner());
        }
    } else {
        let (shape, _) = runner();
        let shapes = RUNNERS.map(|at| (at, Quat::IDENTITY, shape.clone()));
        scene.lab.app.world_mut().entity_mut(sledge).insert((
            Collider::compound(shapes.to_vec()),
            ColliderMassProperties::Mass(10.0),
        ));
    }
    let guide = GenericJointBuilder::new(
        JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_AXES,
    );
    let load = scene.body(
        Transform::from_xyz(0.0, 1.125, 0.0),
        (
            brick_mass(LOAD),
            ImpulseJoint::new(sledge, TypedJoint::GenericJoint(guide.build())),
        ),
    );
    let rest = scene.distance([sledge, load], ENDS);
    if way.ends {
        let ends = [(sledge, ENDS[0]), (load, ENDS[1])]
            .map(|(body, at)| nested(&mut scene, body, at, way.turned));
        scene.lab.spawn(
            SpringDamper::new(ends[0], ends[1])
                .with_stiffness(LAW[0])
                .with_damping(LAW[1])
                .with_rest_length(rest),
        );
        scene.coils.push(SceneSpring {
            ends: [sledge, load],
            anchors: ENDS,
            stiffness: LAW[0],
            rest_length: rest,
        });
    } else {
        scene.coil([sledge, load], ENDS, LAW, Some(rest));
    }
    let sag = f64::from(LOAD) * GRAVITY / f64::from(LAW[0]);
    let floor = GRAVITY * (10.0 * 0.125 + f64::from(LOAD) * (1.125 - sag))
        + 0.5 * f64::from(LAW[0]) * sag * sag;
    scene.lab.tick();
    let first = scene.energy() - floor;
    let most = (scene.most(15.0) - floor) / first;
    let now = f64::from(rest) - scene.length(&scene.coils[0]);
    (now / sag, most, scene.awake())
}

fn brick_mass(mass: f32) -> AdditionalMassProperties {
    AdditionalMassProperties::MassProperties(MassProperties {
        mass,
        principal_inertia: Vec3::splat(0.1 * mass),
        ..default()
    })
}

#[test]
fn what_is_below_a_body_stands_as_what_is_on_it() {
    let plain = Way {
        ends: false,
        colliders: false,
        ground: false,
        turned: false,
    };
    let (wanted, most, awake) = sledge(plain);
    println!("all on the bodies: sag × {wanted:.5}, E × {most:.4}, {awake} awake");
    assert!((wanted - 1.0).abs() < 0.01 && most < 1.02 && awake == 0);
    let mut wrong = Vec::new();
    for i in 1..8 {
        for turned in [false, true] {
            let way = Way {
                ends: i & 1 != 0,
                colliders: i & 2 != 0,
                ground: i & 4 != 0,
                turned,
            };
            let (sag, most, awake) = sledge(way);
            let name = format!(
                "below: ends {}, colliders {}, ground {}, turned {turned}",
                way.ends, way.colliders, way.ground
            );
            println!("{name}: sag × {sag:.5}, E × {most:.4}, {awake} awake");
            if (sag - wanted).abs() > 1e-3 || most > 1.02 {
                wrong.push(name);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
