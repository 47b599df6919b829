//! Do fitted looks suit the scene, and can a coilover be built in one expression?

use crate::harness::*;
use crate::messages::Log;
use crate::visual_data::{lab, parts};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

#[test]
fn a_coilover_is_built_in_one_bundle() {
    let mut lab = lab();
    let hook = lab.point(Vec3::Y * 3.0);
    let load = lab.body(5.0, Vec3::Y * 2.0);
    let coil = Coil::new(0.05, 0.005, 6.0);
    let element = lab.spawn((
        Coilover::new(hook, load)
            .with_stiffness(500.0)
            .with_damping(20.0)
            .with_rest_length(0.9)
            .with_anchors(Vec3::NEG_Y * 0.1, Vec3::Y * 0.1)
            .with_coil(coil)
            .with_telescope(Telescope::new(0.02, 0.01)),
        SpringTravel::new(0.2, 2.0, 1e4),
    ));
    lab.run(0.1);
    let pair = SpringDamper::new(hook, load)
        .with_stiffness(500.0)
        .with_damping(20.0)
        .with_rest_length(0.9);
    assert_eq!(*lab.get::<SpringDamper>(element), pair);
    assert_eq!(*lab.get::<Coil>(element), coil);
    assert_eq!(lab.get::<Telescope>(element).tube_radius, 0.02);
    assert_eq!(
        *lab.get::<Anchors>(element),
        Anchors::new(Vec3::NEG_Y * 0.1, Vec3::Y * 0.1)
    );
    assert_eq!(parts(&lab, element).len(), 6);
    assert_eq!(coilover(hook, load), Coilover::new(hook, load));
}

#[test]
fn fitted_looks_are_as_thick_as_their_first_length_asks_and_stay_so() {
    let mut lab = lab();
    for length in [0.05_f32, 1.0, 40.0] {
        let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y * length));
        let telescope = lab.spawn((Damper::new(a, b), Telescope::fitted()));
        let both = lab.spawn(Coilover::new(a, b).fitted());
        lab.tick();
        lab.tick();
        // The widest part of the telescope is its collar. It is a little wider than the tube.
        let widest = |lab: &Lab| {
            let scales = parts(lab, telescope).into_iter().map(|part| part.scale().x);
            scales.fold(0.0, f32::max)
        };
        let before = widest(&lab);
        let share = before / length;
        assert!((0.95 * 0.0537..1.05 * 0.0538).contains(&share), "{share}");
        assert_eq!(parts(&lab, both).len(), 6);
        lab.get_mut::<Transform>(b).translation *= 1.2;
        lab.tick();
        lab.tick();
        assert!((widest(&lab) - before).abs() < 1e-5 * before);
    }
}

#[test]
fn fitted_springs_of_nearly_one_length_share_a_mesh() {
    let mut lab = lab();
    for i in 0..20 {
        let at = Vec3::X * i as f32;
        let (a, b) = (
            lab.point(at),
            lab.point(at + Vec3::Y * (1.0 + 0.002 * i as f32)),
        );
        lab.spawn((Spring::new(a, b), Coil::fitted()));
    }
    lab.run(0.1);
    // One mesh for each level of detail.
    assert_eq!(lab.app.world().resource::<Assets<Mesh>>().len(), 4);
}

#[test]
fn a_skin_gives_its_element_what_drawing_needs() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let mesh = Cylinder::new(0.02, 1.0)
        .mesh()
        .anchor(bevy::mesh::CylinderAnchor::Bottom);
    let mesh = lab.app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let element = lab.spawn((
        Spring::new(a, b),
        children![(SpringSkin { length: 1.0 }, Mesh3d(mesh))],
    ));
    // Still in the spawn frame. At its end, Bevy warns of parents without these components.
    lab.tick();
    let world = lab.app.world();
    assert!(world.get::<GlobalTransform>(element).is_some());
    assert!(world.get::<InheritedVisibility>(element).is_some());
    lab.tick();
    let skin = parts(&lab, element)[0];
    assert!(skin.transform_point(Vec3::ZERO).distance(Vec3::X) < 1e-5);
    assert!(skin.transform_point(Vec3::Y).distance(Vec3::X * 3.0) < 1e-5);
}

#[test]
fn a_coil_on_points_of_the_world_is_drawn_there_before_the_first_step() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let points = WorldAnchors::new(Vec3::X, Vec3::X + Vec3::Y);
    let element = lab.spawn((Spring::new(a, b), points, Coil::default()));
    lab.app.world_mut().run_schedule(PostUpdate);
    let before = lab.app.world().get::<WorldAnchors>(element).is_some();
    assert!(before, "no step yet");
    lab.app.world_mut().run_schedule(PostUpdate);
    let foot = parts(&lab, element)[0].transform_point(Vec3::ZERO);
    assert!(foot.distance(Vec3::X) < 1e-4, "{foot}");
}

