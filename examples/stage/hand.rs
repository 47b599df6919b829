//! Lets the pointer pick a body and pull it with a `MouseSpring`.

use super::{Again, Shape};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

const COLOR: Color = Color::srgb(1.0, 0.55, 0.1);

/// What the pointer holds.
#[derive(Resource, Default)]
pub struct Hand {
    grip: Option<Grip>,
    /// The [`MouseSpring`] that pulls the body.
    spring: Option<Entity>,
}

impl Hand {
    pub fn is_empty(&self) -> bool {
        self.grip.is_none()
    }
}

/// The point at which a body is held.
struct Grip {
    body: Entity,
    /// Held point in the body's frame, m.
    anchor: Vec3,
    /// Distance from the camera, m.
    distance: f32,
    /// Position of the pointer at that distance, m.
    pointer: Vec3,
}

pub fn add(app: &mut App) {
    app.init_resource::<Hand>()
        .add_systems(Update, (grab, draw).chain())
        // Within the tick, where Rapier's plugin expects entities to be spawned and despawned.
        .add_systems(FixedPreUpdate, pull);
}

/// Picks the body below the pointer when the button goes down, follows the pointer, and releases the body.
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

/// Returns the distance along a ray to a box about a transform's origin.
fn distance_to(ray: Ray3d, half: Vec3, at: &GlobalTransform) -> Option<f32> {
    let inverse = at.affine().inverse();
    let from = inverse.transform_point3(ray.origin);
    let along = inverse.transform_vector3(*ray.direction);
    let (one, other) = ((-half - from) / along, (half - from) / along);
    let (enter, leave) = (one.min(other).max_element(), one.max(other).min_element());
    (enter <= leave && enter > 0.0).then_some(enter)
}

/// Keeps the spring between pointer and body while both exist.
fn pull(
    mut hand: ResMut<Hand>,
    mut again: ResMut<Again>,
    time: Res<Time>,
    bodies: Query<&RigidBody>,
    mut springs: Query<&mut MouseSpring>,
    mut commands: Commands,
) {
    let Hand { grip, spring } = &mut *hand;
    // If the body no longer exists, the scene has restarted.
    if let Some(grip) = grip.take_if(|grip| bodies.contains(grip.body)) {
        again.leave_time(time.elapsed_secs());
        let new = MouseSpring::new(grip.body, grip.anchor, grip.pointer);
        match spring.and_then(|spring| springs.get_mut(spring).ok()) {
            Some(mut held) if held.body == grip.body => held.target = grip.pointer,
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

/// Draws a line from the pointer to the held point.
fn draw(hand: Res<Hand>, bodies: Query<&GlobalTransform>, mut gizmos: Gizmos) {
    if let Some(grip) = &hand.grip
        && let Ok(body) = bodies.get(grip.body)
    {
        let held = body.transform_point(grip.anchor);
        gizmos.line(held, grip.pointer, COLOR);
        gizmos.sphere(grip.pointer, 0.012 * grip.distance.min(5.0), COLOR);
    }
}
