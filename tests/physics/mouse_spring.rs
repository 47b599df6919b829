//! Does a body that a pointer holds follow it as quickly and calmly as it should?

use crate::harness::*;
use crate::messages::Log;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f64::consts::TAU;

const FREQUENCY: f32 = 1.5;

fn grab(lab: &mut Lab, body: Entity, target: Vec3) -> Entity {
    lab.spawn(MouseSpring::new(body, Vec3::ZERO, target).with_frequency(FREQUENCY))
}

fn elements(lab: &mut Lab) -> usize {
    let world = lab.app.world_mut();
    world.query::<&SpringDamper>().iter(world).count()
}

#[test]
fn a_held_body_comes_to_the_pointer_as_critically_damped_motion_does() {
    for mass in [0.01, 2.0, 5e3] {
        let mut lab = Lab::weightless();
        let body = lab.body(mass, Vec3::new(1.0, 0.5, -0.25));
        lab.tick();
        grab(&mut lab, body, Vec3::ZERO);
        let omega = TAU * f64::from(FREQUENCY);
        for tick in 1..=60 {
            lab.tick();
            let t = f64::from(tick) * f64::from(DT);
            let left = ((1.0 + omega * t) * (-omega * t).exp()) as f32;
            let at = lab.position(body);
            let wanted = left * Vec3::new(1.0, 0.5, -0.25);
            assert!(
                at.distance(wanted) < 2e-3,
                "{mass} kg, {t} s: {at}, {wanted}"
            );
        }
    }
}

#[test]
fn under_gravity_it_hangs_below_the_pointer_by_its_weight_over_the_stiffness() {
    let mut lab = Lab::new();
    let body = lab.body(3.0, Vec3::ZERO);
    grab(&mut lab, body, Vec3::Y);
    lab.run(5.0);
    let sag = GRAVITY / (TAU * f64::from(FREQUENCY)).powi(2);
    let at = lab.position(body);
    assert!(
        (f64::from(at.y) - 1.0 + sag).abs() < 1e-3 * sag,
        "{at}, sag {sag}"
    );
}

#[test]
fn a_pointer_that_moves_takes_it_along() {
    let mut lab = Lab::weightless();
    let body = lab.body(3.0, Vec3::ZERO);
    let mouse = grab(&mut lab, body, Vec3::ZERO);
    for tick in 1..=240 {
        let target = Vec3::X * (2.0 * DT * tick as f32);
        lab.get_mut::<MouseSpring>(mouse).target = target;
        lab.tick();
    }
    // At constant speed, pointer and body move alike, so the damper exerts no force and the body does not lag.
    let at = lab.position(body);
    assert!((at.x - 8.0).abs() < 5e-3, "{at}");
    assert_eq!(elements(&mut lab), 3, "none is made anew for a new target");
}

#[test]
fn no_axis_is_pulled_by_more_than_its_greatest_force() {
    let mut lab = Lab::weightless();
    let body = lab.body(1000.0, Vec3::ZERO);
    let target = Vec3::new(100.0, 0.0, 0.0);
    lab.spawn(MouseSpring::new(body, Vec3::ZERO, target).with_max_force(50.0));
    lab.run(2.0);
    let speed = lab.velocity(body).x;
    assert!(
        (speed - 0.1).abs() < 1e-3,
        "50 N on a tonne for 2 s: {speed} m/s"
    );
}

#[test]
fn a_body_held_at_its_edge_swings_below_it_and_gains_nothing() {
    let mut lab = Lab::new();
    let body = lab.spawn(brick(2.0, Vec3::splat(0.05), Vec3::ZERO));
    lab.spawn(MouseSpring::new(body, Vec3::X * 0.4, Vec3::X * 0.4));
    let mut fastest = 0.0_f64;
    for _ in 0..1200 {
        lab.tick();
        fastest = fastest.max(f64::from(lab.velocity(body).length()));
    }
    assert!(fastest < (2.0 * GRAVITY * 1.0).sqrt(), "{fastest} m/s");
}

