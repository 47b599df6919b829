//! Where in a step stiffness and damping act.

use super::PLACED;
use crate::dynamics::law::Drag;
use crate::dynamics::poles::{RESOLVED_PHASE, UNRESOLVED_DECAY};
use crate::functions::{cos, exp_m1};

/// Damping time, in steps, of stiffness-proportional damping that takes the [`UNRESOLVED_DECAY`] of a lone
/// element from a mode with z = (ω h)²; less from slower ones.
pub(in crate::dynamics) fn settling(z: f64) -> f64 {
    if z <= RESOLVED_PHASE * RESOLVED_PHASE {
        return 0.0;
    }
    2.0 * UNRESOLVED_DECAY * (1.0 - RESOLVED_PHASE * RESOLVED_PHASE / z) / z
}

/// The slope of a damping force, or where that is steeper the one from zero: a force that flattens out at
/// speed must not be taken for weak.
pub(super) fn steep(drag: Drag, rate: f64) -> f64 {
    if rate == 0.0 {
        return drag.slope;
    }
    drag.slope.max(drag.force / rate)
}

/// Share of the step at whose end a damper with x = c h/m acts: half, which is of second order, while it
/// is resolved; beyond that the share with which a lone damper decays exactly, so that strong ones stop
/// their ends instead of throwing them back and forth.
pub(in crate::dynamics) fn damper_placement(x: f64) -> f64 {
    if x <= 1.0 {
        0.5
    } else {
        -1.0 / exp_m1(-x) - 1.0 / x
    }
}

/// θ for a stiffest mode with z = (ω h)².
pub(in crate::dynamics) fn placement(z: f64) -> f64 {
    if z <= 1e-3 {
        1.0 / 12.0
    } else if z < PLACED {
        ((z / (2.0 * (1.0 - cos(z.sqrt()))) - 1.0) / z).max(1.0 / 12.0)
    } else {
        0.25
    }
}