#[test]
fn what_is_a_skin_no_more_goes_back_to_its_own_place_and_stays_its_users() {
    for is_removed in [true, false] {
        let mut lab = lab();
        let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
        let at = Transform::from_xyz(0.0, 5.0, 0.0);
        let element = lab.spawn((Spring::new(a, b), at, Visibility::default()));
        let skin = (
            SpringSkin { length: 1.0 },
            Transform::from_xyz(0.0, 0.0, 2.0),
            ChildOf(element),
        );
        let skin = lab.spawn(skin);
        lab.run(0.1);
        let foot = |lab: &Lab| lab.get::<GlobalTransform>(skin).translation();
        assert!(foot(&lab).distance(Vec3::X) < 1e-5);
        if is_removed {
            lab.app.world_mut().entity_mut(skin).remove::<SpringSkin>();
        } else {
            // A skin with a bad length is ignored, with a message.
            lab.get_mut::<SpringSkin>(skin).length = -1.0;
        }
        lab.run(0.1);
        let own = Vec3::new(0.0, 5.0, 2.0);
        assert!(foot(&lab).distance(own) < 1e-5, "{}", foot(&lab));
        // The former skin must not be removed together with the looks.
        lab.app
            .world_mut()
            .entity_mut(element)
            .insert(Coil::default());
        lab.get_mut::<Transform>(a).translation.y = 1.0;
        lab.run(0.1);
        lab.app.world_mut().entity_mut(element).remove::<Coil>();
        lab.run(0.1);
        assert!(foot(&lab).distance(own) < 1e-5, "{}", foot(&lab));
        // With `SpringSkin` again, it is stretched between the ends again.
        let again = SpringSkin { length: 1.0 };
        lab.app.world_mut().entity_mut(skin).insert(again);
        lab.run(0.1);
        assert!(foot(&lab).distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-5);
    }
}

/// Whether a skin of one metre is drawn from one point to the other.
fn goes(lab: &Lab, skin: Entity, from: Vec3, to: Vec3) -> bool {
    let at = lab.get::<GlobalTransform>(skin);
    at.transform_point(Vec3::ZERO).distance(from) < 1e-5
        && at.transform_point(Vec3::Y).distance(to) < 1e-5
}

#[test]
fn a_skin_is_placed_once_it_has_a_parent_and_again_with_another_one() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let skin = lab.spawn(SpringSkin { length: 1.0 });
    lab.run(0.1);
    // Neither element has any other looks.
    for (first, last) in [(a, b), (b, a)] {
        let element = lab.spawn(Spring::new(first, last));
        let mut entity = lab.app.world_mut().entity_mut(skin);
        entity.insert(ChildOf(element));
        lab.run(0.1);
        let (from, to) = (lab.position(first), lab.position(last));
        assert!(goes(&lab, skin, from, to), "from {from} to {to}");
    }
}

#[test]
fn a_skin_that_was_spawned_disabled_is_placed_once_it_is_enabled() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let element = lab.spawn(Spring::new(a, b));
    let skin = lab.spawn((SpringSkin { length: 1.0 }, ChildOf(element), Disabled));
    lab.run(0.1);
    lab.app.world_mut().entity_mut(skin).remove::<Disabled>();
    lab.run(0.1);
    assert!(goes(&lab, skin, Vec3::X, Vec3::X * 3.0));
}

#[test]
fn what_hangs_below_a_skin_goes_with_it() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let element = lab.spawn(Spring::new(a, b));
    let skin = lab.spawn((SpringSkin { length: 1.0 }, ChildOf(element)));
    let knot = lab.spawn((Transform::from_xyz(0.0, 0.5, 0.0), ChildOf(skin)));
    let tag = lab.spawn((Transform::from_xyz(0.0, 0.25, 0.0), ChildOf(knot)));
    let is_at = |lab: &Lab, entity: Entity, wanted: Vec3| {
        let at = lab.get::<GlobalTransform>(entity).translation();
        assert!(at.distance(wanted) < 1e-5, "{at}, not {wanted}");
    };
    lab.run(0.1);
    is_at(&lab, knot, 2.0 * Vec3::X);
    is_at(&lab, tag, 2.5 * Vec3::X);
    lab.get_mut::<Transform>(b).translation = 5.0 * Vec3::X;
    lab.tick();
    is_at(&lab, tag, 4.0 * Vec3::X);
    lab.get_mut::<Transform>(tag).translation.y = 0.5;
    lab.tick();
    is_at(&lab, tag, 5.0 * Vec3::X);
    lab.app.world_mut().entity_mut(skin).remove::<SpringSkin>();
    lab.run(0.1);
    is_at(&lab, tag, Vec3::Y);
}

