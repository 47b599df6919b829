//! A resting element is not updated. Is it still drawn correctly after something other than its ends has changed?

use crate::harness::*;
use crate::visual_data::{lab, parts};
use bevy::camera::{Camera, ComputedCameraValues, Projection, RenderTargetInfo};
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::collections::HashSet;

/// A coil from the origin to one metre above it, which has rested for a while.
pub struct Rest {
    pub lab: Lab,
    pub a: Entity,
    pub b: Entity,
    pub element: Entity,
    pub coil: Entity,
}

impl Rest {
    pub fn new() -> Self {
        let mut lab = lab();
        let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
        let element = lab.spawn((Spring::new(a, b), Coil::default()));
        lab.run(0.2);
        let coil = lab.get::<Children>(element)[0];
        Self {
            lab,
            a,
            b,
            element,
            coil,
        }
    }

    /// Whether the coil is drawn from one point to the other.
    pub fn goes(&self, from: Vec3, to: Vec3) -> bool {
        let at = self.lab.get::<GlobalTransform>(self.coil);
        at.transform_point(Vec3::ZERO).distance(from) < 1e-5
            && at.transform_point(Vec3::Y).distance(to) < 1e-5
    }

    pub fn insert(&mut self, entity: Entity, bundle: impl Bundle) {
        self.lab.app.world_mut().entity_mut(entity).insert(bundle);
    }

    pub fn remove<B: Bundle>(&mut self, entity: Entity) {
        self.lab.app.world_mut().entity_mut(entity).remove::<B>();
    }
}

#[derive(Resource, Default)]
struct Sent(usize);

#[test]
fn what_rests_is_not_sent_to_the_graphics_card_again() {
    let mut rest = Rest::new();
    let count = |sent: Query<(), (With<Mesh3d>, Changed<GlobalTransform>)>,
                 mut count: ResMut<Sent>| count.0 += sent.iter().count();
    rest.lab
        .app
        .init_resource::<Sent>()
        .add_systems(Last, count);
    rest.lab.tick();
    let before = rest.lab.app.world().resource::<Sent>().0;
    rest.lab.run(0.5);
    assert_eq!(rest.lab.app.world().resource::<Sent>().0, before);
    rest.lab.get_mut::<Transform>(rest.b).translation.y = 1.1;
    rest.lab.tick();
    assert_eq!(rest.lab.app.world().resource::<Sent>().0, before + 1);
}

#[test]
fn a_part_that_somebody_moves_is_put_back() {
    let mut rest = Rest::new();
    *rest.lab.get_mut::<GlobalTransform>(rest.coil) = GlobalTransform::from_xyz(3.0, 4.0, 5.0);
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    rest.lab.get_mut::<Transform>(rest.coil).translation.x = 2.0;
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    rest.lab.get_mut::<Transform>(rest.element).translation.x = 2.0;
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    let wrong = Mesh3d::default();
    let right = rest.lab.get::<Mesh3d>(rest.coil).clone();
    rest.insert(rest.coil, wrong);
    rest.lab.tick();
    assert_eq!(*rest.lab.get::<Mesh3d>(rest.coil), right);
}

#[test]
fn other_anchors_other_ends_and_other_elements_are_followed() {
    let mut rest = Rest::new();
    rest.insert(rest.element, Anchors::new(Vec3::X, Vec3::X));
    rest.lab.tick();
    assert!(rest.goes(Vec3::X, Vec3::new(1.0, 1.0, 0.0)));
    rest.remove::<Anchors>(rest.element);
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    let other = rest.lab.point(Vec3::Z);
    rest.lab.run(0.1);
    rest.lab.get_mut::<Spring>(rest.element).body_b = other;
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, Vec3::Z));
    rest.remove::<Spring>(rest.element);
    rest.insert(rest.element, Damper::new(rest.b, rest.a));
    rest.lab.tick();
    assert!(rest.goes(Vec3::Y, Vec3::ZERO));
}