#[test]
fn who_lets_go_leaves_nothing_behind() {
    for despawns in [true, false] {
        let mut lab = Lab::weightless();
        let body = lab.body(1.0, Vec3::ZERO);
        let mouse = grab(&mut lab, body, Vec3::Y);
        lab.run(0.2);
        assert_eq!(elements(&mut lab), 3);
        let world = lab.app.world_mut();
        if despawns {
            world.despawn(mouse);
        } else {
            world.entity_mut(mouse).remove::<MouseSpring>();
        }
        lab.run(0.1);
        assert_eq!(elements(&mut lab), 0);
        let velocity = lab.velocity(body);
        lab.run(0.5);
        assert_eq!(velocity, lab.velocity(body), "it flies on");
        let force = lab.app.world().get::<ExternalForce>(body);
        assert!(force.is_none_or(|f| f.force == Vec3::ZERO), "{force:?}");
    }
}

#[test]
fn a_copy_pulls_by_springs_of_its_own() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    let mouse = grab(&mut lab, body, Vec3::Y);
    lab.run(0.2);
    let copy = lab.app.world_mut().entity_mut(mouse).clone_and_spawn();
    lab.run(0.1);
    assert_eq!(elements(&mut lab), 6);
    lab.app.world_mut().despawn(copy);
    lab.run(0.1);
    assert_eq!(elements(&mut lab), 3, "the original still pulls");
    lab.run(3.0);
    assert!(lab.position(body).distance(Vec3::Y) < 1e-3);
}

#[test]
fn springs_that_were_copied_with_their_pointer_do_not_pull_beside_those_of_the_copy() {
    let mut lab = Lab::weightless();
    let start = Vec3::new(1.0, 0.5, -0.25);
    let (body, other) = (lab.body(1.0, Vec3::ZERO), lab.body(1.0, start));
    let mouse = grab(&mut lab, body, Vec3::ZERO);
    lab.run(0.2);
    // As a scene is copied: with all that is below the pointer, and with the copy of the body in place of the body.
    let mut pointer = lab.app.world_mut().entity_mut(mouse);
    let copy = pointer.clone_and_spawn_with_opt_out(|all| {
        all.linked_cloning(true);
    });
    lab.get_mut::<MouseSpring>(copy).body = other;
    let springs = lab.get::<Children>(copy).to_vec();
    assert_eq!(springs.len(), 3, "the springs are copied too");
    for spring in springs {
        let mut spring = lab.get_mut::<SpringDamper>(spring);
        assert_eq!(spring.body_a, copy);
        spring.body_b = other;
    }
    let omega = TAU * f64::from(FREQUENCY);
    for tick in 1..=60 {
        lab.tick();
        assert_eq!(elements(&mut lab), 6, "three for each pointer");
        let t = f64::from(tick) * f64::from(DT);
        let left = ((1.0 + omega * t) * (-omega * t).exp()) as f32;
        let at = lab.position(other);
        assert!(at.distance(left * start) < 2e-3, "{t} s: {at}");
    }
    lab.app.world_mut().despawn(copy);
    lab.run(0.1);
    assert_eq!(elements(&mut lab), 3, "the original still pulls");
}

#[test]
fn a_held_body_that_is_despawned_is_let_go_without_a_word() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    grab(&mut lab, body, Vec3::Y);
    lab.run(0.2);
    lab.app.world_mut().despawn(body);
    lab.run(0.2);
    assert_eq!(elements(&mut lab), 0);
    assert_eq!(log.take(), Vec::<String>::new());
}

