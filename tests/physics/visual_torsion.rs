//! Does the spiral of a torsion element meet its ends at any twist, and does it cost nothing at rest?

use crate::harness::*;
use crate::messages::Log;
use crate::visual_data::{lab, parts};
use crate::visual_rest::look;
use bevy::mesh::VertexAttributeValues;
use bevy::prelude::*;
use bevy::transform::StaticTransformOptimizations;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::HashSet;
use std::f32::consts::TAU;

/// Outer radius of the spiral, m. `ARBOR` is the radius of its arbor, m.
pub const RADIUS: f32 = 0.2;
const ARBOR: f32 = 0.04;

/// A door on the axis of its frame. Only the test turns it.
pub struct Door {
    pub lab: Lab,
    pub door: Entity,
    pub element: Entity,
}

impl Door {
    pub fn new(coil: TorsionCoil) -> Self {
        let mut lab = lab();
        let frame = lab.point(Vec3::X);
        let door = lab.point(Vec3::X);
        let element = lab.spawn((
            TorsionSpring::new(frame, door, Vec3::Z).with_rest_angle(0.0),
            coil,
        ));
        lab.run(0.1);
        Self { lab, door, element }
    }

    pub fn turn(&mut self, angle: f32) {
        self.lab.get_mut::<Transform>(self.door).rotation = Quat::from_rotation_z(angle);
        // The physics plugin would write this angle. It includes full turns.
        self.lab.get_mut::<SpringReadout>(self.element).length = angle;
        self.lab.tick();
    }

    /// Inner and outer end of the strip, in world coordinates.
    pub fn ends(&self) -> [Vec3; 2] {
        let world = self.lab.app.world();
        let children = world.get::<Children>(self.element).expect("parts");
        let meshes = world.resource::<Assets<Mesh>>();
        let strip = children.iter().max_by_key(|child| {
            let mesh = world.get::<Mesh3d>(*child).expect("a mesh");
            meshes.get(mesh).map(Mesh::count_vertices)
        });
        let strip = strip.expect("parts");
        let mesh = world.get::<Mesh3d>(strip).expect("a mesh");
        let mesh = meshes.get(mesh).expect("loaded");
        let Some(VertexAttributeValues::Float32x3(all)) = mesh.attribute(Mesh::ATTRIBUTE_POSITION)
        else {
            panic!("positions");
        };
        let at = self.lab.get::<GlobalTransform>(strip);
        // The mesh consists of sections of eight vertices each, and of eight more that close the ends.
        let middle = |from: usize| {
            let ring = all[from..from + 8].iter().copied().map(Vec3::from);
            at.transform_point(ring.sum::<Vec3>() / 8.0)
        };
        [middle(0), middle(all.len() - 16)]
    }
}

#[test]
fn a_spiral_has_a_strip_an_arbor_and_a_pin_and_loses_them_with_its_component() {
    let mut door = Door::new(TorsionCoil::new(RADIUS, 4.0));
    assert_eq!(parts(&door.lab, door.element).len(), 3);
    *door.lab.get_mut::<TorsionCoil>(door.element) = TorsionCoil::new(RADIUS, 2.0);
    door.lab.run(0.1);
    assert_eq!(parts(&door.lab, door.element).len(), 3);
    let world = door.lab.app.world_mut();
    world.entity_mut(door.element).remove::<TorsionCoil>();
    door.lab.run(0.1);
    assert_eq!(parts(&door.lab, door.element).len(), 0);
}

