//! Random numbers that are the same on every machine, and how many cases the searching tests take.

use bevy::prelude::*;
use std::ops::Range;

/// A searching test takes one case in three, and a third of the time. With `COILOVER_SEEDS=all`, it takes all.
fn each() -> usize {
    let all_of_them = std::env::var_os("COILOVER_SEEDS").is_some_and(|v| v == "all");
    if all_of_them { 1 } else { 3 }
}

/// Seeds that a searching test takes.
pub fn seeds(all: Range<u64>) -> Vec<u64> {
    some(all)
}

/// Cases that a searching test takes: the first, the fourth and so on.
pub fn some<T>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    all.into_iter().step_by(each()).collect()
}

/// Seconds for which a searching test watches a scene, from the seconds for a full run.
pub fn span(seconds: f64) -> f64 {
    seconds / each() as f64
}

/// For a list that has every case in three ways, one after the other: takes the first case in the first way, the
/// second in the second, and so on. For any other list, it takes one entry of each three, at places that change.
pub fn in_turn<T>(all: Vec<T>) -> Vec<T> {
    let ways = each();
    let taken = |(index, case)| (index % ways == index / ways % ways).then_some(case);
    all.into_iter().enumerate().filter_map(taken).collect()
}

/// Random number generator (SplitMix64), so that a scene is the same on every machine.
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
