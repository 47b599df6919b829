//! Do springs out of sight cost less, and are they drawn correctly as soon as they are seen?

use crate::canvas::*;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::HashSet;

fn coil_of(app: &App, element: Entity) -> Entity {
    let children = app.world().get::<Children>(element).expect("drawn");
    children[0]
}

#[test]
fn a_spring_out_of_sight_is_seldom_placed_and_right_when_it_is_seen() {
    let Some(mut canvas) = Canvas::new() else {
        return;
    };
    let app = &mut canvas.app;
    let (a, b) = ends(
        app.world_mut(),
        Vec3::X * 10.0,
        Vec3::X * 10.0 + Vec3::Y * 0.5,
    );
    let looks = (Spring::new(a, b), Coil::new(0.1, 0.02, 5.0));
    let element = app.world_mut().spawn(looks).id();
    (0..20).for_each(|_| app.update());
    let coil = coil_of(app, element);
    let mut places = HashSet::new();
    for i in 0..16 {
        let y = 0.01 * i as f32;
        app.world_mut()
            .get_mut::<Transform>(a)
            .expect("an end")
            .translation
            .y = -y;
        app.update();
        let at = app.world().get::<GlobalTransform>(coil).expect("placed");
        places.insert(at.translation().y.to_bits());
    }
    assert!(
        (2..=3).contains(&places.len()),
        "placed {} times in 16 frames",
        places.len()
    );

    for (end, y) in [(a, 0.0), (b, 0.5)] {
        app.world_mut()
            .get_mut::<Transform>(end)
            .expect("an end")
            .translation = Vec3::Y * y;
    }
    app.update();
    let at = app.world().get::<GlobalTransform>(coil).expect("placed");
    assert!(at.translation().length() < 1e-5, "{}", at.translation());
    assert!((at.transform_point(Vec3::Y).y - 0.5).abs() < 1e-5);
}

#[test]
fn a_coil_gets_coarser_as_it_gets_smaller_on_the_screen() {
    let Some(mut canvas) = Canvas::new() else {
        return;
    };
    let app = &mut canvas.app;
    let mut vertices = Vec::new();
    for wire in [0.04, 0.015, 0.005, 0.002] {
        let (a, b) = ends(app.world_mut(), Vec3::ZERO, Vec3::Y * 0.5);
        let looks = (Spring::new(a, b), Coil::new(0.1, wire, 5.0));
        let element = app.world_mut().spawn(looks).id();
        (0..3).for_each(|_| app.update());
        let coil = coil_of(app, element);
        let mesh = app.world().get::<Mesh3d>(coil).expect("a mesh");
        let meshes = app.world().resource::<Assets<Mesh>>();
        vertices.push(meshes.get(mesh).expect("loaded").count_vertices());
    }
    println!("vertices of a coil of five turns: {vertices:?}");
    assert!(vertices.windows(2).all(|w| w[1] < w[0]), "{vertices:?}");
}

#[test]
fn gizmos_are_drawn_where_they_are_asked_for_and_nowhere_else() {
    let coloured = |all: bool, own: Option<ShowSpringGizmos>| {
        let mut canvas = Canvas::new()?;
        let world = canvas.app.world_mut();
        let mut store = world.resource_mut::<GizmoConfigStore>();
        store.config_mut::<SpringGizmos>().1.all = all;
        let (a, b) = ends(world, Vec3::NEG_Y * 0.5, Vec3::Y * 0.5);
        let pull = SpringReadout {
            spring_force: 40.0,
            ..default()
        };
        let mut element = world.spawn((Spring::new(a, b).with_rest_length(0.6), pull));
        if let Some(own) = own {
            element.insert(own);
        }
        let picture = canvas.shoot();
        Some(extent(&picture, |pixel, _| is_drawn(pixel)).count)
    };
    let (on, off) = (Some(ShowSpringGizmos(true)), Some(ShowSpringGizmos(false)));
    let Some(nothing) = coloured(false, None) else {
        return;
    };
    assert_eq!(nothing, 0);
    assert!(coloured(false, on) > Some(100));
    assert!(coloured(true, None) > Some(100));
    assert_eq!(coloured(true, off), Some(0));
}