#[test]
fn numbers_that_mean_nothing_are_told_once_and_mended_by_better_ones() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    let mouse = grab(&mut lab, body, Vec3::Y);
    lab.run(0.1);
    let bad = [
        ("target", MouseSpring::new(body, Vec3::ZERO, Vec3::NAN)),
        ("point", MouseSpring::new(body, Vec3::INFINITY, Vec3::Y)),
        (
            "frequency",
            MouseSpring::new(body, Vec3::ZERO, Vec3::Y).with_frequency(-1.0),
        ),
        (
            "max_force",
            MouseSpring::new(body, Vec3::ZERO, Vec3::Y).with_max_force(f32::NAN),
        ),
        // Rapier's f32 cannot hold the square of such a distance.
        ("target", MouseSpring::new(body, Vec3::ZERO, 1e30 * Vec3::Y)),
        ("point", MouseSpring::new(body, 1e30 * Vec3::X, Vec3::Y)),
    ];
    for (field, spring) in bad {
        *lab.get_mut::<MouseSpring>(mouse) = spring;
        lab.run(0.1);
        let fault = lab.get::<SpringFault>(mouse);
        assert_eq!(fault.field, format!("MouseSpring::{field}"));
        assert_eq!(elements(&mut lab), 0);
        let told = log.take();
        assert_eq!(told.len(), 1, "{told:?}");
    }
    *lab.get_mut::<MouseSpring>(mouse) = MouseSpring::new(body, Vec3::ZERO, Vec3::Y);
    lab.run(3.0);
    assert!(lab.app.world().get::<SpringFault>(mouse).is_none());
    assert!(lab.position(body).distance(Vec3::Y) < 1e-3);
}

#[test]
fn a_box_that_rests_on_the_ground_is_lifted() {
    let mut lab = Lab::new();
    lab.spawn((
        Collider::cuboid(5.0, 0.5, 5.0),
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    let at = Transform::from_xyz(0.0, 0.2, 0.0);
    let body = lab.spawn((RigidBody::Dynamic, Collider::cuboid(0.2, 0.2, 0.2), at));
    lab.run(1.0);
    lab.spawn(MouseSpring::new(body, Vec3::Y * 0.1, Vec3::Y * 1.5).with_frequency(FREQUENCY));
    lab.run(4.0);
    let sag = GRAVITY / (TAU * f64::from(FREQUENCY)).powi(2);
    let held = f64::from(lab.position(body).y) + 0.1;
    assert!((held - 1.5 + sag).abs() < 0.01, "held at {held}");
}

#[test]
fn a_target_that_jumps_is_overshot_by_the_blow_that_its_damper_gets() {
    let mut lab = Lab::weightless();
    let body = lab.body(2.0, Vec3::ZERO);
    let mouse = grab(&mut lab, body, Vec3::ZERO);
    lab.run(0.2);
    lab.get_mut::<MouseSpring>(mouse).target = Vec3::X;
    let mut farthest = 0.0_f32;
    for _ in 0..120 {
        lab.tick();
        farthest = farthest.max(lab.position(body).x);
    }
    // The damper's impulse gives the body a speed of 2 ω. Critically damped motion then overshoots by e⁻² of the
    // way.
    assert!((farthest - 1.0 - 0.135).abs() < 0.01, "{farthest}");
    assert!((lab.position(body).x - 1.0).abs() < 1e-3);
}

#[test]
fn a_pointer_that_was_wrong_and_lets_go_leaves_no_fault() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    let mouse = grab(&mut lab, body, Vec3::NAN);
    lab.tick();
    assert!(lab.app.world().get::<SpringFault>(mouse).is_some());
    lab.app
        .world_mut()
        .entity_mut(mouse)
        .remove::<MouseSpring>();
    lab.tick();
    assert!(lab.app.world().get::<SpringFault>(mouse).is_none());
}

/// Compares each stiffness with the body's effective mass at the point. `turns` is 1 for each world axis about
/// which the body can turn.
fn is_held_for_its_mass(locked: LockedAxes, turns: Vec3) {
    let mut lab = Lab::weightless();
    let (mass, inertia) = (2.0, 0.05);
    let body = lab.spawn(brick(mass, Vec3::splat(inertia), Vec3::ZERO));
    lab.app.world_mut().entity_mut(body).insert(locked);
    lab.get_mut::<Transform>(body).scale = Vec3::new(4.0, 1.0, 1.0);
    // The point is 0.4 m from the centre in the world, along X.
    let (point, lever) = (Vec3::X * 0.1, Vec3::X * 0.4);
    lab.spawn(MouseSpring::new(body, point, lever).with_frequency(FREQUENCY));
    lab.run(0.1);
    let world = lab.app.world_mut();
    let mut springs = world.query::<(&SpringDamper, &SpringAxis)>();
    let mut count = 0;
    for (spring, axis) in springs.iter(world) {
        let SpringAxis::World(axis) = *axis else {
            panic!("{axis:?}");
        };
        let turned = (turns * lever.cross(axis)).length_squared() / inertia;
        let there = (mass.recip() + turned).recip();
        let wanted = there * (std::f32::consts::TAU * FREQUENCY).powi(2);
        let share = spring.stiffness / wanted;
        assert!(
            (share - 1.0).abs() < 1e-4,
            "{axis}: {share} of {wanted} N/m"
        );
        count += 1;
    }
    assert_eq!(count, 3);
}

#[test]
fn a_scaled_body_is_held_for_the_mass_that_it_has_at_the_point_where_that_is() {
    is_held_for_its_mass(LockedAxes::empty(), Vec3::ONE);
    is_held_for_its_mass(LockedAxes::ROTATION_LOCKED_Y, Vec3::new(1.0, 0.0, 1.0));
    is_held_for_its_mass(LockedAxes::ROTATION_LOCKED, Vec3::ZERO);
}

#[test]
fn what_moves_in_a_plane_is_pulled_in_it_without_a_word() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let body = lab.body(2.0, Vec3::ZERO);
    let plane = LockedAxes::TRANSLATION_LOCKED_Z
        | LockedAxes::ROTATION_LOCKED_X
        | LockedAxes::ROTATION_LOCKED_Y;
    lab.app.world_mut().entity_mut(body).insert(plane);
    lab.tick();
    grab(&mut lab, body, Vec3::new(1.0, 0.5, 0.3));
    lab.run(3.0);
    let at = lab.position(body);
    assert!(at.distance(Vec3::new(1.0, 0.5, 0.0)) < 1e-3, "{at}");
    assert_eq!(elements(&mut lab), 2, "across the plane there is none");
    assert_eq!(log.take(), Vec::<String>::new());
}