#[test]
fn a_skin_of_a_disabled_element_is_not_drawn_until_that_is_enabled() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
    let element = lab.spawn(Spring::new(a, b));
    let skin = lab.spawn((SpringSkin { length: 1.0 }, ChildOf(element)));
    lab.run(0.1);
    assert!(goes(&lab, skin, Vec3::X, Vec3::X * 3.0));
    let size = |lab: &Lab, skin: Entity| lab.get::<GlobalTransform>(skin).scale();
    // As `WhenBroken::Disable` does.
    lab.app.world_mut().entity_mut(element).insert(Disabled);
    lab.tick();
    assert_eq!(size(&lab, skin), Vec3::ZERO);
    lab.get_mut::<Transform>(b).translation = Vec3::X * 2.0;
    lab.run(0.1);
    assert_eq!(size(&lab, skin), Vec3::ZERO);
    lab.app.world_mut().entity_mut(element).remove::<Disabled>();
    lab.tick();
    assert!(goes(&lab, skin, Vec3::X, Vec3::X * 2.0));
    // An element that is spawned disabled, as from a pool.
    let pooled = lab.spawn((Spring::new(a, b), Disabled));
    let skin = lab.spawn((SpringSkin { length: 1.0 }, ChildOf(pooled)));
    lab.run(0.1);
    assert_eq!(size(&lab, skin), Vec3::ZERO);
}

#[test]
fn looks_that_go_before_they_are_drawn_leave_no_size_behind() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::ZERO));
    // Not drawn yet, because the ends coincide.
    let element = lab.spawn((Damper::new(a, b), Coil::fitted()));
    lab.run(0.1);
    lab.app.world_mut().entity_mut(element).remove::<Coil>();
    lab.run(0.1);
    lab.get_mut::<Transform>(b).translation = 2.0 * Vec3::Y;
    let looks = Telescope::fitted();
    lab.app.world_mut().entity_mut(element).insert(looks);
    lab.run(0.1);
    let widths = parts(&lab, element).into_iter().map(|part| part.scale().x);
    let widest = widths.fold(0.0, f32::max);
    // The collar is 1.12 times as wide as the tube, whose radius is 4.8 % of the length.
    assert!((0.095..0.12).contains(&widest), "{widest}");
}

#[test]
fn a_skin_of_hardly_any_length_is_told_once_and_never_gets_an_endless_scale() {
    for length in [0.0, f32::from_bits(1), f32::MIN_POSITIVE, 1e-30, 9e-6] {
        let log = Log::capture();
        let mut lab = lab();
        let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::X * 3.0));
        let element = lab.spawn(Spring::new(a, b));
        let skin = lab.spawn((SpringSkin { length }, ChildOf(element)));
        for _ in 0..12 {
            lab.tick();
            let at = lab.get::<GlobalTransform>(skin).affine();
            assert!(at.is_finite(), "{length} m: {at:?}");
            assert!(at.matrix3.y_axis.length() < 1e6, "{length} m: {at:?}");
        }
        let told = log.take();
        assert_eq!(told.len(), 1, "{told:?}");
        let named = format!("{skin}: SpringSkin: length is");
        assert!(told[0].starts_with(&named), "{told:?}");
        lab.get_mut::<SpringSkin>(skin).length = 1.0;
        lab.run(0.1);
        assert!(goes(&lab, skin, Vec3::X, Vec3::X * 3.0));
        assert_eq!(log.take(), Vec::<String>::new());
    }
}

/// Materials of one kind on the parts of an element.
fn materials<M: Material>(lab: &Lab, element: Entity) -> Vec<AssetId<M>> {
    let of = |part: &Entity| {
        let material = lab.app.world().get::<MeshMaterial3d<M>>(*part);
        material.map(|material| material.0.id())
    };
    let parts = lab.get::<Children>(element);
    parts.iter().filter_map(|part| of(&part)).collect()
}

/// A game colours a spring by its force in every frame. Its parts stay the same entities, and so do their meshes.
#[test]
fn other_colours_repaint_the_parts_and_the_same_looks_leave_them_alone() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let element = lab.spawn(coilover(a, b));
    lab.run(0.1);
    let children = |lab: &Lab| lab.get::<Children>(element).to_vec();
    let paints = |lab: &Lab| materials::<StandardMaterial>(lab, element);
    let wires = |lab: &Lab| materials::<RoundWireMaterial>(lab, element);
    let (first, paint, wire) = (children(&lab), paints(&lab), wires(&lab));
    lab.get_mut::<Coil>(element).color = Color::BLACK;
    lab.tick();
    assert_eq!(
        (children(&lab), paints(&lab)),
        (first.clone(), paint.clone())
    );
    assert!(wires(&lab).len() == 1 && wires(&lab) != wire);
    lab.get_mut::<Telescope>(element).color = Color::WHITE;
    lab.tick();
    assert_eq!(children(&lab), first);
    // Tube and collar, but neither rod nor seats.
    let other = paints(&lab)
        .iter()
        .zip(&paint)
        .filter(|(a, b)| a != b)
        .count();
    assert_eq!(other, 2);
    lab.get_mut::<Coil>(element).set_changed();
    lab.tick();
    assert_eq!(children(&lab), first);
    lab.get_mut::<Coil>(element).turns = 5.0;
    lab.tick();
    assert_ne!(children(&lab), first);
}
