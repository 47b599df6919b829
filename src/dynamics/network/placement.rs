//! The times within a step at which stiffness and damping act.

use super::PLACED;
use crate::dynamics::element::Element;
use crate::dynamics::law::Drag;
use crate::dynamics::poles::{UNRESOLVED_DECAY, unresolved};
use crate::dynamics::thresholds::is_resolved;
use crate::functions::{cos, exp_m1};

/// Ratio of damping to stiffness, in steps, with which a mode with z = (ω h)² has the [`UNRESOLVED_DECAY`] of a lone element.
/// Slower modes decay less.
pub(in crate::dynamics) fn settling(z: f64) -> f64 {
    if is_resolved(z) {
        return 0.0;
    }
    2.0 * UNRESOLVED_DECAY * unresolved(z) / z
}

/// Slope of a damping force over the rate, or the slope of the secant from zero if that is steeper, N s/m. A force that
/// flattens at speed must not count as weak.
pub(in crate::dynamics) fn steep(drag: Drag, rate: f64) -> f64 {
    if rate == 0.0 {
        return drag.slope;
    }
    drag.slope.max(drag.force / rate)
}

/// Damping with which an element stops its ends, N s/m: the slope of its damper, or the slope of the secant from zero if that is
/// steeper, as where a limit makes the slope zero. Only what is left of the damper's force against the spring counts: where the
/// two cancel, as in a rope that goes slack, nothing is stopped.
pub(in crate::dynamics) fn braking(element: &Element, length: f64, rate: f64) -> f64 {
    let drag = element.drag(length, rate);
    if element.law.is_none() || rate == 0.0 {
        return drag.slope;
    }
    let whole = element.elastic(length).force + drag.force;
    drag.slope.max((drag.force / rate).min(whole / rate))
}

/// c h/m of all dampers at a body together, above which damping at the speed in the middle of the step would throw the body back,
/// although each damper alone would not. Pinned by
/// `networks::ten_dampers_side_by_side_stop_a_body_as_one_does`.
pub(in crate::dynamics) const REVERSES: f64 = 2.0;

/// Ratio of the other dampers at a body to one of them, above which that one is too weak to throw the body back. Placed by them,
/// it would only become less exact. Pinned by
/// `networks::ten_dampers_side_by_side_stop_a_body_as_one_does`.
const MANY: f64 = 32.0;

/// c h/m that places a damper in the step, where its own is `own` and that of the other dampers at its ends is `others`.
pub(in crate::dynamics) fn together(own: f64, others: f64) -> f64 {
    if own + others > REVERSES && others < MANY * own {
        own + others
    } else {
        own
    }
}

/// Time whose velocity determines the force of a damper with x = c h/m, as a share of the step. While the damper is
/// resolved, it is one half, which is of second order. Beyond, it is the share with which a lone damper decays exactly. Then
/// a strong damper stops its ends instead of throwing them back and forth.
pub(in crate::dynamics) fn damper_placement(x: f64) -> f64 {
    if x <= 1.0 {
        0.5
    } else {
        -1.0 / exp_m1(-x) - 1.0 / x
    }
}

/// θ of [`crate::dynamics::network`] for a stiffest mode with z = (ω h)².
pub(in crate::dynamics) fn placement(z: f64) -> f64 {
    if z <= 1e-3 {
        1.0 / 12.0
    } else if z < PLACED {
        ((z / (2.0 * (1.0 - cos(z.sqrt()))) - 1.0) / z).max(1.0 / 12.0)
    } else {
        0.25
    }
}
