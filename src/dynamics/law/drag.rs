//! How a damper's force depends on speed.

use super::Function;
use super::table::Table;
use std::sync::Arc;

/// Tension (N) for a rate of the length (m/s). Has the sign of the rate.
#[derive(Clone, Debug)]
pub(crate) enum DragLaw {
    /// N s/m.
    Linear(f64),
    /// N s/m while the length shrinks and while it grows.
    Sided { bump: f64, rebound: f64 },
    /// N s/m and N s²/m².
    Quadratic { linear: f64, quadratic: f64 },
    /// N s/m up to a speed (m/s) and beyond it.
    BlowOff {
        damping: f64,
        knee: f64,
        beyond: f64,
    },
    /// Over the rate.
    Table(Arc<Table>),
    /// A user's own.
    Custom(Arc<dyn Function>),
}

/// A damping force and its slope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Drag {
    /// N, tension positive.
    pub force: f64,
    /// N s/m, not negative.
    pub slope: f64,
}

impl DragLaw {
    pub(crate) fn at(&self, rate: f64) -> Drag {
        let (force, slope) = match self {
            Self::Linear(damping) => (damping * rate, *damping),
            Self::Sided { bump, rebound } => {
                let damping = if rate < 0.0 { *bump } else { *rebound };
                (damping * rate, damping)
            }
            Self::Quadratic { linear, quadratic } => (
                (linear + quadratic * rate.abs()) * rate,
                linear + 2.0 * quadratic * rate.abs(),
            ),
            Self::BlowOff {
                damping,
                knee,
                beyond,
            } => {
                let past = (rate.abs() - knee).max(0.0);
                let below = rate.abs() - past;
                (
                    (damping * below + beyond * past).copysign(rate),
                    if past > 0.0 { *beyond } else { *damping },
                )
            }
            Self::Table(table) => {
                let [force, slope, _] = table.at(rate);
                (force, slope)
            }
            Self::Custom(function) => (function.force(rate), function.slope(rate)),
        };
        // A damper never drives.
        if force * rate < 0.0 {
            return Drag::default();
        }
        Drag {
            force,
            slope: slope.max(0.0),
        }
    }

    /// The one coefficient it has, if that is all.
    pub(crate) fn linear(&self) -> Option<f64> {
        match self {
            Self::Linear(damping) => Some(*damping),
            _ => None,
        }
    }
}
