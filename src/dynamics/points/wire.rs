//! One element of a network of points, and its line.

use super::state::State;
use crate::dynamics::element::rounding;
use crate::dynamics::thresholds::is_damper_stiff;
use bevy::math::DVec3;

/// One element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire {
    pub ends: [u32; 2],
    pub stiffness: f64,
    pub damping: f64,
    pub rest_length: f64,
    /// Vector towards end B at the start of the micro-step, of any length; zero if it is unknown.
    pub side: DVec3,
    /// See [`Element::stiff_damper`](crate::dynamics::element::Element::stiff_damper).
    pub stiff_damper: bool,
}

/// Direction and length of a line; see [`Element::line`](crate::dynamics::element::Element::line).
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub direction: DVec3,
    pub length: f64,
}

impl Wire {
    pub(super) fn tension(&self, length: f64, rate: f64) -> f64 {
        self.stiffness * (length - self.rest_length) + self.damping * rate
    }

    /// Values of its ends in a list.
    #[inline(always)]
    pub(super) fn of<T: Copy>(&self, list: &[T]) -> [T; 2] {
        let [a, b] = self.ends;
        [list[a as usize], list[b as usize]]
    }

    #[inline(always)]
    pub(super) fn inverse_masses(&self, points: &State) -> [f64; 2] {
        let [a, b] = self.ends;
        [points.inverse_mass(a), points.inverse_mass(b)]
    }

    /// Vector from end A to end B, or the last known one if the ends coincide.
    #[inline(always)]
    pub(super) fn aimed(&self, [a, b]: [DVec3; 2]) -> DVec3 {
        let d = b - a;
        if d.length_squared() > noise(a, b) {
            d
        } else {
            self.side
        }
    }

    /// See [`Element::aim`](crate::dynamics::element::Element::aim).
    #[inline(always)]
    pub(super) fn aim(&mut self, points: &State, step: f64) {
        self.side = self.aimed(self.of(&points.positions));
        self.stiff_damper = false;
        if self.damping > 0.0 && self.rest_length == 0.0 {
            let [a, b] = self.inverse_masses(points);
            let inverse_mass = a + b;
            let z = self.stiffness * inverse_mass * step * step;
            self.stiff_damper = is_damper_stiff(z, self.damping * inverse_mass * step);
        }
    }

    #[inline(always)]
    pub(super) fn line(&self, points: &State) -> Option<Line> {
        let [a, b] = self.of(&points.positions);
        let d = b - a;
        let square = d.length_squared();
        if square > noise(a, b) {
            let distance = square.sqrt();
            let length = if d.dot(self.side) < 0.0 {
                -distance
            } else {
                distance
            };
            let direction = d / length;
            return Some(Line { direction, length });
        }
        let direction = self.known_direction(points)?;
        let length = d.dot(direction);
        Some(Line { direction, length })
    }

    /// Direction while the ends coincide.
    #[cold]
    fn known_direction(&self, points: &State) -> Option<DVec3> {
        if self.side != DVec3::ZERO {
            return Some(self.side.normalize());
        }
        if self.rest_length != 0.0 {
            return None;
        }
        let [a, b] = self.of(&points.velocities);
        let [from, to] = self.ends.map(|end| points.acceleration(end));
        Some(((b - a) + (to - from)).try_normalize().unwrap_or(DVec3::Y))
    }
}

/// Square of the distance up to which two points may coincide but for rounding of the engine's f32, m².
fn noise(a: DVec3, b: DVec3) -> f64 {
    rounding(a, b).powi(2)
}
