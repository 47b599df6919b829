//! Spirals in a game: a winch that turns on and on, a door that hangs open, a hinge below its door.

use crate::visual_data::lab;
use crate::visual_torsion::{Door, RADIUS, check_size};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::f32::consts::TAU;

/// A spiral on a winch that turns on and on.
#[test]
fn a_spiral_that_is_wound_beyond_what_can_be_drawn_needs_no_more_meshes() {
    for sign in [1.0, -1.0] {
        let mut winch = Door::new(TorsionCoil::new(RADIUS, 2.0));
        let meshes = |winch: &Door| winch.lab.app.world().resource::<Assets<Mesh>>().len();
        let mut angle = 0.0;
        while angle < 6.0 * TAU {
            angle += 0.5;
            winch.turn(sign * angle);
        }
        let before = meshes(&winch);
        for _ in 0..600 {
            angle += 0.5;
            winch.turn(sign * angle);
            assert!(
                meshes(&winch) <= before,
                "{} at {angle} rad",
                meshes(&winch)
            );
        }
    }
}

/// A door that hangs open when the level starts. Its rest angle will be that of the first step, which has not come yet.
#[test]
fn a_spiral_without_a_rest_angle_is_at_rest_before_the_first_step() {
    let mut lab = lab();
    let frame = lab.point(Vec3::X);
    let open = Transform::from_xyz(1.0, 0.0, 0.0).with_rotation(Quat::from_rotation_z(1.5));
    let door = lab.spawn(open);
    let coil = TorsionCoil::new(RADIUS, 4.0);
    let element = lab.spawn((TorsionSpring::new(frame, door, Vec3::Z), coil));
    lab.app.world_mut().run_schedule(PostUpdate);
    let door = Door { lab, door, element };
    let [inner, _] = door.ends();
    let closed = Door::new(coil);
    let [wanted, _] = closed.ends();
    assert!(inner.distance(wanted) < 1e-4, "{inner}, not {wanted}");
}

/// The hinge is a child of the door, and so is the door's collider.
#[test]
fn it_fits_what_the_body_of_its_end_is_made_of() {
    let mut lab = lab();
    let frame = lab.point(Vec3::ZERO);
    let door = lab.spawn((RigidBody::Fixed, Transform::from_xyz(0.9, 0.0, 0.0)));
    let hinge = lab.spawn((Transform::from_xyz(-0.9, 0.0, 0.0), ChildOf(door)));
    let panel = (Collider::ball(0.4), Transform::from_xyz(0.5, 0.0, 0.0));
    lab.spawn((panel, ChildOf(door)));
    let element = lab.spawn((
        TorsionSpring::new(frame, hinge, Vec3::Y).with_rest_angle(0.0),
        TorsionCoil::default(),
    ));
    lab.run(0.1);
    check_size(&lab, element, 1.8);
}
