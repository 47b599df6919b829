//! Do the drawn parts come and go with their element, without any renderer?

use crate::as_data::paths;
use crate::harness::*;
use crate::messages::Log;
use bevy::asset::AssetPlugin;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::HashSet;

/// A lab with the parts of Bevy that the visual plugin needs, without a renderer.
pub fn lab() -> Lab {
    let mut lab = Lab::without_plugin(Engine::default());
    lab.app
        .add_plugins((AssetPlugin::default(), CoiloverPlugins));
    lab.app
        .init_asset::<Mesh>()
        .init_asset::<StandardMaterial>();
    lab.prime();
    lab
}

pub fn parts(lab: &Lab, element: Entity) -> Vec<GlobalTransform> {
    let children = lab.app.world().get::<Children>(element);
    children
        .into_iter()
        .flatten()
        .filter(|c| lab.app.world().get::<Mesh3d>(**c).is_some())
        .map(|c| *lab.get::<GlobalTransform>(*c))
        .collect()
}

#[test]
fn a_coilover_has_coil_seats_tube_and_rod_and_loses_them_with_their_components() {
    let mut lab = lab();
    let hook = lab.point(Vec3::Y * 3.0);
    let body = lab.body(5.0, Vec3::Y * 2.0);
    let element = lab.spawn(coilover(hook, body));
    lab.run(0.1);
    // Coil, tube with its collar, rod, two seats.
    assert_eq!(parts(&lab, element).len(), 6);
    *lab.get_mut::<Telescope>(element) = Telescope::default().with_fittings();
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 9);
    lab.app
        .world_mut()
        .entity_mut(element)
        .remove::<Telescope>();
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 1);
    lab.get_mut::<Coil>(element).turns = 5.0;
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 1);
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
        // Elements of any length, at any place, share the mesh.
        lab.spawn((
            Spring::new(hook, body).with_rest_length(1.0 + 0.02 * i as f32),
            Coil::default(),
        ));
    }
    lab.run(0.1);
    // One mesh for each level of detail. All coils show the same one.
    let world = lab.app.world_mut();
    assert_eq!(world.resource::<Assets<Mesh>>().len(), 4);
    assert_eq!(world.resource::<Assets<RoundWireMaterial>>().len(), 1);
    let mut drawn = world.query::<(&Mesh3d, &MeshMaterial3d<RoundWireMaterial>)>();
    let shown: HashSet<_> = drawn.iter(world).map(|(m, w)| (m.id(), w.id())).collect();
    assert_eq!((drawn.iter(world).count(), shown.len()), (50, 1));
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
        // An element may have a transform of its own. It has no effect.
        Transform::from_xyz(7.0, 8.0, 9.0).with_rotation(Quat::from_rotation_x(1.0)),
    ));
    lab.tick();
    for _ in 0..120 {
        lab.tick();
        let end = |e: Entity, anchor: Vec3| lab.get::<GlobalTransform>(e).transform_point(anchor);
        let (a, b) = (end(hook, anchors.a), end(body, anchors.b));
        let coil = parts(&lab, element)[0];
        let foot = coil.transform_point(Vec3::ZERO);
        // The mesh is one metre long.
        let top = coil.transform_point(Vec3::Y);
        let length = a.distance(b);
        assert!(foot.distance(a) < 1e-4 * length, "{foot} against {a}");
        assert!(top.distance(b) < 1e-4 * length, "{top} against {b}");
    }
}

#[test]
fn a_swinging_spring_neither_spins_nor_flips_and_no_length_is_no_harm() {
    let mut lab = lab();
    let hook = lab.point(Vec3::ZERO);
    let end = lab.point(Vec3::Y);
    let element = lab.spawn((Spring::new(hook, end), Coil::default()));
    lab.tick();
    let side = |lab: &Lab| {
        let at = parts(lab, element)[0].affine().matrix3;
        assert!(at.is_finite());
        at.x_axis.normalize()
    };
    let mut before = side(&lab);
    let first = before;
    for degree in 0..=720 {
        let angle = (degree as f32).to_radians();
        // Two full turns through the vertical, once with zero length on the way, and back to the start.
        let length = if degree == 200 { 0.0 } else { 1.0 };
        lab.get_mut::<Transform>(end).translation =
            length * Vec3::new(0.0, angle.cos(), angle.sin());
        lab.tick();
        let now = side(&lab);
        assert!(
            now.distance(before) < 0.04,
            "turned by more than its swing at {degree}°"
        );
        before = now;
    }
    assert!(before.distance(first) < 1e-3, "{before} was {first}");
}

#[test]
fn a_coil_turns_with_end_a() {
    let mut lab = lab();
    let hook = lab.point(Vec3::ZERO);
    let end = lab.point(Vec3::Y);
    let element = lab.spawn((Spring::new(hook, end), Coil::default()));
    lab.tick();
    lab.tick();
    let before = parts(&lab, element)[0].affine().matrix3.x_axis;
    lab.get_mut::<Transform>(hook).rotation = Quat::from_rotation_y(1.0);
    lab.tick();
    let after = parts(&lab, element)[0].affine().matrix3.x_axis;
    assert!((after.angle_between(before) - 1.0).abs() < 1e-4);
}

