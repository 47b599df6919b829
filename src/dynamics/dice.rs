//! Random numbers for tests.

use bevy::math::DVec3;

/// Pseudo-random numbers, the same in each run.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    /// A number from 0 to 1.
    pub(crate) fn number(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A vector in a cube of a size, about the origin.
    pub(crate) fn vector(&mut self, size: f64) -> DVec3 {
        let mut each = || size * (self.number() - 0.5);
        DVec3::new(each(), each(), each())
    }
}
