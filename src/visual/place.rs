//! Lays the parts between the ends, where the ends are drawn in this frame.

use super::heading::{Heading, upright};
use super::layout::{Layout, Part, SHORT};
use super::parts::Levels;
use super::views::{Cameras, Views, level};
use crate::element::{Anchors, Damper, Spring, SpringDamper};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::mesh::Mesh3d;
use bevy::prelude::*;

/// An element out of everyone's sight is placed every so many frames only. It may still throw a shadow
/// into the picture, so it is not left alone altogether.
const SELDOM: u32 = 8;

/// Where an element was drawn last.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Placement {
    heading: Heading,
    layout: Layout,
    /// Length when first drawn, m.
    first: Option<f32>,
    /// Level of detail.
    level: u8,
    /// Its coil has been shorter than its turns are thick, and that was said.
    squeezed: bool,
}

impl Placement {
    /// Gives an element new looks, now that its ends are this far apart.
    pub(super) fn dress(&mut self, length: f32, layout: impl FnOnce(f32) -> Layout) {
        let first = *self.first.get_or_insert(length.max(SHORT));
        self.layout = layout(first);
        self.level = 0;
        self.squeezed = false;
    }
}

/// An element as it says itself where its ends are.
#[derive(QueryData)]
pub(super) struct Line {
    spring: Option<&'static Spring>,
    damper: Option<&'static Damper>,
    pair: Option<&'static SpringDamper>,
    anchors: Option<&'static Anchors>,
}

/// Where entities are in this frame; parts, which follow, aside.
#[derive(SystemParam)]
pub(super) struct Lines<'w, 's> {
    globals: Query<'w, 's, &'static GlobalTransform, Without<Part>>,
}

impl Lines<'_, '_> {
    /// The frame of end A, and both anchors in the world.
    #[inline]
    pub fn ends(&self, line: &LineItem) -> Option<(Mat3A, Vec3A, Vec3A)> {
        let (a, b) = if let Some(spring) = line.spring {
            (spring.body_a, spring.body_b)
        } else if let Some(pair) = line.pair {
            (pair.body_a, pair.body_b)
        } else {
            let damper = line.damper?;
            (damper.body_a, damper.body_b)
        };
        let a = self.globals.get(a).ok()?.affine();
        let b = self.globals.get(b).ok()?.affine();
        let anchors = line.anchors.copied().unwrap_or_default();
        Some((
            a.matrix3,
            a.transform_point3a(anchors.a.into()),
            b.transform_point3a(anchors.b.into()),
        ))
    }
}

pub(super) fn place(
    mut elements: Query<(Entity, Line, &mut Placement, &Children)>,
    mut parts: Query<(
        &Part,
        &mut GlobalTransform,
        Option<&ViewVisibility>,
        Option<(&Levels, &mut Mesh3d)>,
    )>,
    lines: Lines,
    cameras: Query<Cameras, Without<Part>>,
    mut views: Local<Views>,
    mut frame: Local<u32>,
) {
    views.update(cameras.iter());
    *frame = frame.wrapping_add(1);
    for (element, line, mut placement, children) in &mut elements {
        let Some((matrix, from, to)) = lines.ends(&line) else {
            continue;
        };
        let between = to - from;
        let length = between.length();
        if !length.is_finite() {
            continue;
        }
        let placement = placement.bypass_change_detection();
        let layout = &placement.layout;
        let sight = views.sight(from + 0.5 * between, 0.5 * length + layout.reach());
        let turn = element
            .index_u32()
            .wrapping_add(*frame)
            .is_multiple_of(SELDOM);
        let skips = !(sight.seen || turn);

        let upright = upright(&matrix);
        if length > SHORT {
            let direction = upright.transpose() * (between / length);
            placement.heading.turn_to(direction);
        }
        let columns = placement.heading.in_frame(&upright);
        if sight.seen {
            placement.level = level(2.0 * layout.wire_radius * sight.pixels, placement.level);
        }
        if layout.span(length) < 0.98 * layout.solid && !placement.squeezed {
            placement.squeezed = true;
            log::warn!(
                "{element}: Coil: it is {} m long, but all its turns touch at {} m already, so wire \
                 passes through wire",
                layout.span(length),
                layout.solid
            );
        }

        for child in children {
            let Ok((part, mut global, visibility, levels)) = parts.get_mut(*child) else {
                continue;
            };
            // Whoever else has moved it, as transform propagation does after a change, is overruled.
            if skips && !visibility.is_some_and(|v| v.get()) && !global.is_changed() {
                continue;
            }
            let (at, scale) = layout.lay(*part, length);
            let world = Affine3A {
                matrix3: Mat3A::from_cols(
                    columns.x_axis * scale.x,
                    columns.y_axis * scale.y,
                    columns.z_axis * scale.z,
                ),
                translation: from + columns.y_axis * at,
            };
            // Its `Transform` says nothing: propagation has run, and rendering reads this one. What has
            // not moved must not look changed, or it would be sent to the graphics card again.
            global.set_if_neq(GlobalTransform::from(world));
            if let Some((levels, mut mesh)) = levels {
                let wanted = &levels.0[usize::from(placement.level)];
                if mesh.0 != *wanted {
                    mesh.0 = wanted.clone();
                }
            }
        }
    }
}
