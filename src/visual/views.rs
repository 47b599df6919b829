//! The cameras that see a scene: what is out of sight, and how finely the rest is worth drawing.

use bevy::camera::primitives::Frustum;
use bevy::camera::{Camera, Projection};
use bevy::math::Vec3A;
use bevy::prelude::*;

/// Least thickness of a wire, in pixels, for each level of detail except the coarsest.
pub(super) const FINE_ENOUGH: [f32; 3] = [14.0, 5.0, 1.5];
/// Factor by which the thickness must pass a bound before the level changes, so that the level does not flicker.
const HYSTERESIS: f32 = 1.15;
/// Share of its distance by which a camera can move without a change of size by more than the hysteresis.
const ROOM: f32 = 1.0 - 1.0 / HYSTERESIS;
/// Least cosine of the angle by which a camera turns from one frame to the next, unless it is cut to another direction.
const TURN: f32 = 0.97;

/// A camera.
#[derive(Clone, Copy, PartialEq)]
struct View {
    /// Components x, y, z and w of the planes that bound the view, four planes at a time. A ball is beyond a plane if
    /// the product of the plane with the ball's centre is below minus the radius.
    planes: [[Vec4; 4]; 2],
    position: Vec3A,
    /// Unit vector against the direction in which it looks.
    back: Vec3A,
    /// Pixels per metre; in perspective, at a distance of one metre.
    focal: f32,
    perspective: bool,
}

impl View {
    fn planes(frustum: &Frustum) -> [[Vec4; 4]; 2] {
        let plane = |i: usize| frustum.half_spaces.get(i).map(|p| p.normal_d());
        [0, 4].map(|first| {
            // Nothing is beyond a plane that does not exist.
            let four = [0, 1, 2, 3].map(|i| plane(first + i).unwrap_or(Vec4::W * f32::MAX));
            Mat4::from_cols(four[0], four[1], four[2], four[3])
                .transpose()
                .to_cols_array_2d()
                .map(Vec4::from)
        })
    }

    /// Whether any part of a ball is in sight.
    #[inline]
    fn sees(&self, center: Vec3A, radius: f32) -> bool {
        let (cx, cy, cz) = (center.x, center.y, center.z);
        let heights = |[x, y, z, w]: &[Vec4; 4]| (*x * cx + *y * cy) + (*z * cz + *w);
        let [sides, ends] = &self.planes;
        // Both groups of planes at once, without a branch.
        let lowest = heights(sides).min(heights(ends));
        !lowest.cmple(Vec4::splat(-radius)).any()
    }
}

/// All active cameras; empty where nothing is rendered.
#[derive(Default)]
pub(super) struct Views {
    now: Vec<View>,
    before: Vec<View>,
    changes: u32,
    has_jumped: bool,
    /// The farthest that a view has moved since the last frame, m.
    step: f32,
}

/// The components of a camera that are read.
pub(super) type Cameras<'a> = (&'a Camera, &'a Projection, &'a Frustum, &'a GlobalTransform);

/// How an element is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// Whether any camera sees it.
    pub seen: bool,
    /// Pixels per metre at its place, in the camera in which it appears largest.
    pub pixels: f32,
    /// How far a view may move in one frame before the size in pixels is wrong, m.
    pub room: f32,
}

impl Views {
    /// Reads the cameras of this frame.
    pub fn update<'a>(&mut self, cameras: impl Iterator<Item = Cameras<'a>>) {
        std::mem::swap(&mut self.now, &mut self.before);
        self.now.clear();
        for (camera, projection, frustum, at) in cameras {
            let Some(size) = camera.physical_viewport_size() else {
                continue;
            };
            if !camera.is_active {
                continue;
            }
            self.now.push(View {
                planes: View::planes(frustum),
                position: at.translation_vec3a(),
                back: at.affine().matrix3.z_axis.normalize_or_zero(),
                focal: 0.5 * size.y as f32 * camera.clip_from_view().y_axis.y,
                perspective: !matches!(projection, Projection::Orthographic(_)),
            });
        }
        self.changes = self
            .changes
            .wrapping_add(u32::from(self.now != self.before));
        let pairs = || self.now.iter().zip(&self.before);
        // What a single view turns to was out of sight before. With several views, another one may have seen it.
        let alone = self.now.len() == 1;
        let is_near = |(now, before): (&View, &View)| {
            let bounds = HYSTERESIS.recip()..=HYSTERESIS;
            now.perspective == before.perspective
                && (now.focal == before.focal || bounds.contains(&(now.focal / before.focal)))
                && (alone || now.back == before.back || now.back.dot(before.back) > TURN)
        };
        let has_jumped = self.now.len() != self.before.len() || !pairs().all(is_near);
        let steps = pairs().map(|(now, before)| now.position.distance(before.position));
        let step = steps.fold(0.0, f32::max);
        self.has_jumped = has_jumped;
        self.step = step;
    }

    /// Whether a view is new, shows everything suddenly larger or smaller, as that of a window whose size has changed,
    /// or suddenly looks elsewhere beside another view. Then the levels of detail of all elements may be wrong.
    #[inline]
    pub const fn have_jumped(&self) -> bool {
        self.has_jumped
    }

    /// The farthest that a view has moved since the last frame, m.
    #[inline]
    pub const fn step(&self) -> f32 {
        self.step
    }

    /// A number that changes whenever the cameras change.
    #[inline]
    pub const fn state(&self) -> u32 {
        self.changes
    }

    /// How a ball is seen. Without cameras everything counts as seen from close by.
    #[inline]
    pub fn sight(&self, center: Vec3A, radius: f32) -> Sight {
        let mut out = Sight {
            seen: self.now.is_empty(),
            pixels: if self.now.is_empty() { f32::MAX } else { 0.0 },
            room: f32::INFINITY,
        };
        for view in &self.now {
            if !view.sees(center, radius) {
                continue;
            }
            out.seen = true;
            let pixels = if view.perspective {
                let distance = (view.position.distance(center) - radius).max(1e-3);
                out.room = out.room.min(ROOM * distance);
                view.focal / distance
            } else {
                view.focal
            };
            out.pixels = out.pixels.max(pixels);
        }
        out
    }
}

