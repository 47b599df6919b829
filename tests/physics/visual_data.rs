//! Do the drawn parts come and go with their element, without any renderer?

use crate::harness::*;
use crate::messages::Log;
use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

/// A lab with what the visual plugin needs of Bevy, and no renderer.
fn lab() -> Lab {
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app
        .add_plugins((AssetPlugin::default(), CoiloverPlugins));
    lab.app
        .init_asset::<Mesh>()
        .init_asset::<StandardMaterial>();
    lab.prime();
    lab
}

fn parts(lab: &Lab, element: Entity) -> Vec<(Transform, GlobalTransform)> {
    let children = lab.app.world().get::<Children>(element);
    children
        .into_iter()
        .flatten()
        .filter(|c| lab.app.world().get::<Mesh3d>(**c).is_some())
        .map(|c| (*lab.get::<Transform>(*c), *lab.get::<GlobalTransform>(*c)))
        .collect()
}

#[test]
fn a_coilover_has_coil_seats_tube_and_rod_and_loses_them_with_their_components() {
    let mut lab = lab();
    let hook = lab.point(Vec3::Y * 3.0);
    let body = lab.body(5.0, Vec3::Y * 2.0);
    let element = lab.spawn(coilover(hook, body));
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 5);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<Telescope>();
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 3);
    lab.get_mut::<Coil>(element).turns = 5.0;
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 3);
    lab.app.world_mut().entity_mut(element).remove::<Coil>();
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 0);
}

#[test]
fn equal_springs_share_one_mesh_and_one_material() {
    let mut lab = lab();
    for i in 0..50 {
        let hook = lab.point(Vec3::new(i as f32, 3.0, 0.0));
        let body = lab.body(5.0, Vec3::new(i as f32, 2.0, 0.0));
        lab.spawn((
            Spring::new(hook, body).with_rest_length(1.0),
            Coil::default(),
        ));
    }
    lab.run(0.1);
    // The coil and the disc of its seats; its paint and steel.
    assert_eq!(lab.app.world().resource::<Assets<Mesh>>().len(), 2);
    assert_eq!(
        lab.app.world().resource::<Assets<StandardMaterial>>().len(),
        2
    );
}

#[test]
fn the_coil_meets_the_anchors_every_frame_under_scaled_parents_too() {
    let mut lab = lab();
    let root = lab.spawn(Transform::from_xyz(1.0, 0.0, 2.0).with_scale(Vec3::splat(2.0)));
    let hook = lab.spawn((Transform::from_xyz(0.0, 1.5, 0.0), ChildOf(root)));
    let body = lab.body(1.0, Vec3::new(0.5, 1.5, 2.0));
    let anchors = Anchors::new(Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.0, 0.2, 0.1));
    let element = lab.spawn((
        Spring::new(hook, body)
            .with_stiffness(60.0)
            .with_rest_length(1.0),
        anchors,
        Coil::default(),
        // An element may have a place of its own; it does not matter.
        Transform::from_xyz(7.0, 8.0, 9.0).with_rotation(Quat::from_rotation_x(1.0)),
    ));
    lab.tick();
    for _ in 0..120 {
        lab.tick();
        let end = |e: Entity, anchor: Vec3| lab.get::<GlobalTransform>(e).transform_point(anchor);
        let (a, b) = (end(hook, anchors.a), end(body, anchors.b));
        let (_, coil) = parts(&lab, element)
            .into_iter()
            .min_by(|x, y| {
                x.1.translation()
                    .distance(a)
                    .total_cmp(&y.1.translation().distance(a))
            })
            .expect("drawn");
        let foot = coil.transform_point(Vec3::ZERO);
        // The mesh is as long as the rest length.
        let top = coil.transform_point(Vec3::Y);
        let length = a.distance(b);
        assert!(foot.distance(a) < 1e-4 * length, "{foot} against {a}");
        assert!(top.distance(b) < 1e-4 * length, "{top} against {b}");
    }
}

#[test]
fn without_assets_the_visual_plugin_says_so_and_physics_goes_on() {
    let log = Log::capture();
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app.add_plugins(CoiloverPlugins);
    lab.prime();
    let hook = lab.point(Vec3::Y * 3.0);
    let body = lab.body(5.0, Vec3::Y * 2.0);
    lab.spawn(coilover(hook, body));
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("mesh and material") && told[0].contains("CoiloverPlugin alone"));
    assert!(lab.position(body).y < 2.0);
}
