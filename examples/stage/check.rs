//! What an example measures, and whether it is as theory says.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::fmt;

/// A figure against its theory.
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
    /// Good where measured and theory differ by less than this share of the theory.
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

    /// Good where a figure that should be zero is smaller than this.
    pub fn small(what: &str, measured: f32, limit: f32, unit: &str) -> Self {
        Self {
            text: format!("{what}: {measured:.2e} {unit}, at most {limit:.0e} {unit}"),
            good: measured.abs() < limit,
        }
    }

    /// Good where a figure lies between two.
    pub fn between(what: &str, measured: f32, least: f32, most: f32, unit: &str) -> Self {
        Self {
            text: format!("{what}: {measured:.3} {unit}, between {least} and {most} {unit}"),
            good: (least..=most).contains(&measured),
        }
    }
}

/// On an element: its read-outs, tick by tick, with the time in seconds.
#[derive(Component, Default)]
pub struct Track(pub Vec<(f32, SpringReadout)>);

impl Track {
    /// How often a second the length passes this one on its way up, Hz; not a number if hardly ever.
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

    /// The largest difference of the length from a function of time (s), m.
    pub fn error(&self, theory: impl Fn(f32) -> f32) -> f32 {
        let errors = self.0.iter().map(|(t, r)| (r.length - theory(*t)).abs());
        // Unlike `f32::max`, it lets no NaN pass.
        errors.fold(
            0.0,
            |most, e| {
                if most.is_nan() || e <= most { most } else { e }
            },
        )
    }

    /// The last read-out.
    pub fn last(&self) -> SpringReadout {
        self.0.last().map(|l| l.1).unwrap_or_default()
    }
}

/// All that was tracked, in the order of spawning.
pub fn tracks(world: &mut World) -> Vec<&Track> {
    let mut query = world.query::<(Entity, &Track)>();
    let mut all: Vec<_> = query.iter(world).collect();
    all.sort_by_key(|(entity, _)| entity.index_u32());
    all.into_iter().map(|(_, track)| track).collect()
}

pub(super) fn record(time: Res<Time>, mut tracked: Query<(&SpringReadout, &mut Track)>) {
    for (readout, mut track) in &mut tracked {
        track.0.push((time.elapsed_secs(), *readout));
    }
}
