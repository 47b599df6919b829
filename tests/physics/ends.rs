//! What can hold an end of an element?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const K: f32 = 200.0;
const C: f32 = 20.0;

/// Sag of a weight of 2 kg below an end at the origin, after it has come to rest, m.
fn sag(lab: &mut Lab, end: Entity) -> f32 {
    let weight = lab.body(2.0, Vec3::NEG_Y);
    lab.spawn(
        SpringDamper::new(end, weight)
            .with_stiffness(K)
            .with_damping(C)
            .with_rest_length(1.0),
    );
    lab.run(10.0);
    -1.0 - lab.position(weight).y
}

const SAG: f32 = 2.0 * 9.81 / K;

#[test]
fn fixed_and_kinematic_bodies_and_plain_entities_hold_alike() {
    for kind in 0..4 {
        let mut lab = Lab::new();
        let end = match kind {
            0 => lab.spawn((RigidBody::Fixed, Transform::default())),
            1 => lab.spawn((RigidBody::KinematicPositionBased, Transform::default())),
            2 => lab.spawn((RigidBody::KinematicVelocityBased, Transform::default())),
            _ => lab.point(Vec3::ZERO),
        };
        let sag = sag(&mut lab, end);
        assert!(
            (sag - SAG).abs() < 5e-5 * SAG.max(0.1),
            "kind {kind}: {sag} against {SAG}"
        );
    }
}

/// An end that moves at a constant speed. The damper force is c times the relative speed.
#[test]
fn a_moving_end_drags_through_the_damper_whatever_it_is() {
    for kind in 0..3 {
        let mut lab = Lab::weightless();
        let end = match kind {
            0 => lab.spawn((RigidBody::KinematicPositionBased, Transform::default())),
            1 => lab.spawn((
                RigidBody::KinematicVelocityBased,
                Transform::default(),
                Velocity::linear(Vec3::NEG_X * 0.6),
            )),
            _ => lab.point(Vec3::ZERO),
        };
        let body = lab.body(2.0, Vec3::X);
        let element = lab.spawn(Damper::new(end, body).with_damping(4.0));
        lab.tick();
        let start = lab.velocity(body).x;
        for i in 1..=60 {
            if kind != 1 {
                lab.get_mut::<Transform>(end).translation.x = -0.6 * DT * i as f32;
            }
            lab.tick();
        }
        // m v' = c (v_end − v): the speed of the body approaches that of the end exponentially.
        let t = if kind == 1 { 61.0 } else { 60.0 } * DT;
        let wanted = -0.6 * (1.0 - (-4.0 / 2.0 * t).exp());
        let v = lab.velocity(body).x;
        assert!(
            (v - wanted).abs() < 2e-4,
            "kind {kind} from {start}: {v} against {wanted}"
        );
        let readout = lab.readout(element);
        assert!((readout.rate - (v + 0.6)).abs() < 1e-4, "{readout:?}");
        assert!((readout.damper_force - 4.0 * readout.rate).abs() < 1e-4);
        assert!((readout.dissipated_power - 4.0 * readout.rate * readout.rate).abs() < 1e-4);
    }
}

/// An end below a body in the hierarchy moves with that body and loads it, torque included.
#[test]
fn a_child_of_a_body_is_the_same_as_an_anchor_on_it() {
    // f32 holds these sums exactly, so both ends are at exactly the same point.
    let arm = Vec3::new(0.375, 0.125, -0.25);
    let run = |child: bool| {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let body = lab.spawn(brick(1.0, Vec3::new(0.1, 0.2, 0.3), Vec3::X));
        let spring = |end| {
            Spring::new(hook, end)
                .with_stiffness(50.0)
                .with_rest_length(0.8)
        };
        if child {
            let lug = lab.spawn((Transform::from_translation(Vec3::X * 0.125), ChildOf(body)));
            let eye = lab.spawn((
                Transform::from_translation(arm - Vec3::X * 0.125),
                ChildOf(lug),
            ));
            lab.spawn(spring(eye));
        } else {
            lab.spawn((spring(body), Anchors::new(Vec3::ZERO, arm)));
        }
        lab.run(2.0);
        (*lab.get::<Transform>(body), *lab.get::<Velocity>(body))
    };
    let ((a, va), (b, vb)) = (run(true), run(false));
    let apart = a.translation.distance(b.translation);
    assert!(apart < 1e-5, "{apart}");
    assert!(a.rotation.angle_between(b.rotation) < 1e-3);
    assert!(va.angular.distance(vb.angular) < 1e-4 && va.angular.length() > 0.1);
}

