//! Do the debug lines show the forces in the direction in which they act?

use crate::harness::*;
use bevy::asset::AssetPlugin;
use bevy::gizmos::config::GizmoConfigStore;
use bevy::gizmos::{GizmoAsset, GizmoHandles};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::RigidBody;
use std::any::TypeId;
use std::f32::consts::FRAC_PI_2;

/// Position of end B. End A is at the origin, rotated so that its Y axis points along −X.
const B: Vec3 = Vec3::new(0.3, 1.0, 0.0);

/// Start and end of each red line of an element under a tension (N): arrows with their heads. With `below`, end A is a
/// child of a body, and is itself turned by this against the body.
fn lines(tension: f32, axis: Option<SpringAxis>, below: Option<Quat>) -> Vec<[Vec3; 2]> {
    // Without the physics plugin, which would overwrite the readout.
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app
        .add_plugins(AssetPlugin::default())
        .init_asset::<GizmoAsset>()
        .init_resource::<GizmoConfigStore>()
        .add_plugins(CoiloverVisualPlugin)
        .init_asset::<Mesh>()
        .init_asset::<StandardMaterial>();
    lab.prime();
    let turned = Transform::from_rotation(Quat::from_rotation_z(FRAC_PI_2));
    let a = match below {
        None => lab.spawn(turned),
        Some(turn) => {
            let body = lab.spawn((RigidBody::Fixed, turned));
            lab.spawn((Transform::from_rotation(turn), ChildOf(body)))
        }
    };
    let b = lab.point(B);
    let tension = SpringReadout {
        spring_force: tension,
        ..default()
    };
    let element = lab.spawn((Spring::new(a, b), tension, ShowSpringGizmos(true)));
    if let Some(axis) = axis {
        lab.app.world_mut().entity_mut(element).insert(axis);
    }
    lab.tick();
    let world = lab.app.world();
    let handles = world.resource::<GizmoHandles>().handles();
    let handle = handles.get(&TypeId::of::<SpringGizmos>());
    let handle = handle.and_then(Option::as_ref).expect("lines");
    let drawn = world.resource::<Assets<GizmoAsset>>().get(handle);
    let drawn = drawn.expect("lines").buffer().buffer();
    let lines = drawn
        .list_positions
        .chunks(2)
        .zip(drawn.list_colors.chunks(2));
    lines
        .filter(|(_, colors)| colors[0].red > 0.5 && colors[0].green < 0.1)
        .map(|(line, _)| [line[0], line[1]])
        .collect()
}

#[test]
fn forces_lie_along_the_line_between_the_ends_or_along_the_axis_of_the_element() {
    let of_a = Some(SpringAxis::BodyA(Vec3::Y));
    for (axis, below, way) in [
        (None, None, B.normalize()),
        (Some(SpringAxis::World(2.0 * Vec3::X)), None, Vec3::X),
        (of_a, None, Vec3::NEG_X),
        // The axis is in the frame of the body, whatever the turn of the end on it.
        (of_a, Some(Quat::from_rotation_x(1.0)), Vec3::NEG_X),
    ] {
        // 5 mm per newton.
        let pull = 0.2 * way;
        let wanted = [[Vec3::ZERO, pull], [B, B - pull]];
        let mut drawn = lines(40.0, axis, below);
        // The shaft of an arrow is ten times as long as the lines of its head.
        drawn.retain(|[from, to]| from.distance(*to) > 0.1);
        assert_eq!(drawn.len(), 2, "{axis:?}, {below:?}: {drawn:?}");
        for (drawn, wanted) in drawn.into_iter().zip(wanted) {
            let is_near =
                drawn[0].distance(wanted[0]) < 1e-5 && drawn[1].distance(wanted[1]) < 1e-5;
            assert!(is_near, "{axis:?}, {below:?}: {drawn:?}, not {wanted:?}");
        }
    }
}

#[test]
fn a_force_too_weak_or_too_strong_for_an_arrow_has_none() {
    assert_eq!(lines(1.0, None, None).len(), 10);
    for tension in [1e-30, 1e-6, 1e38] {
        let drawn = lines(tension, None, None);
        assert!(drawn.is_empty(), "{tension} N: {drawn:?}");
    }
}
