//! Four numbers, and four vectors, side by side.

use bevy::math::DVec3;
use wide::f64x4;

/// Elements side by side.
pub(crate) const LANES: usize = 4;

/// One number for each lane.
pub(super) type Each = [f64; LANES];

/// One vector for each lane, axis by axis.
pub(super) type EachVector = [Each; 3];

/// Puts a vector into a lane.
#[inline(always)]
pub(super) fn put(into: &mut EachVector, lane: usize, vector: DVec3) {
    for axis in 0..3 {
        into[axis][lane] = vector[axis];
    }
}

/// Takes one out.
#[inline(always)]
pub(super) fn get(from: &EachVector, lane: usize) -> DVec3 {
    DVec3::new(from[0][lane], from[1][lane], from[2][lane])
}

/// Four vectors.
#[derive(Clone, Copy)]
pub(super) struct Vectors(pub [f64x4; 3]);

impl Vectors {
    pub(super) fn load(from: &EachVector) -> Self {
        Self(from.map(f64x4::new))
    }

    pub(super) fn store(&self) -> EachVector {
        self.0.map(f64x4::to_array)
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    pub(super) fn minus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    pub(super) fn times(self, by: f64x4) -> Self {
        let [a, b, c] = self.0;
        Self([by * a, by * b, by * c])
    }

    pub(super) fn dot(self, other: Self) -> f64x4 {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// Rounded to single precision.
    pub(super) fn rounded(self) -> Self {
        let each = |x: f64x4| f64x4::new(x.to_array().map(|x| f64::from(x as f32)));
        Self(self.0.map(each))
    }

    pub(super) fn length(self) -> f64x4 {
        self.dot(self).sqrt()
    }
}

/// The same number four times.
pub(super) fn all(value: f64) -> f64x4 {
    f64x4::splat(value)
}

/// Distance of two points below which it may be rounding of the engine's f32; see [`crate::dynamics::element::rounding`].
pub(super) fn rounding(a: Vectors, b: Vectors) -> f64x4 {
    let largest = |v: Vectors| {
        let [x, y, z] = v.0.map(f64x4::abs);
        x.max(y).max(z)
    };
    all(1e-9) * largest(a).max(largest(b)).max(all(1e-3))
}
