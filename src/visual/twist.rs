//! Spirals of torsion elements: spawns their parts, turns them with the bodies, and winds them up.

use super::bodies::Bodies;
use super::layout::nothing;
use super::made::Maker;
use super::place::SELDOM;
use super::shapes::{Finish, Shapes};
use super::spiral;
use super::torsion_coil::TorsionCoil;
use super::views::{Cameras, Views};
use crate::element::{TorsionDamper, TorsionSpring, TorsionSpringDamper};
use crate::readout::SpringReadout;
use bevy::asset::{Assets, Handle};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{Collider, ColliderScale};
use std::f32::consts::TAU;

/// Size of what a spiral turns, if it cannot be measured, m.
const SIZE: f32 = 0.5;
/// Fineness of a round shape that is scaled unevenly, as in Rapier's plugin.
const SUBDIVISIONS: u32 = 10;
/// Number of strips that are kept before the first search for unused ones. A spring that swings shows the same few
/// again.
const KEPT_STRIPS: usize = 256;

/// Where the spiral of an element is.
#[derive(Component, Clone, Copy, Debug, Default)]
// Computed again for a copy of the entity, and not stored in scenes.
#[component(clone_behavior = Ignore)]
pub struct Twist {
    /// The spiral in metres; `None` while it is not drawn.
    coil: Option<TorsionCoil>,
    /// Size of what the spiral turns, when first drawn, m.
    first: Option<f32>,
    /// The pose from which `places` were computed.
    from: Option<Pose>,
    /// Transforms of the parts in the world, in the order of [`Winding`]. `None` before they are first known, and for what is no
    /// torsion element any more: then the parts have no size.
    places: Option<[GlobalTransform; 3]>,
    step: i32,
    /// Whether some part of it was in some view in the last frame, even if only for its shadow.
    shows: bool,
}

/// What the places of the parts are computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    /// Rotation of end A's body.
    rotation: Quat,
    center: Vec3,
    axis: Vec3,
    /// Twist of body B against body A, rad.
    angle: f32,
    /// Twist without moment, rad.
    rest: f32,
}

/// Parts of a spiral, in the order of [`Twist::places`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Winding {
    Strip,
    Arbor,
    /// The pin at the outer end.
    Pin,
}

/// The twist step that a strip shows.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Wound(i32);

/// The components that say what a torsion element connects.
#[derive(QueryData)]
pub(super) struct Turn {
    spring: Option<&'static TorsionSpring>,
    damper: Option<&'static TorsionDamper>,
    pair: Option<&'static TorsionSpringDamper>,
    readout: Option<&'static SpringReadout>,
}

impl TurnItem<'_, '_> {
    /// Returns both ends, the axis, and the rest angle. A damper has none, and is drawn as if it were 0. `None` for a spring
    /// whose rest angle will be the angle in its first step.
    fn element(&self) -> Option<(Entity, Entity, Vec3, Option<f32>)> {
        if let Some(s) = self.spring {
            Some((s.body_a, s.body_b, s.axis, s.rest_angle))
        } else if let Some(p) = self.pair {
            Some((p.body_a, p.body_b, p.axis, p.rest_angle))
        } else {
            let d = self.damper?;
            Some((d.body_a, d.body_b, d.axis, Some(0.0)))
        }
    }
}

/// Where bodies are in this frame.
#[derive(SystemParam)]
pub(super) struct Turns<'w, 's> {
    bodies: Bodies<'w, 's>,
    globals: Query<'w, 's, &'static GlobalTransform, Without<Winding>>,
    children: Query<'w, 's, &'static Children>,
    colliders: Query<'w, 's, (&'static Collider, Option<&'static ColliderScale>)>,
}

impl Turns<'_, '_> {
    fn pose(&self, turn: &TurnItem, center: Vec3) -> Option<Pose> {
        let (a, b, axis, rest) = turn.element()?;
        let axis = axis.try_normalize()?;
        let center = self.globals.get(a).ok()?.transform_point(center);
        let facing = |end| Some(self.globals.get(self.bodies.of(end)).ok()?.rotation());
        let (rotation, other) = (facing(a)?, facing(b)?);
        let between = rotation.inverse() * other;
        let twist = 2.0 * between.xyz().dot(axis).atan2(between.w);
        // The drawn pose may lie between two steps, so only the number of full turns is taken from the readout.
        let full = turn.readout.map_or(0.0, |r| r.length);
        let angle = twist + TAU * ((full - twist) / TAU).round();
        let pose = Pose {
            rotation,
            center,
            axis,
            angle,
            rest: rest.unwrap_or(angle),
        };
        let is_finite = rotation.is_finite() && center.is_finite() && pose.angle.is_finite();
        (is_finite && pose.rest.is_finite()).then_some(pose)
    }

