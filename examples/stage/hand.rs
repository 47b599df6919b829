//! A hand that pulls bodies: critically damped springs between the pointer and what it has hold of.

use super::{Again, Shape};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// How stiff the hand is, Hz, whatever it pulls.
const FREQUENCY: f32 = 2.0;
const COLOR: Color = Color::srgb(1.0, 0.55, 0.1);

/// What the pointer has hold of.
#[derive(Resource, Default)]
pub struct Hand {
    grip: Option<Grip>,
    /// The point that follows the pointer, then the springs from there.
    made: Vec<Entity>,
}

impl Hand {
    pub fn is_empty(&self) -> bool {
        self.grip.is_none()
    }
}

/// Where a body is held.
struct Grip {
    body: Entity,
    /// In the body's frame.
    anchor: Vec3,
    /// From the eye, m.
    distance: f32,
    /// Where the pointer is at that distance.
    pointer: Vec3,
}

pub fn add(app: &mut App) {
    app.init_resource::<Hand>()
        .add_systems(Update, (grab, draw).chain())
        // Within the tick, as the engine wants to hear of all that is spawned and despawned.
        .add_systems(FixedPreUpdate, pull);
}

/// Takes the body below the pointer when the button goes down, follows it, and lets go.
pub fn grab(
    mut hand: ResMut<Hand>,
    buttons: Res<ButtonInput<MouseButton>>,
    windows: Query<&Window, With<PrimaryWindow>>,
    cameras: Query<(&Camera, &GlobalTransform)>,
    shapes: Query<(Entity, &Shape, &GlobalTransform)>,
    parents: Query<&ChildOf>,
    bodies: Query<(&RigidBody, &GlobalTransform)>,
) {
    if !buttons.pressed(MouseButton::Left) {
        hand.grip = None;
        return;
    }
    let (Ok(window), Ok((camera, eye))) = (windows.single(), cameras.single()) else {
        return;
    };
    let pointer = window.cursor_position();
    let Some(ray) = pointer.and_then(|at| camera.viewport_to_world(eye, at).ok()) else {
        return;
    };
    if buttons.just_pressed(MouseButton::Left) {
        let body_of = |shape| {
            std::iter::once(shape)
                .chain(parents.iter_ancestors(shape))
                .find(|e| bodies.get(*e).is_ok_and(|(b, _)| *b == RigidBody::Dynamic))
        };
        let nearest = shapes
            .iter()
            .filter_map(|(entity, shape, at)| {
                Some((body_of(entity)?, distance_to(ray, shape.half_size(), at)?))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        hand.grip = nearest.and_then(|(body, distance)| {
            let at = bodies.get(body).ok()?.1;
            let pointer = ray.get_point(distance);
            Some(Grip {
                body,
                anchor: at.affine().inverse().transform_point3(pointer),
                distance,
                pointer,
            })
        });
    }
    if let Some(grip) = &mut hand.grip {
        grip.pointer = ray.get_point(grip.distance);
    }
}

/// How far along a ray a box about a transform's origin begins.
fn distance_to(ray: Ray3d, half: Vec3, at: &GlobalTransform) -> Option<f32> {
    let inverse = at.affine().inverse();
    let from = inverse.transform_point3(ray.origin);
    let along = inverse.transform_vector3(*ray.direction);
    let (one, other) = ((-half - from) / along, (half - from) / along);
    let (enter, leave) = (one.min(other).max_element(), one.max(other).min_element());
    (enter <= leave && enter > 0.0).then_some(enter)
}

/// Keeps the springs between pointer and body, as long as both are there.
fn pull(
    mut hand: ResMut<Hand>,
    mut again: ResMut<Again>,
    time: Res<Time>,
    bodies: Query<&RigidBody>,
    mut points: Query<&mut Transform, Without<RigidBody>>,
    mut commands: Commands,
) {
    if hand
        .grip
        .as_ref()
        .is_some_and(|grip| !bodies.contains(grip.body))
    {
        // The scene has started again.
        hand.grip = None;
    }
    let Hand { grip, made } = &mut *hand;
    let Some(grip) = grip else {
        for entity in made.drain(..) {
            commands.entity(entity).try_despawn();
        }
        return;
    };
    again.leave_time(time.elapsed_secs());
    if let Some(mut point) = made.first().and_then(|point| points.get_mut(*point).ok()) {
        point.translation = grip.pointer;
        return;
    }
    let point = commands
        .spawn(Transform::from_translation(grip.pointer))
        .id();
    // One along each axis: what is pulled does not swing to the side either.
    let springs = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
        let spring = (
            SpringDamper::new(point, grip.body).with_rest_length(0.0),
            SpringTuning::frequency(FREQUENCY, 1.0),
            SpringAxis::World(axis),
            Anchors::new(Vec3::ZERO, grip.anchor),
        );
        commands.spawn(spring).id()
    });
    *made = vec![point, springs[0], springs[1], springs[2]];
}

/// A line from the pointer to where the body is held.
fn draw(hand: Res<Hand>, bodies: Query<&GlobalTransform>, mut gizmos: Gizmos) {
    if let Some(grip) = &hand.grip
        && let Ok(body) = bodies.get(grip.body)
    {
        let held = body.transform_point(grip.anchor);
        gizmos.line(held, grip.pointer, COLOR);
        gizmos.sphere(grip.pointer, 0.012 * grip.distance.min(5.0), COLOR);
    }
}