#[test]
fn a_skin_of_the_users_is_stretched_between_the_ends() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let mesh = lab
        .app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Helix::new(0.1, 0.01, 5.0, 0.5));
    let element = lab.spawn((
        Spring::new(a, b),
        Transform::default(),
        Visibility::default(),
        children![(SpringSkin { length: 0.5 }, Mesh3d(mesh))],
    ));
    lab.run(0.1);
    let skin = parts(&lab, element)[0];
    assert!(skin.transform_point(Vec3::ZERO).distance(Vec3::X) < 1e-5);
    assert!(skin.transform_point(Vec3::Y * 0.5).distance(Vec3::X * 3.0) < 1e-5);
}

#[test]
fn looks_that_cannot_be_drawn_are_told_once_by_entity_and_field() {
    let log = Log::capture();
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let spring = Spring::new(a, b).with_rest_length(1.0);
    let coil = lab.spawn((spring, Coil::new(0.1, 0.2, 8.0)));
    let thin = Telescope::new(0.05, 0.06);
    let telescope = lab.spawn((Damper::new(a, b), thin));
    let endless = Telescope::default().with_stroke(f32::NAN);
    let stroke = lab.spawn((Damper::new(a, b), endless));
    // Eight turns of 0.16 m do not fit into a metre.
    let thick = lab.spawn((spring, Coil::new(0.2, 0.08, 8.0)));
    lab.run(0.2);
    let told = log.take();
    assert_eq!(told.len(), 4, "{told:?}");
    for (entity, what) in [
        (coil, "Coil: wire_radius is 0.2 m"),
        (telescope, "Telescope: rod_radius is 0.06 m"),
        (stroke, "Telescope: stroke is NaN"),
        (thick, "wire passes through wire"),
    ] {
        let named = format!("{entity}: ");
        assert!(
            told.iter().any(|t| t.contains(&named) && t.contains(what)),
            "{told:?} say nothing of {what}"
        );
    }
    assert!(parts(&lab, coil).is_empty() && parts(&lab, telescope).is_empty());
    *lab.get_mut::<Coil>(coil) = Coil::default();
    lab.tick();
    assert_eq!(parts(&lab, coil).len(), 1);
}

#[test]
fn a_coil_pressed_until_wire_passes_through_wire_is_told_once_with_both_lengths() {
    let log = Log::capture();
    let mut lab = lab();
    let coil = Coil::default();
    let solid = coil.solid_length();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let element = lab.spawn((Spring::new(a, b), coil));
    let told_at = |lab: &mut Lab, length: f32| {
        lab.get_mut::<Transform>(b).translation = length * Vec3::Y;
        lab.run(0.1);
        log.take()
    };
    assert!(told_at(&mut lab, 1.0).is_empty());
    // Turns that touch are no fault.
    assert!(told_at(&mut lab, 0.99 * solid).is_empty());
    let length = 0.9 * solid;
    let told = told_at(&mut lab, length);
    assert_eq!(told.len(), 1, "{told:?}");
    let wanted = format!(
        "{element}: Coil: it is {length} m long, but all its turns touch at {solid} m already, so wire \
         passes through wire"
    );
    assert_eq!(told[0], wanted);
    assert!(told_at(&mut lab, 1.0).is_empty());
    assert!(told_at(&mut lab, length).is_empty(), "told twice");
    // Changed looks cause a new message.
    lab.get_mut::<Coil>(element).radius = 0.14;
    assert_eq!(told_at(&mut lab, length).len(), 1);
    lab.get_mut::<Coil>(element).color = Color::BLACK;
    assert!(
        told_at(&mut lab, length).is_empty(),
        "other paint is no news"
    );
}

#[test]
fn a_coil_pressed_between_its_seats_is_told_though_its_ends_are_farther_apart() {
    let log = Log::capture();
    let mut lab = lab();
    let coil = Coil::default();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let damper = Damper::new(a, b);
    lab.spawn((damper, coil, Telescope::default()));
    lab.spawn((damper, Telescope::default()));
    lab.run(0.1);
    assert!(log.take().is_empty());
    // Two seats lie between the ends. Each is one and a half times the wire's radius high.
    lab.get_mut::<Transform>(b).translation = Vec3::Y * (coil.solid_length() + coil.wire_radius);
    lab.run(0.1);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains("wire passes through wire"));
}

#[test]
fn what_is_drawn_reflects() {
    let lab = lab();
    let registry = lab.app.world().resource::<AppTypeRegistry>().read();
    for name in [
        "Coil",
        "Telescope",
        "SpringSkin",
        "TorsionCoil",
        "ShowSpringGizmos",
        "SpringGizmos",
        "Helix",
        "HelixEnds",
        "Handedness",
        "RoundWire",
    ] {
        let registration = registry.get_with_short_type_path(name);
        let path = registration.map(|r| r.type_info().type_path());
        // A saved scene must not contain module names, because another version may not have these modules.
        assert_eq!(path, Some(format!("bevy_coilover::{name}").as_str()));
    }
    drop(registry);
    let is_plain = |path: &&str| path.matches("::").count() == 1;
    assert!(paths(&lab).iter().all(is_plain));
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
