//! Finds where every element is in this frame, and what of it is worth drawing there.

use super::heading::{Heading, upright};
use super::layout::{Layout, Part, SHORT};
use super::views::{Cameras, Views, level};
use crate::element::{Anchors, Damper, Spring, SpringDamper, WorldAnchors};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{Mat3A, Vec3A};
use bevy::prelude::*;

/// Number of frames in which an element that no camera sees is placed once, and a spiral turned once unless its shadow is in a
/// picture. Elements out of sight are not left alone altogether, because they may come to cast a shadow into the picture.
///
/// The visibility and the level of detail of an element in sight are updated as seldom. In between, the element may be drawn a
/// little too finely or too coarsely. After it has gone out of sight, it may be placed in vain. If the views jump, all elements
/// are updated in that frame. If a view is cut to another place, elements in sight are updated where that changes their size in
/// pixels.
pub(super) const SELDOM: u32 = 8;

/// Where an element is drawn.
#[derive(Component, Clone, Copy, Debug, Default)]
// Computed again for a copy of the entity, and not stored in scenes.
#[component(clone_behavior = Ignore)]
pub struct Placement {
    pub(super) due: Due,
    /// Level of detail.
    pub(super) level: u8,
    /// How far a view may move in one frame before the level must be updated, m.
    room: f32,
    /// Whether a warning was logged that the coil is shorter than all its turns are thick.
    squeezed: bool,
    /// Whether the element was in sight when that was last checked.
    pub(super) seen: bool,
    /// Whether some part of it was in some view in the last frame, even if only for its shadow.
    pub(super) shows: bool,
    /// The state of the views for which `seen` and `level` are right.
    looked: Option<u32>,
    /// Distance from end to end, m.
    pub(super) length: f32,
    /// Unit vector along the element, in the world. Zero until it is first known where the ends are.
    pub(super) axis: Vec3A,
    /// Unit vector across the element, in the world.
    pub(super) side: Vec3A,
    pub(super) ends: Ends,
    pub(super) layout: Layout,
    heading: Heading,
    /// Length when first drawn, m.
    first: Option<f32>,
}

/// Which parts of an element must be placed again in this frame. Parts that other code has changed are placed as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Due {
    /// No parts: it is not known where the ends are. Parts stay where they were placed last. Before that they have no size.
    #[default]
    Nowhere,
    /// No parts: all are where they should be.
    Laid,
    /// No parts: none was seen before, so the placement was not updated. It is updated in the frame after one is seen.
    Hidden,
    /// The parts that were seen in the last frame.
    Visible,
    /// All parts.
    All,
}

/// What a placement is computed from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    /// X axis of end A in the world, scaled as end A is.
    x: Vec3A,
    /// Y axis of end A in the world, scaled as end A is.
    y: Vec3A,
    /// Anchor of end A in the world.
    pub from: Vec3A,
    /// Anchor of end B in the world.
    pub to: Vec3A,
}

impl Ends {
    /// Rotation of end A.
    #[inline]
    pub fn turn(&self) -> Mat3A {
        upright(self.x, self.y)
    }

    /// Whether both are the same, computed without a branch.
    #[inline]
    fn are(&self, other: &Self) -> bool {
        let same = self.from.cmpeq(other.from)
            & self.to.cmpeq(other.to)
            & self.x.cmpeq(other.x)
            & self.y.cmpeq(other.y);
        same.all()
    }
}

impl Placement {
    /// Sets the layout of new looks.
    pub(super) fn dress(&mut self, layout: Layout) {
        self.layout = layout;
        self.level = 0;
        self.squeezed = false;
        self.seen = false;
        self.recall();
    }

    /// Whether the element has been drawn before, so that its sizes are known.
    pub(super) fn is_drawn(&self) -> bool {
        self.first.is_some()
    }

    /// Length when first drawn, m. If the element was not drawn before, it is `length`.
    pub(super) fn first(&mut self, length: f32) -> f32 {
        *self.first.get_or_insert(length.max(SHORT))
    }

    /// Length when first drawn, m, if it was drawn before.
    pub(super) fn known_first(&self) -> Option<f32> {
        self.first
    }

    /// Whether it has been known where the ends are, so that there is a place for the parts.
    #[inline]
    pub(super) fn is_known(&self) -> bool {
        self.axis != Vec3A::ZERO
    }

    /// Returns which parts to place while the ends are nowhere. Parts of an element stay. Parts of what is no element any more
    /// get no size.
    fn lose(&mut self, is_element: bool) -> Due {
        if is_element || !self.is_known() {
            return Due::Nowhere;
        }
        self.axis = Vec3A::ZERO;
        // No ends are equal to these, so an element there will be placed.
        self.ends.from = Vec3A::NAN;
        Due::All
    }

    /// Has all parts placed again, whatever was placed before.
    pub(super) fn recall(&mut self) {
        self.due = Due::Nowhere;
    }