#[test]
fn without_an_end_a_coil_stays_and_with_it_back_is_right_again() {
    let mut rest = Rest::new();
    rest.remove::<GlobalTransform>(rest.b);
    rest.lab.run(0.1);
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    rest.insert(rest.b, Transform::from_xyz(0.0, 2.0, 0.0));
    rest.insert(rest.b, GlobalTransform::from_xyz(0.0, 2.0, 0.0));
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, 2.0 * Vec3::Y));
}

#[test]
fn without_an_end_all_parts_stay_as_large_as_they_are_wherever_their_element_goes() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::X), lab.point(Vec3::new(1.0, 0.5, 0.0)));
    let cart = lab.spawn((Transform::default(), Visibility::default()));
    let damper = (Damper::new(a, b), Telescope::default(), ChildOf(cart));
    let element = lab.spawn(damper);
    lab.run(0.1);
    let before = parts(&lab, element);
    assert!(!before.is_empty());
    lab.app.world_mut().despawn(b);
    for i in 1..10 {
        lab.get_mut::<Transform>(cart).translation.z = 0.1 * i as f32;
        lab.tick();
        assert_eq!(parts(&lab, element), before, "frame {i}");
    }
}

#[test]
fn parts_of_an_element_that_never_had_an_end_have_no_size() {
    let mut lab = lab();
    let (a, nobody) = (lab.point(Vec3::X), lab.spawn(()));
    let element = lab.spawn((Damper::new(a, nobody), Telescope::default()));
    for _ in 0..4 {
        lab.get_mut::<Transform>(element).translation.x += 1.0;
        lab.tick();
    }
    for part in parts(&lab, element) {
        assert_eq!(part.scale(), Vec3::ZERO);
    }
}

#[test]
fn a_part_that_was_disabled_for_a_while_is_right_when_it_is_enabled() {
    let mut rest = Rest::new();
    rest.insert(rest.coil, Disabled);
    rest.lab.tick();
    rest.lab.get_mut::<Transform>(rest.b).translation.y = 1.5;
    rest.lab.run(0.2);
    rest.remove::<Disabled>(rest.coil);
    rest.lab.tick();
    assert!(rest.goes(Vec3::ZERO, 1.5 * Vec3::Y));
}

#[test]
fn a_disabled_element_is_not_drawn_and_has_its_new_looks_once_it_is_enabled() {
    let mut rest = Rest::new();
    let old = rest.lab.get::<Mesh3d>(rest.coil).clone();
    rest.insert(rest.element, Disabled);
    rest.lab.tick();
    assert_eq!(parts(&rest.lab, rest.element).len(), 0);
    rest.lab.get_mut::<Coil>(rest.element).turns = 3.0;
    rest.lab.get_mut::<Transform>(rest.b).translation.y = 1.5;
    rest.lab.run(0.2);
    rest.remove::<Disabled>(rest.element);
    rest.lab.tick();
    rest.coil = rest.lab.get::<Children>(rest.element)[0];
    assert!(rest.goes(Vec3::ZERO, 1.5 * Vec3::Y));
    assert_ne!(*rest.lab.get::<Mesh3d>(rest.coil), old);

    rest.insert(rest.element, Disabled);
    rest.lab.tick();
    rest.remove::<Coil>(rest.element);
    rest.lab.run(0.1);
    rest.remove::<Disabled>(rest.element);
    rest.lab.tick();
    assert_eq!(parts(&rest.lab, rest.element).len(), 0);
    // An element that is spawned disabled, as from a pool.
    let look = (Spring::new(rest.a, rest.b), Coil::default(), Disabled);
    let pooled = rest.lab.spawn(look);
    rest.lab.run(0.1);
    assert_eq!(parts(&rest.lab, pooled).len(), 0);
    rest.remove::<Disabled>(pooled);
    rest.lab.tick();
    assert_eq!(parts(&rest.lab, pooled).len(), 1);
}

