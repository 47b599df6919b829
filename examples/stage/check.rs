//! The measurements of an example, and whether they agree with theory.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::fmt;
use std::sync::atomic::{AtomicU32, Ordering};

/// Returns the larger of two numbers, or NaN if one is NaN. `f32::max` would pass over a NaN.
pub fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if b <= a || a.partial_cmp(&a).is_none() {
        a
    } else {
        b
    }
}

/// Returns the smaller of two numbers, or NaN if one is NaN.
pub fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if b >= a || a.partial_cmp(&a).is_none() {
        a
    } else {
        b
    }
}

/// A measured value compared with theory.
pub struct Finding {
    text: String,
    pub good: bool,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.good {
            ""
        } else {
            "  NOT as theory says"
        };
        write!(f, "{}{verdict}", self.text)
    }
}

impl Finding {
    /// Good if measured and theory differ by less than this share of the theory.
    pub fn close(what: &str, measured: f32, theory: f32, unit: &str, share: f32) -> Self {
        let error = measured / theory - 1.0;
        Self {
            text: format!(
                "{what}: measured {measured:.5} {unit}, theory {theory:.5} {unit} ({:+.4} %)",
                100.0 * error
            ),
            good: error.abs() < share,
        }
    }

    /// Good if a value that should be zero is below this limit.
    pub fn small(what: &str, measured: f32, limit: f32, unit: &str) -> Self {
        Self {
            text: format!("{what}: {measured:.2e} {unit}, at most {limit:.0e} {unit}"),
            good: measured.abs() < limit,
        }
    }

    /// Good if a value lies between two limits.
    pub fn between(what: &str, measured: f32, least: f32, most: f32, unit: &str) -> Self {
        Self {
            text: format!("{what}: {measured:.3} {unit}, between {least} and {most} {unit}"),
            good: (least..=most).contains(&measured),
        }
    }
}

/// On an element: its read-outs in each tick, with the time in seconds, and the number of the track in the order of spawning.
#[derive(Component)]
pub struct Track(pub Vec<(f32, SpringReadout)>, u32);

impl Default for Track {
    fn default() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        Self(Vec::new(), COUNT.fetch_add(1, Ordering::Relaxed))
    }
}

impl Track {
    /// Returns its number in the order of spawning.
    pub fn number(&self) -> u32 {
        self.1
    }

    /// Returns how often a second the length rises through this value, Hz, or NaN with fewer than two crossings.
    pub fn frequency(&self, middle: f32) -> f32 {
        let crossings: Vec<f32> = self
            .0
            .windows(2)
            .filter(|w| w[0].1.length < middle && w[1].1.length >= middle)
            .map(|w| {
                let share = (middle - w[0].1.length) / (w[1].1.length - w[0].1.length);
                w[0].0 + share * (w[1].0 - w[0].0)
            })
            .collect();
        match crossings[..] {
            [first, .., last] => (crossings.len() - 1) as f32 / (last - first),
            _ => f32::NAN,
        }
    }

    /// Returns the largest difference of the length from a function of time (s), m.
    pub fn error(&self, theory: impl Fn(f32) -> f32) -> f32 {
        let errors = self.0.iter().map(|(t, r)| (r.length - theory(*t)).abs());
        errors.fold(0.0, larger)
    }

    /// Returns the last read-out.
    pub fn last(&self) -> SpringReadout {
        self.0.last().map(|l| l.1).unwrap_or_default()
    }
}

/// Returns all tracks, in the order of spawning. Entities are in another order after a restart, when their indices are used again.
pub fn tracks(world: &mut World) -> Vec<&Track> {
    let mut all: Vec<_> = world.query::<&Track>().iter(world).collect();
    all.sort_by_key(|track| track.number());
    all
}

pub(super) fn record(time: Res<Time>, mut tracked: Query<(&SpringReadout, &mut Track)>) {
    for (readout, mut track) in &mut tracked {
        track.0.push((time.elapsed_secs(), *readout));
    }
}