/// An anchor is where a child with that translation would be, so scale and parents count.
#[test]
fn scaled_and_nested_parents_place_the_anchor() {
    let mut lab = Lab::weightless();
    let root = lab.spawn(
        Transform::from_xyz(1.0, 2.0, 3.0)
            .with_rotation(Quat::from_rotation_y(0.7))
            .with_scale(Vec3::splat(2.0)),
    );
    let end = lab.spawn((
        Transform::from_xyz(0.5, 0.0, 0.0).with_rotation(Quat::from_rotation_z(0.4)),
        ChildOf(root),
    ));
    let parent = lab.spawn(Transform::from_xyz(0.0, -1.0, 0.0).with_scale(Vec3::splat(3.0)));
    let body = lab.spawn((
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(1.0),
        Transform::from_xyz(0.5, 0.0, 0.0).with_scale(Vec3::new(1.0, 2.0, 0.5)),
        ChildOf(parent),
    ));
    let element = lab.spawn((
        Spring::new(end, body).with_stiffness(0.0),
        Anchors::new(Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.2, 0.1, -0.4)),
    ));
    lab.tick();
    let place =
        |lab: &Lab, e: Entity, anchor: Vec3| lab.get::<GlobalTransform>(e).transform_point(anchor);
    let a = place(&lab, end, Vec3::new(0.1, 0.2, 0.3));
    let b = place(&lab, body, Vec3::new(0.2, 0.1, -0.4));
    assert!((lab.readout(element).length - a.distance(b)).abs() < 1e-5);
    assert_eq!(
        lab.get::<Spring>(element).rest_length,
        Some(lab.readout(element).length)
    );
}

#[test]
fn rest_length_none_is_the_length_at_the_first_step_and_is_written_back() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::new(0.0, 3.0, 4.0));
    let element = lab.spawn(Spring::new(hook, body).with_stiffness(100.0));
    lab.run(1.0);
    assert_eq!(lab.get::<Spring>(element).rest_length, Some(5.0));
    assert!(lab.velocity(body).length() < 1e-6);
}

/// An element acts from the first fixed tick after spawning, whether colliders give the mass or not.
#[test]
fn an_element_acts_from_the_first_tick() {
    for collider in [false, true] {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let body = if collider {
            lab.spawn((
                RigidBody::Dynamic,
                Transform::from_xyz(2.0, 0.0, 0.0),
                Velocity::default(),
                Collider::cuboid(0.5, 0.5, 0.5),
                ColliderMassProperties::Mass(1.0),
            ))
        } else {
            lab.body(1.0, Vec3::X * 2.0)
        };
        lab.spawn(
            Spring::new(hook, body)
                .with_stiffness(36.0)
                .with_rest_length(1.0),
        );
        lab.tick();
        let wanted = 1.0 + (6.0 * f64::from(DT)).cos();
        let x = f64::from(lab.position(body).x);
        assert!(
            (x - wanted).abs() < 1e-6,
            "collider {collider}: {x} against {wanted}"
        );
    }
}

#[test]
fn both_ends_on_one_body_do_nothing_to_it() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    let a = lab.spawn((Transform::from_xyz(0.5, 0.1, 0.0), ChildOf(body)));
    let b = lab.spawn((Transform::from_xyz(-0.4, 0.0, 0.3), ChildOf(body)));
    lab.spawn(
        SpringDamper::new(a, b)
            .with_stiffness(1e4)
            .with_damping(10.0)
            .with_rest_length(0.1),
    );
    lab.run(1.0);
    assert!(lab.position(body).length() < 1e-6 && lab.velocity(body).length() < 1e-6);
}

/// A move of a point while its element is off must not count as a velocity when the element comes back.
#[test]
fn a_point_is_at_rest_when_its_element_comes_back() {
    use bevy::ecs::entity_disabling::Disabled;
    for way in 0..3 {
        let mut lab = Lab::weightless();
        let hook = lab.point(Vec3::ZERO);
        let body = lab.body(1.0, Vec3::X);
        let damper = Damper::new(hook, body).with_damping(1.0);
        let element = lab.spawn(damper);
        lab.run(0.1);
        let mut entity = lab.app.world_mut().entity_mut(element);
        match way {
            0 => drop(entity.insert(Disabled)),
            1 => drop(entity.insert(damper.with_damping(f32::NAN))),
            _ => drop(entity.remove::<Damper>()),
        }
        lab.get_mut::<Transform>(hook).translation.x = -6.0;
        lab.run(0.5);
        let mut entity = lab.app.world_mut().entity_mut(element);
        match way {
            0 => drop(entity.remove::<Disabled>()),
            _ => drop(entity.insert(damper)),
        }
        lab.tick();
        assert_eq!(lab.velocity(body), Vec3::ZERO, "way {way}");
    }
}