#[test]
fn its_outer_end_goes_around_with_body_b_and_its_inner_end_stays() {
    for handedness in [Handedness::Right, Handedness::Left] {
        let coil = TorsionCoil::new(RADIUS, 4.0).with_handedness(handedness);
        let mut door = Door::new(coil);
        let [inner, outer] = door.ends();
        assert!((outer.distance(Vec3::X) - RADIUS).abs() < 1e-5);
        assert!((inner.distance(Vec3::X) - ARBOR).abs() < 1e-5);
        // To 450° and back, then from −450° to 450°.
        for degrees in (0..=450).chain(-450..=450) {
            let angle = (degrees as f32 + 0.4).to_radians();
            door.turn(angle);
            let [still, gone] = door.ends();
            let wanted = Vec3::X + Quat::from_rotation_z(angle) * (outer - Vec3::X);
            assert!(
                gone.distance(wanted) < 1e-5,
                "{degrees}: {gone}, not {wanted}"
            );
            // Strip meshes are made for whole degrees.
            let off = still.distance(inner) / ARBOR;
            assert!(off < 0.51_f32.to_radians(), "{degrees}: off by {off} rad");
        }
    }
}

#[test]
fn ends_that_are_turned_children_of_bodies_neither_tilt_nor_wind_it() {
    let mut lab = lab();
    let mut end = |turn: Quat| {
        let body = lab.spawn((RigidBody::Fixed, Transform::from_translation(Vec3::X)));
        let child = (Transform::from_rotation(turn), ChildOf(body));
        [body, lab.spawn(child)]
    };
    let [_, frame] = end(Quat::from_rotation_x(0.7));
    let [door, leaf] = end(Quat::from_rotation_y(0.4));
    let spring = TorsionSpring::new(frame, leaf, Vec3::Z).with_rest_angle(0.0);
    let element = lab.spawn((spring, TorsionCoil::new(RADIUS, 4.0)));
    lab.run(0.1);
    let mut door = Door { lab, door, element };
    let [_, outer] = door.ends();
    assert!(outer.z.abs() < 1e-5, "it is tilted: {outer}");
    for angle in [0.5, 1.5] {
        door.turn(angle);
        let [_, gone] = door.ends();
        let wanted = Vec3::X + Quat::from_rotation_z(angle) * (outer - Vec3::X);
        assert!(gone.distance(wanted) < 1e-5, "{gone}, not {wanted}");
    }
}

/// Meshes of which a renderer has received an event.
#[derive(Resource)]
struct Known(HashSet<AssetId<Mesh>>);

#[test]
fn a_renderer_hears_of_a_new_strip_in_the_frame_that_shows_it() {
    let mut door = Door::new(TorsionCoil::new(RADIUS, 4.0));
    let app = &mut door.lab.app;
    let hear = |mut news: MessageReader<AssetEvent<Mesh>>, mut known: ResMut<Known>| {
        for one in news.read() {
            if let AssetEvent::Added { id } = one {
                known.0.insert(*id);
            }
        }
    };
    let there: HashSet<_> = app.world().resource::<Assets<Mesh>>().ids().collect();
    app.insert_resource(Known(there)).add_systems(Last, hear);
    for step in 1..=300 {
        // Three degrees per frame, so every frame shows a new strip.
        door.turn((3.0 * step as f32).to_radians());
        let world = door.lab.app.world();
        let known = &world.resource::<Known>().0;
        for part in world.get::<Children>(door.element).expect("parts") {
            let mesh = world.get::<Mesh3d>(*part).expect("a mesh");
            assert!(known.contains(&mesh.id()), "frame {step}");
        }
    }
    assert!(door.lab.app.world().resource::<Known>().0.len() > 300);
}

#[test]
fn a_twist_by_the_hand_winds_it_up_and_one_against_it_unwinds_it() {
    for (handedness, wound) in [(Handedness::Right, true), (Handedness::Left, false)] {
        let mut door = Door::new(TorsionCoil::new(RADIUS, 3.0).with_handedness(handedness));
        let size = |door: &Door| {
            let world = door.lab.app.world();
            let meshes = world.resource::<Assets<Mesh>>();
            let children = world.get::<Children>(door.element).expect("parts");
            let counts = children.iter().filter_map(|child| {
                let mesh = meshes.get(world.get::<Mesh3d>(child)?)?;
                Some(mesh.count_vertices())
            });
            counts.max().expect("parts")
        };
        let rest = size(&door);
        door.turn(TAU);
        assert_eq!(size(&door) > rest, wound, "{handedness:?}");
    }
}

#[derive(Resource, Default)]
struct Sent(usize);

