//! From where a scene is seen: what is out of sight, and how finely the rest is worth drawing.

use bevy::camera::primitives::{Frustum, Sphere};
use bevy::camera::{Camera, Projection};
use bevy::math::Vec3A;
use bevy::prelude::*;

/// The least thickness of a wire, in pixels, for each level of detail but the coarsest.
const FINE_ENOUGH: [f32; 3] = [14.0, 5.0, 1.5];
/// A level is left only when the thickness is beyond its bounds by this factor, lest it flickers.
const HYSTERESIS: f32 = 1.15;

/// A camera.
struct View {
    frustum: Frustum,
    position: Vec3A,
    /// Pixels that a metre takes, at one metre's distance in perspective.
    focal: f32,
    perspective: bool,
}

/// All active cameras; none where nothing is rendered.
#[derive(Default)]
pub(super) struct Views(Vec<View>);

/// What is looked up of a camera.
pub(super) type Cameras<'a> = (&'a Camera, &'a Projection, &'a Frustum, &'a GlobalTransform);

/// How an element is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// By any camera.
    pub seen: bool,
    /// The most pixels that a metre there takes in any camera.
    pub pixels: f32,
}

impl Views {
    /// Looks at the cameras of this frame.
    pub fn update<'a>(&mut self, cameras: impl Iterator<Item = Cameras<'a>>) {
        self.0.clear();
        for (camera, projection, frustum, at) in cameras {
            let Some(size) = camera.physical_viewport_size() else {
                continue;
            };
            if !camera.is_active {
                continue;
            }
            self.0.push(View {
                frustum: *frustum,
                position: at.translation_vec3a(),
                focal: 0.5 * size.y as f32 * camera.clip_from_view().y_axis.y,
                perspective: !matches!(projection, Projection::Orthographic(_)),
            });
        }
    }

    /// How a ball is seen. Without cameras everything is, and closely.
    #[inline]
    pub fn sight(&self, center: Vec3A, radius: f32) -> Sight {
        let mut out = Sight {
            seen: self.0.is_empty(),
            pixels: if self.0.is_empty() { f32::MAX } else { 0.0 },
        };
        let ball = Sphere { center, radius };
        for view in &self.0 {
            if !view.frustum.intersects_sphere(&ball, true) {
                continue;
            }
            out.seen = true;
            let pixels = if view.perspective {
                let distance = (view.position.distance(center) - radius).max(1e-3);
                view.focal / distance
            } else {
                view.focal
            };
            out.pixels = out.pixels.max(pixels);
        }
        out
    }
}

/// The level of detail for a thickness in pixels, coming from some level; 0 is the finest.
#[inline]
pub(super) fn level(pixels: f32, before: u8) -> u8 {
    let mut level = 0;
    for (i, least) in FINE_ENOUGH.into_iter().enumerate() {
        let stay = usize::from(before) <= i;
        let least = if stay {
            least / HYSTERESIS
        } else {
            least * HYSTERESIS
        };
        if pixels >= least {
            break;
        }
        level += 1;
    }
    level
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn without_a_camera_everything_is_drawn_closely() {
        let sight = Views::default().sight(Vec3A::ZERO, 1.0);
        assert!(sight.seen && level(sight.pixels, 3) == 0);
    }
}