/// Level of detail for a thickness in pixels, given the previous level; 0 is the finest.
#[inline]
pub(super) fn level(pixels: f32, before: u8) -> u8 {
    let stays = STAYS.get(usize::from(before));
    if stays.is_some_and(|(least, most)| (*least..*most).contains(&pixels)) {
        return before;
    }
    let bounds = FINE_ENOUGH.into_iter().enumerate();
    bounds
        .filter(|(i, least)| {
            let comes_from_it = usize::from(before) <= *i;
            pixels < beyond(*least, !comes_from_it)
        })
        .count() as u8
}

/// A bound with hysteresis: for a thickness that rises past it, or for one that falls.
const fn beyond(bound: f32, rising: bool) -> f32 {
    if rising {
        bound * HYSTERESIS
    } else {
        bound / HYSTERESIS
    }
}

/// Range of thickness, in pixels, in which each level is kept.
const STAYS: [(f32, f32); FINE_ENOUGH.len() + 1] = [
    (beyond(FINE_ENOUGH[0], false), f32::INFINITY),
    (beyond(FINE_ENOUGH[1], false), beyond(FINE_ENOUGH[0], true)),
    (beyond(FINE_ENOUGH[2], false), beyond(FINE_ENOUGH[1], true)),
    (f32::NEG_INFINITY, beyond(FINE_ENOUGH[2], true)),
];

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::camera::primitives::Sphere;

    #[test]
    fn nearer_is_finer_and_no_level_flickers() {
        assert_eq!(level(f32::MAX, 3), 0);
        assert_eq!(level(0.0, 0), 3);
        assert_eq!(level(8.0, 0), 1);
        assert_eq!(level(3.0, 0), 2);
        for (i, bound) in FINE_ENOUGH.into_iter().enumerate() {
            let (fine, coarse) = (i as u8, i as u8 + 1);
            for pixels in [0.95 * bound, bound, 1.05 * bound] {
                assert_eq!(level(pixels, fine), fine);
                assert_eq!(level(pixels, coarse), coarse);
            }
        }
    }

    #[test]
    fn a_camera_sees_what_bevys_frustum_does() {
        let at = Transform::from_xyz(1.0, 2.0, 3.0).looking_at(Vec3::new(-4.0, 0.0, 1.0), Vec3::Y);
        let perspective = Projection::from(PerspectiveProjection {
            far: 20.0,
            ..default()
        });
        let flat = Projection::from(OrthographicProjection {
            scale: 0.01,
            far: 20.0,
            ..OrthographicProjection::default_3d()
        });
        for projection in [perspective, flat] {
            let frustum = projection.compute_frustum(&at.into());
            let view = View {
                planes: View::planes(&frustum),
                position: Vec3A::ZERO,
                back: Vec3A::Z,
                focal: 1.0,
                perspective: true,
            };
            let mut seen = 0;
            for i in 0..4000 {
                let t = i as f32;
                let ball = Sphere {
                    center: Vec3A::new((1.3 * t).sin(), (0.7 * t).cos(), (2.1 * t).sin()) * 25.0,
                    radius: 2.0 + (3.3 * t).sin(),
                };
                let wanted = frustum.intersects_sphere(&ball, true);
                assert_eq!(view.sees(ball.center, ball.radius), wanted, "{ball:?}");
                seen += u32::from(wanted);
            }
            assert!((20..3980).contains(&seen), "{seen}");
        }
    }

    #[test]
    fn without_a_camera_everything_is_drawn_closely() {
        let sight = Views::default().sight(Vec3A::ZERO, 1.0);
        assert!(sight.seen && level(sight.pixels, 3) == 0);
    }
}