    /// Size of what the element turns, m.
    fn size(&self, turn: &TurnItem, pose: &Pose) -> Option<f32> {
        let (_, end, ..) = turn.element()?;
        let body = self.bodies.of(end);
        let at = self.globals.get(body).ok()?;
        let mut size = at.translation().distance(pose.center);
        let mut of_body = vec![body];
        while let Some(entity) = of_body.pop() {
            let below = self.children.get(entity).into_iter().flatten();
            of_body.extend(below.filter(|child| self.bodies.of(**child) == body));
            let (Ok((collider, scale)), Ok(at)) =
                (self.colliders.get(entity), self.globals.get(entity))
            else {
                continue;
            };
            let scale = match scale {
                Some(ColliderScale::Absolute(scale)) => *scale,
                Some(ColliderScale::Relative(scale)) => *scale * at.scale(),
                None => at.scale(),
            };
            // Rapier's plugin scales the shape only in the first tick, which may be after the first frame.
            let mut collider = collider.clone();
            collider.set_scale(scale, SUBDIVISIONS);
            let bounds = collider.raw.compute_local_bounding_sphere();
            let middle = at.translation() + at.rotation() * bounds.center;
            size = size.max(middle.distance(pose.center) + bounds.radius);
        }
        let is_known = size.is_finite() && size > 1e-3;
        Some(if is_known { size } else { SIZE })
    }
}

/// Meshes of strips at whole twist steps, so that equal springs share them.
#[derive(Resource)]
pub(super) struct Spirals {
    meshes: HashMap<([u32; 5], bool, i32), Handle<Mesh>>,
    room: usize,
}

impl Default for Spirals {
    fn default() -> Self {
        Self {
            meshes: HashMap::default(),
            room: KEPT_STRIPS,
        }
    }
}

impl Spirals {
    fn strip(&mut self, coil: &TorsionCoil, step: i32, meshes: &mut Assets<Mesh>) -> Handle<Mesh> {
        let sizes = [
            coil.radius,
            coil.arbor_radius,
            coil.width,
            coil.thickness,
            coil.turns,
        ];
        let key = (sizes.map(f32::to_bits), spiral::hand(coil) > 0.0, step);
        if !self.meshes.contains_key(&key) && self.meshes.len() >= self.room {
            self.meshes.retain(|_, mesh| super::shapes::is_used(mesh));
            self.room = KEPT_STRIPS.max(2 * self.meshes.len());
        }
        let make = || meshes.add(spiral::mesh(coil, step));
        self.meshes.entry(key).or_insert_with(make).clone()
    }
}

/// Spawns, replaces and removes the parts of spirals.
pub(super) fn wind(
    changed: Query<Entity, Changed<TorsionCoil>>,
    mut removed: RemovedComponents<TorsionCoil>,
    mut enabled: RemovedComponents<Disabled>,
    mut elements: Query<(Turn, Option<&TorsionCoil>, &mut Twist)>,
    turns: Turns,
    mut waiting: Local<Vec<Entity>>,
    mut shapes: ResMut<Shapes>,
    mut spirals: ResMut<Spirals>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut maker: Maker<Winding>,
) {
    waiting.extend(&changed);
    waiting.extend(removed.read());
    // Its looks may have changed while it was disabled.
    waiting.extend(enabled.read().filter(|element| elements.contains(*element)));
    waiting.sort_unstable();
    waiting.dedup();
    waiting.retain(|&element| {
        let Ok((turn, coil, mut twist)) = elements.get_mut(element) else {
            return false;
        };
        // Sizes may depend on where the bodies are, so the bodies must exist.
        let center = coil.map_or(Vec3::ZERO, |coil| coil.center);
        let known = turns
            .pose(&turn, center)
            .filter(|pose| pose.center.is_finite());
        let size = known.and_then(|pose| turns.size(&turn, &pose));
        if coil.is_some_and(|coil| coil.center.is_finite()) && size.is_none() {
            return true;
        }
        maker.clear(element);
        twist.from = None;
        twist.coil = None;
        let Some(coil) = coil else {
            return false;
        };
        let first = twist.first.or(size);
        let coil = coil.at(first.unwrap_or(SIZE));
        if let Err(wrong) = coil.check() {
            log::warn!("{element}: TorsionCoil: {wrong}; it is not drawn until that is mended");
            return false;
        }
        twist.first = first;
        twist.coil = Some(coil);
        twist.step = 0;
        let strip = spirals.strip(&coil, 0, &mut meshes);
        let round = shapes.cylinder(&mut meshes);
        let paint = shapes.paint(coil.color, Finish::Enamel, &mut materials);
        let steel = shapes.paint(super::parts::STEEL, Finish::Steel, &mut materials);
        let steel = (Mesh3d(round), MeshMaterial3d(steel));
        maker.make(element, Winding::Arbor, steel.clone());
        maker.make(element, Winding::Pin, steel);
        let strip = (Wound(0), Mesh3d(strip), MeshMaterial3d(paint));
        maker.make(element, Winding::Strip, strip);
        false
    });
}