#[test]
fn at_rest_nothing_of_it_is_sent_to_the_graphics_card_again() {
    let mut door = Door::new(TorsionCoil::default());
    type Renewed = Or<(Changed<GlobalTransform>, Changed<Mesh3d>)>;
    let count = |sent: Query<(), (With<Mesh3d>, Renewed)>, mut count: ResMut<Sent>| {
        count.0 += sent.iter().count();
    };
    door.lab
        .app
        .init_resource::<Sent>()
        // As Bevy does by default; otherwise it renews the places of all children in each frame.
        .insert_resource(StaticTransformOptimizations::Enabled)
        .add_systems(Last, count);
    door.lab.tick();
    let sent = |door: &Door| door.lab.app.world().resource::<Sent>().0;
    let before = sent(&door);
    door.lab.run(0.5);
    assert_eq!(sent(&door), before);
    door.turn(0.002);
    // Three parts change: the strip, its pin, and the arbor, which keeps its mesh but turns.
    assert_eq!(sent(&door), before + 3);
}

#[test]
fn out_of_sight_but_with_a_shadow_in_the_picture_it_is_turned_in_every_frame() {
    let mut door = Door::new(TorsionCoil::new(RADIUS, 4.0));
    let [_, rest] = door.ends();
    let away = Transform::from_xyz(0.0, 0.0, 10.0).looking_to(Vec3::Z, Vec3::Y);
    look(&mut door.lab, away);
    door.lab.run(0.2);
    let drawn: Vec<Entity> = door.lab.get::<Children>(door.element).to_vec();
    for i in 0..16 {
        for part in &drawn {
            // The renderer marks a part like this when the view of a light sees it.
            let mut part = door.lab.app.world_mut().entity_mut(*part);
            part.insert(ViewVisibility::VISIBLE);
        }
        let angle = 0.1 * i as f32;
        door.turn(angle);
        let [_, outer] = door.ends();
        let wanted = Vec3::X + Quat::from_rotation_z(angle) * (rest - Vec3::X);
        // The visibility is known from the frame before.
        assert!(i < 2 || outer.distance(wanted) < 1e-4, "frame {i}: {outer}");
    }
}

#[test]
fn springs_that_swing_alike_share_their_meshes_and_keep_few() {
    let mut lab = lab();
    let doors: Vec<Entity> = (0..20)
        .map(|i| {
            let place = Vec3::X * i as f32;
            let (frame, door) = (lab.point(place), lab.point(place));
            lab.spawn((
                TorsionSpring::new(frame, door, Vec3::Y).with_rest_angle(0.0),
                TorsionCoil::new(RADIUS, 4.0),
            ));
            door
        })
        .collect();
    for tick in 0..2_000 {
        let angle = 3.0 * (0.01 * tick as f32).sin();
        for door in &doors {
            lab.get_mut::<Transform>(*door).rotation = Quat::from_rotation_y(angle);
        }
        lab.tick();
    }
    // At most one mesh for each whole degree of the swing, and the cylinder. Unused meshes are dropped beyond a
    // bound.
    let meshes = lab.app.world().resource::<Assets<Mesh>>().len();
    assert!((2..=270).contains(&meshes), "{meshes} meshes");
}

/// Checks that a spiral about the origin has the radius for a door of this size, m.
pub fn check_size(lab: &Lab, element: Entity, size: f32) {
    let far = |at: &GlobalTransform| at.translation().length();
    // The pin is at the outer end. Sizes are rounded to a power of 1.1, so that meshes are shared.
    let radius = parts(lab, element).iter().map(far).fold(0.0, f32::max);
    assert!(
        (radius / (0.25 * size) - 1.0).abs() < 0.05,
        "{radius} for {size}"
    );
}

