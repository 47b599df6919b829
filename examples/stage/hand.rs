//! A hand that pulls bodies: the pointer picks one, and a `MouseSpring` pulls it.

use super::{Again, Shape};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const COLOR: Color = Color::srgb(1.0, 0.55, 0.1);

/// What the pointer has hold of.
#[derive(Resource, Default)]
pub struct Hand {
    grip: Option<Grip>,
    /// The [`MouseSpring`] that pulls it.
    spring: Option<Entity>,
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

/// Keeps the spring between pointer and body, as long as both are there.
fn pull(
    mut hand: ResMut<Hand>,
    mut again: ResMut<Again>,
    time: Res<Time>,
    bodies: Query<&RigidBody>,
    mut springs: Query<&mut MouseSpring>,
    mut commands: Commands,
) {
    let Hand { grip, spring } = &mut *hand;
    // Where there is none any more, the scene has started again.
    if let Some(grip) = grip.take_if(|grip| bodies.contains(grip.body)) {
        again.leave_time(time.elapsed_secs());
        let new = MouseSpring::new(grip.body, grip.anchor, grip.pointer);
        match spring.and_then(|spring| springs.get_mut(spring).ok()) {
            Some(mut held) => *held = new,
            None => *spring = Some(commands.spawn(new).id()),
        }
        hand.grip = Some(grip);
    } else {
        hand.grip = None;
        if let Some(spring) = hand.spring.take() {
            commands.entity(spring).try_despawn();
        }
    }
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