#[test]
fn between_two_ends_that_nothing_moves_it_still_measures() {
    let mut lab = Lab::new();
    let a = lab.point(Vec3::ZERO);
    let b = lab.spawn((RigidBody::Fixed, Transform::from_xyz(2.0, 0.0, 0.0)));
    let element = lab.spawn(Spring::new(a, b).with_stiffness(10.0));
    lab.run(0.1);
    assert_eq!(lab.get::<Spring>(element).rest_length, Some(2.0));
    lab.get_mut::<Transform>(a).translation.x = -1.0;
    lab.run(0.1);
    assert_eq!(lab.readout(element).spring_force, 10.0);
}

#[test]
fn two_springs_off_the_centre_of_a_body_that_cannot_turn_hold_it_where_they_are_fixed() {
    let mut lab = Lab::new();
    let mass = 2.0;
    let shelf = lab.spawn((
        brick(mass, Vec3::ONE, Vec3::ZERO),
        LockedAxes::ROTATION_LOCKED,
    ));
    let stiffness = 500.0;
    for side in [Vec3::X, Vec3::NEG_X] {
        let hook = lab.point(side + Vec3::Y);
        lab.spawn((
            SpringDamper::new(hook, shelf)
                .with_stiffness(stiffness)
                .with_damping(30.0)
                .with_rest_length(1.0),
            Anchors::new(Vec3::ZERO, side),
        ));
    }
    lab.run(4.0);
    let sag = mass * 9.81 / (2.0 * stiffness);
    let low = -lab.position(shelf).y;
    assert!((low - sag).abs() < 1e-4, "{low} m instead of {sag}");
}

#[test]
fn what_holds_an_end_may_become_another_kind_of_thing_at_any_time() {
    type Change = fn(&mut EntityWorldMut);
    let cases: [(&str, Change, Change); 4] = [
        (
            "a wall that is let go",
            |wall| {
                wall.insert(RigidBody::Fixed);
            },
            |wall| {
                wall.insert(RigidBody::Dynamic);
            },
        ),
        (
            "a disabled body that is enabled",
            |body| {
                body.insert((RigidBody::Dynamic, RigidBodyDisabled));
            },
            |body| {
                body.remove::<RigidBodyDisabled>();
            },
        ),
        (
            "a point that becomes a body",
            |_| {},
            |point| {
                point.insert(RigidBody::Dynamic);
            },
        ),
        (
            "a thing that moves by itself and then falls",
            |thing| {
                thing.insert(RigidBody::KinematicPositionBased);
            },
            |thing| {
                thing.insert(RigidBody::Dynamic);
            },
        ),
    ];
    for (name, before, after) in cases {
        let mut lab = Lab::new();
        let top = lab.spawn((Transform::default(), AdditionalMassProperties::Mass(1.0)));
        before(&mut lab.app.world_mut().entity_mut(top));
        let low = lab.body(2.0, Vec3::NEG_Y);
        lab.spawn(
            SpringDamper::new(top, low)
                .with_stiffness(K)
                .with_damping(C),
        );
        lab.run(3.0);
        let hung = lab.position(low).y;
        let sag = -1.0 - 2.0 * 9.81 / K;
        assert!((hung - sag).abs() < 1e-3, "{name}: {hung}, not {sag}");
        after(&mut lab.app.world_mut().entity_mut(top));
        lab.run(1.0);
        // Both fall together, and the spring has pulled them to its rest length.
        let apart = lab.position(top).y - lab.position(low).y;
        let fallen = lab.position(top).y;
        assert!(fallen < -3.0, "{name}: at {fallen} after a second");
        assert!((apart - 1.0).abs() < 0.02, "{name}: {apart} m apart");
    }
}

#[test]
fn parents_in_a_circle_are_told_and_hang_nothing() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::X);
    let (first, second) = (lab.point(Vec3::ZERO), lab.point(Vec3::ZERO));
    let world = lab.app.world_mut();
    world.entity_mut(first).insert(ChildOf(second));
    world.entity_mut(second).insert(ChildOf(first));
    let by_points = WorldAnchors::new(Vec3::ZERO, Vec3::X);
    let elements = [
        lab.spawn(Spring::new(first, body)),
        lab.spawn((Spring::new(first, body), by_points)),
    ];
    lab.run(0.1);
    for element in elements {
        let fault = lab.get::<SpringFault>(element);
        assert_eq!(fault.field, "Spring::body_a");
        assert!(fault.reason.contains("circle"), "{fault}");
    }
}