    /// Updates the placement from the ends, and returns which parts to place. `has_turn`: in this frame, visibility and
    /// level of detail of the element are updated.
    #[inline(always)]
    fn find(&mut self, ends: Ends, views: &Views, has_turn: bool) -> Due {
        let rests = matches!(self.due, Due::Laid | Due::All) && ends.are(&self.ends);
        if rests && self.looked == Some(views.state()) {
            return Due::Laid;
        }
        let between = ends.to - ends.from;
        let length = between.length();
        if !length.is_finite() {
            return Due::Nowhere;
        }
        let before = self.level;
        let has_turn = has_turn || views.step() > self.room;
        // An element that comes into sight, or has a place again, is seen at once.
        if has_turn || !self.seen || self.due == Due::Nowhere {
            let middle = ends.from + 0.5 * between;
            let sight = views.sight(middle, 0.5 * length + self.layout.reach);
            self.seen = sight.seen;
            self.room = sight.room;
            if sight.seen {
                self.level = level(2.0 * self.layout.wire_radius * sight.pixels, before);
            }
            self.looked = Some(views.state());
        } else if !rests {
            self.looked = None;
        }
        if rests && self.level == before {
            return Due::Laid;
        }
        let shows = self.shows;
        // `lay` sets it again in this frame, unless all parts are placed whether they show or not.
        self.shows &= has_turn || self.seen;
        if !(has_turn || self.seen || shows || self.due == Due::Nowhere) {
            return Due::Hidden;
        }
        self.ends = ends;
        self.length = length;
        let upright = ends.turn();
        if length > SHORT {
            self.axis = between / length;
            self.heading.turn_to(upright.transpose() * self.axis);
        } else {
            self.axis = upright * self.heading.axis();
        }
        self.side = upright * self.heading.side();
        if has_turn || self.seen {
            Due::All
        } else {
            Due::Visible
        }
    }

    /// Whether the coil has become shorter than all its turns are thick since the last call.
    #[inline]
    fn has_become_squeezed(&mut self) -> bool {
        let has_moved = matches!(self.due, Due::Visible | Due::All);
        let is_news =
            has_moved && !self.squeezed && self.layout.span(self.length) < 0.98 * self.layout.solid;
        self.squeezed |= is_news;
        is_news
    }
}

/// The components that say where the ends of an element are.
#[derive(QueryData)]
pub(super) struct Line {
    spring: Option<&'static Spring>,
    damper: Option<&'static Damper>,
    pair: Option<&'static SpringDamper>,
    anchors: Option<&'static Anchors>,
    /// The anchors of an element that has not been stepped yet.
    points: Option<&'static WorldAnchors>,
}

/// Where entities are in this frame, except for parts, which follow the elements.
#[derive(SystemParam)]
pub(super) struct Lines<'w, 's> {
    globals: Query<'w, 's, &'static GlobalTransform, Without<Part>>,
}

impl LineItem<'_, '_> {
    /// The ends of the element; `None` if it is not an element.
    #[inline(always)]
    pub fn between(&self) -> Option<(Entity, Entity)> {
        if let Some(spring) = self.spring {
            Some((spring.body_a, spring.body_b))
        } else if let Some(pair) = self.pair {
            Some((pair.body_a, pair.body_b))
        } else {
            let damper = self.damper?;
            Some((damper.body_a, damper.body_b))
        }
    }
}

impl Lines<'_, '_> {
    /// Rotation of an entity; `None` if it has no `GlobalTransform`.
    pub fn turn(&self, entity: Entity) -> Option<Mat3A> {
        let columns = self.globals.get(entity).ok()?.affine().matrix3;
        Some(upright(columns.x_axis, columns.y_axis))
    }

    /// Where the ends of an element are; `None` if an end has no `GlobalTransform`.
    #[inline(always)]
    pub fn ends(&self, line: &LineItem) -> Option<Ends> {
        let (a, b) = line.between()?;
        let a = self.globals.get(a).ok()?.affine();
        let b = self.globals.get(b).ok()?.affine();
        let (from, to) = match line.anchors {
            Some(anchors) => (
                a.transform_point3a(anchors.a.into()),
                b.transform_point3a(anchors.b.into()),
            ),
            None => (a.translation, b.translation),
        };
        let (from, to) = match line.points {
            Some(points) => (points.a.into(), points.b.into()),
            None => (from, to),
        };
        Some(Ends {
            x: a.matrix3.x_axis,
            y: a.matrix3.y_axis,
            from,
            to,
        })
    }
}

/// Finds where the elements are and how they are seen.
pub(super) fn place(
    mut elements: Query<(Entity, Line, &mut Placement)>,
    lines: Lines,
    cameras: Query<Cameras, Without<Part>>,
    mut views: Local<Views>,
    mut frame: Local<u32>,
) {
    views.update(cameras.iter());
    *frame = frame.wrapping_add(1);
    for (element, line, mut placement) in &mut elements {
        let placement = placement.bypass_change_detection();
        let Some(ends) = lines.ends(&line) else {
            placement.due = placement.lose(line.between().is_some());
            continue;
        };
        let turn = element.index_u32().wrapping_add(*frame);
        let has_turn = turn.is_multiple_of(SELDOM) || views.have_jumped();
        placement.due = placement.find(ends, &views, has_turn);
        if placement.has_become_squeezed() {
            log::warn!(
                "{element}: Coil: it is {} m long, but all its turns touch at {} m already, so wire \
                 passes through wire",
                placement.layout.span(placement.length),
                placement.layout.solid
            );
        }
    }
}
