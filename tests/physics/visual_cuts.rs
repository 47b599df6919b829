//! Is a coil as fine in the first frame after a cut of the camera as it stays?

use crate::harness::*;
use crate::visual_data::lab;
use crate::visual_rest::{look, turn};
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// A place from which a camera sees the coil at the origin, at this distance from it, m.
fn ahead(distance: f32) -> Transform {
    Transform::from_xyz(0.0, 0.5, distance)
}

/// A coil from the origin to one metre above it. Returns the lab, the element and its end B.
fn coil() -> (Lab, Entity, Entity) {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let element = lab.spawn((Spring::new(a, b), Coil::default()));
    (lab, element, b)
}

/// Number of vertices of the mesh that shows the element.
fn vertices(lab: &Lab, element: Entity) -> usize {
    let part = lab.get::<Children>(element)[0];
    let meshes = lab.app.world().resource::<Assets<Mesh>>();
    let mesh = meshes.get(lab.get::<Mesh3d>(part));
    mesh.expect("loaded").count_vertices()
}

/// Runs a frame, and returns the number of vertices in it. Asserts that eight more frames, in which every element is
/// looked at again, do not change it.
fn at_once(lab: &mut Lab, element: Entity) -> usize {
    lab.tick();
    let first = vertices(lab, element);
    lab.run(8.0 / 60.0);
    assert_eq!(vertices(lab, element), first, "it came later");
    first
}

#[test]
fn a_camera_that_is_cut_near_or_far_sees_the_right_detail_at_once() {
    for moves in [false, true] {
        let (mut lab, element, b) = coil();
        let camera = look(&mut lab, ahead(60.0));
        lab.run(0.2);
        // In each frame another eighth of all elements has its turn.
        for cut in 0..8 {
            let [near, far] = [2.0, 60.0].map(|distance| {
                turn(&mut lab, camera, ahead(distance));
                if moves {
                    lab.get_mut::<Transform>(b).translation.x += 1e-3;
                }
                at_once(&mut lab, element)
            });
            assert!(near > far, "cut {cut}: {near}, {far}");
        }
    }
}

#[test]
fn a_second_camera_that_is_cut_to_face_a_coil_sees_the_right_detail_at_once() {
    let (mut lab, element, _) = coil();
    look(&mut lab, ahead(60.0));
    let away = ahead(2.0).looking_to(Vec3::Z, Vec3::Y);
    let camera = look(&mut lab, away);
    lab.run(0.2);
    for cut in 0..8 {
        let [near, far] = [ahead(2.0), away].map(|at| {
            turn(&mut lab, camera, at);
            at_once(&mut lab, element)
        });
        assert!(near > far, "cut {cut}: {near}, {far}");
    }
}

#[test]
fn a_coil_that_had_no_end_during_a_cut_has_the_right_detail_once_it_has_one() {
    let (mut lab, element, b) = coil();
    let camera = look(&mut lab, ahead(60.0));
    lab.run(0.2);
    let far = vertices(&lab, element);
    for pause in 0..8 {
        let place = *lab.get::<GlobalTransform>(b);
        let mut end = lab.app.world_mut().entity_mut(b);
        end.remove::<GlobalTransform>();
        lab.tick();
        turn(&mut lab, camera, ahead(2.0));
        (0..=pause).for_each(|_| lab.tick());
        lab.app.world_mut().entity_mut(b).insert(place);
        assert!(at_once(&mut lab, element) > far, "after {pause} frames");
        turn(&mut lab, camera, ahead(60.0));
        assert_eq!(at_once(&mut lab, element), far);
    }
}