#[test]
fn a_disabled_spiral_is_not_drawn_until_it_is_enabled() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::Y));
    let spring = TorsionSpring::new(a, b, Vec3::Z);
    let element = lab.spawn((spring, TorsionCoil::default()));
    lab.run(0.2);
    let all = parts(&lab, element).len();
    assert!(all > 0);
    lab.app.world_mut().entity_mut(element).insert(Disabled);
    lab.tick();
    assert_eq!(parts(&lab, element).len(), 0);
    lab.app.world_mut().entity_mut(element).remove::<Disabled>();
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), all);
}

#[test]
fn sizes_wait_until_the_ends_are_apart() {
    let mut lab = lab();
    let (a, b) = (lab.point(Vec3::ZERO), lab.point(Vec3::ZERO));
    let element = lab.spawn((Damper::new(a, b), Telescope::fitted()));
    lab.run(0.1);
    assert_eq!(parts(&lab, element).len(), 0);
    lab.get_mut::<Transform>(b).translation.y = 1.0;
    lab.run(0.1);
    let widths = parts(&lab, element).into_iter().map(|part| part.scale().x);
    let widest = widths.fold(0.0, f32::max);
    assert!((0.03..0.1).contains(&widest), "{widest}");
}

#[test]
fn a_skin_given_to_another_element_or_changed_follows_at_once() {
    let mut rest = Rest::new();
    let mesh = rest.lab.get::<Mesh3d>(rest.coil).clone();
    let skin = (SpringSkin { length: 1.0 }, mesh, ChildOf(rest.element));
    rest.coil = rest.lab.spawn(skin);
    let (a, b) = (
        rest.lab.point(Vec3::X),
        rest.lab.point(Vec3::new(1.0, 2.0, 0.0)),
    );
    let other = rest.lab.spawn((Spring::new(a, b), Coil::default()));
    rest.lab.run(0.1);
    assert!(rest.goes(Vec3::ZERO, Vec3::Y));
    rest.insert(rest.coil, ChildOf(other));
    rest.lab.tick();
    let top = Vec3::new(1.0, 2.0, 0.0);
    assert!(rest.goes(Vec3::X, top));
    rest.lab.run(0.1);
    rest.lab.get_mut::<SpringSkin>(rest.coil).length = 0.5;
    rest.lab.tick();
    assert!(rest.goes(Vec3::X, top + 2.0 * Vec3::Y), "twice as long now");
}

/// A camera with the computed values that a renderer would give it.
pub fn look(lab: &mut Lab, at: Transform) -> Entity {
    let projection = Projection::default();
    let computed = ComputedCameraValues {
        clip_from_view: projection.get_clip_from_view(),
        target_info: Some(RenderTargetInfo {
            physical_size: UVec2::new(1920, 1080),
            scale_factor: 1.0,
        }),
        ..default()
    };
    let frustum = projection.compute_frustum(&GlobalTransform::from(at));
    let camera = Camera {
        computed,
        ..default()
    };
    lab.spawn((camera, projection, frustum, at))
}

/// Puts a camera elsewhere, as a game does between two frames.
pub fn turn(lab: &mut Lab, camera: Entity, at: Transform) {
    let frustum = lab
        .get::<Projection>(camera)
        .compute_frustum(&GlobalTransform::from(at));
    lab.app.world_mut().entity_mut(camera).insert((at, frustum));
}

#[test]
fn out_of_sight_it_is_laid_seldom_and_is_right_soon_after_it_stops() {
    let mut rest = Rest::new();
    let ahead = Transform::from_xyz(0.0, 0.5, 10.0);
    let away = ahead.looking_to(Vec3::Z, Vec3::Y);
    let camera = look(&mut rest.lab, away);
    rest.lab.run(0.2);
    let mut places = HashSet::new();
    for i in 0..16 {
        rest.lab.get_mut::<Transform>(rest.a).translation.y = -0.01 * i as f32;
        rest.lab.tick();
        let at = parts(&rest.lab, rest.element)[0];
        places.insert(at.translation().y.to_bits());
    }
    assert!((2..=3).contains(&places.len()), "{} times", places.len());
    // 0.2 s after its last move.
    rest.lab.run(0.2);
    assert!(rest.goes(-0.15 * Vec3::Y, Vec3::Y));

    // When a camera turns to it, it is right at once.
    rest.lab.get_mut::<Transform>(rest.a).translation.y = -0.5;
    rest.lab.tick();
    turn(&mut rest.lab, camera, ahead);
    rest.lab.tick();
    assert!(rest.goes(-0.5 * Vec3::Y, Vec3::Y));
}