#[test]
fn it_is_a_quarter_as_large_as_what_it_turns() {
    for (place, collider, size) in [
        // Distance of the door from the hinge, or size of its collider, or neither.
        (Vec3::X * 0.8, None, 0.8),
        (Vec3::ZERO, Some(Collider::ball(1.2)), 1.2),
        (Vec3::ZERO, None, 0.5),
    ] {
        let mut lab = lab();
        let frame = lab.point(Vec3::ZERO);
        let door = lab.point(place);
        if let Some(collider) = collider {
            lab.app.world_mut().entity_mut(door).insert(collider);
        }
        let element = lab.spawn((
            TorsionSpring::new(frame, door, Vec3::Y).with_rest_angle(0.0),
            TorsionCoil::default(),
        ));
        lab.run(0.1);
        check_size(&lab, element, size);
    }
}

#[test]
fn it_fits_a_scaled_door_before_the_first_tick_as_after_it() {
    let ball = (Vec3::X, Quat::IDENTITY, Collider::ball(0.2));
    for (collider, scale, size) in [
        (
            Collider::cuboid(0.5, 1.0, 0.1),
            Vec3::new(1.0, 2.0, 1.0),
            Vec3::new(0.5, 2.0, 0.1).length(),
        ),
        // Off the centre of the door. Its bounding box counts.
        (
            Collider::compound(vec![ball]),
            Vec3::splat(2.0),
            2.0 + 0.4 * 3.0_f32.sqrt(),
        ),
    ] {
        for is_stepped in [false, true] {
            let mut lab = lab();
            let frame = lab.point(Vec3::ZERO);
            let door = lab.spawn((Transform::from_scale(scale), collider.clone()));
            if is_stepped {
                lab.run(0.1);
            }
            let element = lab.spawn((
                TorsionSpring::new(frame, door, Vec3::Y).with_rest_angle(0.0),
                TorsionCoil::default(),
            ));
            lab.app.world_mut().run_schedule(PostUpdate);
            check_size(&lab, element, size);
        }
    }
}

#[test]
fn a_spiral_whose_center_was_wrong_fits_once_it_is_mended() {
    let mut lab = lab();
    let (frame, door) = (lab.point(Vec3::ZERO), lab.point(Vec3::X * 2.0));
    let element = lab.spawn((
        TorsionSpring::new(frame, door, Vec3::Y).with_rest_angle(0.0),
        TorsionCoil::default().with_center(Vec3::NAN),
    ));
    lab.run(0.1);
    assert!(parts(&lab, element).is_empty());
    lab.get_mut::<TorsionCoil>(element).center = Vec3::ZERO;
    lab.run(0.1);
    check_size(&lab, element, 2.0);
}

#[test]
fn spirals_that_cannot_be_drawn_or_stand_on_a_linear_element_are_told_once() {
    let log = Log::capture();
    let mut lab = lab();
    let (a, b) = (lab.body(1.0, Vec3::ZERO), lab.body(1.0, Vec3::X));
    let torsion = TorsionSpring::new(a, b, Vec3::Y);
    let endless = lab.spawn((torsion, TorsionCoil::new(f32::NAN, 4.0)));
    let tight = lab.spawn((torsion, TorsionCoil::new(0.2, 50.0)));
    let nowhere = TorsionCoil::default().with_center(Vec3::splat(f32::INFINITY));
    let nowhere = lab.spawn((torsion, nowhere));
    let linear = lab.spawn((Spring::new(a, b), TorsionCoil::default()));
    let lone = lab.spawn(TorsionCoil::default());
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 5, "{told:?}");
    for (entity, what) in [
        (endless, "TorsionCoil: radius is NaN"),
        (tight, "50 turns of thickness"),
        (nowhere, "TorsionCoil: center is"),
        (linear, "TorsionCoil cannot draw a linear element"),
        (lone, "TorsionCoil on an entity without an element"),
    ] {
        let named = format!("{entity}: ");
        assert!(
            told.iter().any(|t| t.contains(&named) && t.contains(what)),
            "{told:?} say nothing of {what}"
        );
    }
    *lab.get_mut::<TorsionCoil>(tight) = TorsionCoil::default();
    lab.run(0.1);
    assert_eq!(parts(&lab, tight).len(), 3);
    assert!(parts(&lab, endless).is_empty());
}