impl Twist {
    /// Updates the places of the parts from the bodies; returns whether anything has moved.
    fn follow(&mut self, coil: &TorsionCoil, pose: Pose) -> bool {
        if self.from == Some(pose) {
            return false;
        }
        self.from = Some(pose);
        let hand = spiral::hand(coil);
        let twist = pose.angle - pose.rest;
        self.step = spiral::step(coil, hand * twist);
        // The inner end stays with body A, and the outer end goes around with body B exactly.
        let side = pose.axis.any_orthonormal_vector();
        let outer = Quat::from_axis_angle(pose.axis, hand * TAU * coil.turns + twist) * side;
        let axis = Vec3A::from(pose.rotation * pose.axis).normalize();
        let outer = Vec3A::from(pose.rotation * outer);
        let outer = (outer - axis * outer.dot(axis)).normalize();
        let turned = Mat3A::from_cols(outer, axis, outer.cross(axis));
        let center = Vec3A::from(pose.center);
        let place = |at: Vec3A, radius: f32, height: f32| {
            let scale = Mat3A::from_diagonal(Vec3::new(radius, height, radius));
            GlobalTransform::from(Affine3A {
                matrix3: turned * scale,
                translation: at,
            })
        };
        let pin = (1.5 * coil.thickness).min(0.5 * coil.width);
        self.places = Some([
            place(center, 1.0, 1.0),
            place(center, coil.arbor_radius, 1.5 * coil.width),
            place(center + coil.radius * outer, pin, 1.3 * coil.width),
        ]);
        true
    }
}

/// Turns spirals with their bodies.
pub(super) fn turn(
    mut elements: Query<(Entity, Turn, &mut Twist)>,
    turns: Turns,
    cameras: Query<Cameras, Without<Winding>>,
    mut views: Local<Views>,
    mut frame: Local<u32>,
) {
    if elements.is_empty() {
        return;
    }
    views.update(cameras.iter());
    *frame = frame.wrapping_add(1);
    for (element, turn, mut twist) in &mut elements {
        let Some(coil) = twist.coil else {
            continue;
        };
        let is_element = turn.element().is_some();
        let twist = twist.bypass_change_detection();
        let Some(pose) = turns.pose(&turn, coil.center) else {
            // Parts of an element stay where they were.
            if !is_element {
                (twist.from, twist.places) = (None, None);
            }
            continue;
        };
        // `lay` sets it again in this frame.
        let shows = std::mem::take(&mut twist.shows);
        if twist.from == Some(pose) {
            continue;
        }
        let has_turn = element
            .index_u32()
            .wrapping_add(*frame)
            .is_multiple_of(SELDOM);
        let reach = 1.1 * coil.radius + coil.width;
        let is_seen = views.sight(pose.center.into(), reach).seen;
        if is_seen || shows || has_turn || twist.from.is_none() {
            twist.follow(&coil, pose);
        }
    }
}

/// Places the parts, and changes the mesh of a strip whose twist step has changed.
pub(super) fn lay(
    mut elements: Query<&mut Twist>,
    mut parts: Query<(
        &Winding,
        &ChildOf,
        &mut GlobalTransform,
        Option<&ViewVisibility>,
    )>,
    mut strips: Query<(&ChildOf, &mut Mesh3d, &mut Wound)>,
    mut spirals: ResMut<Spirals>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    for (part, parent, mut global, visibility) in &mut parts {
        if let Ok(mut twist) = elements.get_mut(parent.parent()) {
            if visibility.is_some_and(|visibility| visibility.get()) {
                twist.bypass_change_detection().shows = true;
            }
            // `GlobalTransform` is written, because propagation has run and rendering reads it. A part that has not
            // moved must not look changed, or it would be sent to the graphics card again.
            let place = twist.places.map(|places| places[*part as usize]);
            global.set_if_neq(place.unwrap_or_else(nothing));
        }
    }
    for (parent, mut mesh, mut wound) in &mut strips {
        if let Ok(twist) = elements.get(parent.parent())
            && let Some(coil) = twist.coil
            && wound.0 != twist.step
        {
            wound.0 = twist.step;
            mesh.0 = spirals.strip(&coil, twist.step, &mut meshes);
        }
    }
}