#[test]
fn out_of_sight_but_with_a_shadow_in_the_picture_it_is_laid_in_every_frame() {
    let mut rest = Rest::new();
    let away = Transform::from_xyz(0.0, 0.5, 10.0).looking_to(Vec3::Z, Vec3::Y);
    look(&mut rest.lab, away);
    rest.lab.run(0.2);
    for i in 0..16 {
        // The renderer marks a part like this when the view of a light sees it.
        rest.insert(rest.coil, ViewVisibility::VISIBLE);
        let low = -0.01 * i as f32 * Vec3::Y;
        rest.lab.get_mut::<Transform>(rest.a).translation = low;
        rest.lab.tick();
        // The visibility is known from the frame before.
        assert!(i < 2 || rest.goes(low, Vec3::Y), "frame {i}");
    }
}

#[test]
fn what_is_made_out_of_sight_lies_where_it_should_from_its_first_frame() {
    let mut rest = Rest::new();
    let away = Transform::from_xyz(0.0, 0.5, 10.0).looking_to(Vec3::Z, Vec3::Y);
    look(&mut rest.lab, away);
    // Each frame updates other elements out of sight.
    for _ in 0..8 {
        let (a, b) = (rest.lab.point(Vec3::X), rest.lab.point(Vec3::ONE));
        let other = rest.lab.spawn((Spring::new(a, b), Coil::default()));
        rest.lab.tick();
        rest.coil = rest.lab.get::<Children>(other)[0];
        assert!(rest.goes(Vec3::X, Vec3::ONE));
    }
}

#[test]
fn a_resting_coil_gets_coarser_as_the_camera_goes_away_and_finer_as_it_comes_back() {
    let mut rest = Rest::new();
    let camera = look(&mut rest.lab, Transform::from_xyz(0.0, 0.5, 3.0));
    let mut vertices = |distance: f32| {
        let at = Transform::from_xyz(0.0, 0.5, distance);
        turn(&mut rest.lab, camera, at);
        // The visibility and the distance of an element are checked in every eighth frame.
        rest.lab.run(8.0 / 60.0);
        let mesh = rest.lab.get::<Mesh3d>(rest.coil);
        let meshes = rest.lab.app.world().resource::<Assets<Mesh>>();
        meshes.get(mesh).expect("loaded").count_vertices()
    };
    let away = [2.0, 6.0, 20.0, 60.0].map(&mut vertices);
    assert!(away.windows(2).all(|w| w[1] < w[0]), "{away:?}");
    let back = [60.0, 20.0, 6.0, 2.0].map(&mut vertices);
    assert_eq!(back, [away[3], away[2], away[1], away[0]]);
}

#[test]
fn a_picture_that_suddenly_has_other_pixels_has_the_right_detail_at_once() {
    let mut rest = Rest::new();
    let camera = look(&mut rest.lab, Transform::from_xyz(0.0, 0.5, 6.0));
    rest.lab.run(0.2);
    let mut vertices = |height: u32| {
        rest.lab.get_mut::<Camera>(camera).computed.target_info = Some(RenderTargetInfo {
            physical_size: UVec2::new(height, height),
            scale_factor: 1.0,
        });
        rest.lab.tick();
        let mesh = rest.lab.get::<Mesh3d>(rest.coil);
        let meshes = rest.lab.app.world().resource::<Assets<Mesh>>();
        meshes.get(mesh).expect("loaded").count_vertices()
    };
    for change in 0..8 {
        let [small, large] = [135, 1080].map(&mut vertices);
        assert!(small < large, "change {change}: {small}, {large}");
    }
}
