//! Chance that is the same everywhere.

use bevy::prelude::*;
use std::ops::Range;

/// Every third of the seeds, as a searching test takes them, or all with `COILOVER_SEEDS=all`.
pub fn seeds(all: Range<u64>) -> Vec<u64> {
    let all_of_them = std::env::var_os("COILOVER_SEEDS").is_some_and(|v| v == "all");
    all.step_by(if all_of_them { 1 } else { 3 }).collect()
}

/// A small generator of our own, so that a scene is the same everywhere (SplitMix64).
pub struct Dice(pub u64);

impl Dice {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / (1u64 << 24) as f32
    }

    pub fn between(&mut self, a: f32, b: f32) -> f32 {
        a + (b - a) * self.next()
    }

    pub fn pick(&mut self, count: u32) -> u32 {
        ((self.next() * count as f32) as u32).min(count - 1)
    }

    pub fn place(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 4.0
    }
}
