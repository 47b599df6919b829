//! Where every element is in this frame, and what of it is worth drawing there.

use super::heading::{Heading, upright};
use super::layout::{Layout, Part, SHORT};
use super::views::{Cameras, Views, level};
use crate::element::{Anchors, Damper, Spring, SpringDamper, WorldAnchors};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{Mat3A, Vec3A};
use bevy::prelude::*;

/// An element out of everyone's sight is placed every so many frames only. It may still throw a shadow
/// into the picture, so it is not left alone altogether. How one in sight is seen is found out as seldom: for
/// that long it may be drawn a little too finely or too coarsely, or once it is out of sight be laid for
/// nothing.
const SELDOM: u32 = 8;

/// Where an element is drawn.
#[derive(Component, Clone, Copy, Debug, Default)]
// Worked out anew wherever a copy stands; a scene does not know it.
#[component(clone_behavior = Ignore)]
pub struct Placement {
    pub(super) due: Due,
    /// Level of detail.
    pub(super) level: u8,
    /// Its coil has been shorter than its turns are thick, and that was said.
    squeezed: bool,
    /// It was in sight when that was last found out.
    pub(super) seen: bool,
    /// Some part of it was in some view in the last frame, be it for its shadow.
    pub(super) shows: bool,
    /// The state of the views for which sight and level are right.
    looked: Option<u32>,
    /// From end to end, m.
    pub(super) length: f32,
    /// In the world: unit vectors along the element and across it.
    pub(super) axis: Vec3A,
    pub(super) side: Vec3A,
    pub(super) ends: Ends,
    pub(super) layout: Layout,
    heading: Heading,
    /// Length when first drawn, m.
    first: Option<f32>,
}

/// Which parts of an element have to be laid anew in a frame. Those that have changed always have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Due {
    /// Not even those: nobody knows where its ends are.
    #[default]
    Nowhere,
    /// None: all lie where they should,
    Laid,
    /// or it does not matter where they lie, for none was seen in the last frame.
    Hidden,
    /// Those that were seen in the last frame.
    Visible,
    All,
}

/// What a placement follows from.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    /// Two axes of end A, scaled as that is.
    x: Vec3A,
    y: Vec3A,
    /// Both anchors.
    pub from: Vec3A,
    pub to: Vec3A,
}

impl Ends {
    /// How end A is turned.
    #[inline]
    pub fn turn(&self) -> Mat3A {
        upright(self.x, self.y)
    }

    /// Whether they are the same, found out without a jump.
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
    /// Gives an element new looks.
    pub(super) fn dress(&mut self, layout: Layout) {
        self.layout = layout;
        self.level = 0;
        self.squeezed = false;
        self.seen = false;
        self.recall();
    }

    /// Whether it has been drawn before, so that its sizes are known.
    pub(super) fn is_drawn(&self) -> bool {
        self.first.is_some()
    }

    /// Length when first drawn, m: this one, if that is now.
    pub(super) fn first(&mut self, length: f32) -> f32 {
        *self.first.get_or_insert(length.max(SHORT))
    }

    /// Lays all parts anew, whatever has been laid before.
    pub(super) fn recall(&mut self) {
        self.due = Due::Nowhere;
    }

    /// Follows the ends, and says what follows from that. Some frames have their turn.
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
        // What comes into sight is seen at once.
        if has_turn || !self.seen {
            let middle = ends.from + 0.5 * between;
            let sight = views.sight(middle, 0.5 * length + self.layout.reach);
            self.seen = sight.seen;
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
        // Found out anew in this frame, unless all parts are laid whatever they show.
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

    /// Whether the coil's turns have become shorter than they are thick since this was last asked.
    #[inline]
    fn has_become_squeezed(&mut self) -> bool {
        let has_moved = matches!(self.due, Due::Visible | Due::All);
        let is_news =
            has_moved && !self.squeezed && self.layout.span(self.length) < 0.98 * self.layout.solid;
        self.squeezed |= is_news;
        is_news
    }
}

/// An element as it says itself where its ends are.
#[derive(QueryData)]
pub(super) struct Line {
    spring: Option<&'static Spring>,
    damper: Option<&'static Damper>,
    pair: Option<&'static SpringDamper>,
    anchors: Option<&'static Anchors>,
    /// It has not been stepped yet: here are its anchors.
    points: Option<&'static WorldAnchors>,
}

/// Where entities are in this frame; parts, which follow, aside.
#[derive(SystemParam)]
pub(super) struct Lines<'w, 's> {
    globals: Query<'w, 's, &'static GlobalTransform, Without<Part>>,
}

impl Lines<'_, '_> {
    /// Where the ends of an element are.
    #[inline(always)]
    pub fn ends(&self, line: &LineItem) -> Option<Ends> {
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

/// Finds out where the elements are and how they are seen.
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
            placement.due = Due::Nowhere;
            continue;
        };
        let turn = element.index_u32().wrapping_add(*frame);
        placement.due = placement.find(ends, &views, turn.is_multiple_of(SELDOM));
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