#[test]
fn a_body_that_was_locked_when_it_was_grabbed_follows_once_it_is_free() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    lab.tick();
    let mut locked = lab.app.world_mut().entity_mut(body);
    locked.insert(LockedAxes::TRANSLATION_LOCKED);
    lab.tick();
    grab(&mut lab, body, Vec3::X);
    lab.run(0.2);
    assert_eq!(elements(&mut lab), 0, "nothing to pull");
    *lab.get_mut::<LockedAxes>(body) = LockedAxes::empty();
    lab.run(3.0);
    assert_eq!(elements(&mut lab), 3);
    let at = lab.position(body);
    assert!(at.distance(Vec3::X) < 1e-3, "{at}");
}

#[test]
fn a_pointer_whose_springs_the_game_despawns_takes_hold_anew() {
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    lab.tick();
    let pointer = grab(&mut lab, body, Vec3::X);
    lab.run(0.2);
    lab.app.world_mut().entity_mut(pointer).despawn_children();
    lab.run(3.0);
    assert_eq!(elements(&mut lab), 3);
    let at = lab.position(body);
    assert!(at.distance(Vec3::X) < 1e-3, "{at}");
}

#[test]
fn a_pointer_that_is_disabled_lets_go_silently_and_takes_hold_when_it_is_enabled() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let body = lab.body(1.0, Vec3::ZERO);
    lab.tick();
    let pointer = grab(&mut lab, body, Vec3::X);
    lab.run(0.2);
    lab.app.world_mut().entity_mut(pointer).insert(Disabled);
    lab.run(0.2);
    assert_eq!((log.take(), elements(&mut lab)), (Vec::new(), 0));
    lab.app.world_mut().entity_mut(pointer).remove::<Disabled>();
    lab.run(0.2);
    assert_eq!((log.take(), elements(&mut lab)), (Vec::new(), 3));
}
