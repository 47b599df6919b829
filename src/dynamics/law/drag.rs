//! Damping laws: the force of a damper as a function of speed.

use super::Function;
use super::table::Table;
use std::sync::Arc;

/// Tension (N) as a function of the rate of the length (m/s). It has the sign of the rate.
#[derive(Clone, Debug)]
pub(crate) enum DragLaw {
    /// Damping, N s/m.
    Linear(f64),
    /// Damping while the length shrinks (`bump`) and while it grows (`rebound`), N s/m.
    Sided { bump: f64, rebound: f64 },
    /// Linear damping (N s/m) and quadratic damping (N s²/m²).
    Quadratic { linear: f64, quadratic: f64 },
    /// Slope up to the speed `knee` (m/s) and beyond it, N s/m.
    BlowOff {
        damping: f64,
        knee: f64,
        beyond: f64,
    },
    /// Table of tension over rate.
    Table(Arc<Table>),
    /// A custom function of the user.
    Custom(Arc<dyn Function>),
}

/// A damping force and its slope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Drag {
    /// Force, N; tension is positive.
    pub force: f64,
    /// Slope over the rate, N s/m; not negative.
    pub slope: f64,
}

impl Drag {
    /// The damping force that remains at a rate if the sum of spring and damper has a least and a greatest value. The limits apply
    /// to the sum, as in a slipping clutch. `spring` is the tension of the spring within the limits, and `uncut` that without them.
    /// The damper first balances the part of `uncut` that is beyond a limit. If that part is more than the damper's own force, the
    /// damper has no effect. Clamping is monotone, so the force never adds energy.
    pub(super) fn within(
        self,
        [least, greatest]: [f64; 2],
        rate: f64,
        [spring, uncut]: [f64; 2],
    ) -> Self {
        let total = uncut + self.force;
        let is_free = total >= least && total <= greatest;
        if is_free && uncut == spring {
            return self;
        }
        let force = total.clamp(least, greatest) - spring;
        if force * rate < 0.0 {
            return Self::default();
        }
        let slope = if is_free { self.slope } else { 0.0 };
        Self { force, slope }
    }
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
        // A damper must not add energy.
        if force * rate < 0.0 {
            return Drag::default();
        }
        Drag {
            force,
            slope: slope.max(0.0),
        }
    }

    /// Damping of a linear law, N s/m; `None` for other laws.
    pub(crate) fn linear(&self) -> Option<f64> {
        match self {
            Self::Linear(damping) => Some(*damping),
            _ => None,
        }
    }
}
