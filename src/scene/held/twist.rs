//! Torsion inside the engine's solver.
//!
//! A joint of Rapier acts about an axis that is fixed to the first body. A torsion element acts about the gradient of its twist,
//! which follows both bodies. So the joint gets the gradient at the middle of the step. After the step, the element takes over
//! the twist that the bodies show, as far as it is valid. If the bodies are tilted by nearly half a turn, a twist has no meaning.
//! There the spring slips instead of gaining energy.

use crate::dynamics::body::{Body, shortest, turn};
use crate::dynamics::element::Element;
use crate::dynamics::line::Line;
use crate::functions::asin;
use bevy::math::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Greatest leverage of a gradient, reached at 140° of tilt. Beyond that, the gradient turns faster than a step can
/// follow. Pinned by `ground::torsion`.
const LEVERAGE: f64 = 3.0;

/// Damping of a torsion element for each radian that its bodies turn across its axis in a step, in units of stiffness · step. The
/// gradient changes its direction during the step, by which a stiff element would gain energy. Pinned by `ground::torsion`.
const ACROSS: f64 = 1.0;

/// Leverage up to which a twist is always valid: 120° of tilt. Pinned by `ground::torsion`.
const UPRIGHT: f64 = 2.0;

/// Energy that a step may gain in any case, as a share of the energy of the bodies' relative
/// rotation. Pinned by `ground::torsion`.
const SURE: f64 = 1e-3;

/// Data of a torsion element for one step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turn {
    /// Rotation of body B in the frame of body A, at the start of the step.
    pub relative: DQuat,
    /// Axis of the joint, a unit vector in the frame of body A.
    pub axis: DVec3,
    /// Change of the twist per rotation about the axis, rad/rad.
    pub leverage: f64,
    /// Relative rotation of the bodies across the axis in the step, rad.
    across: f64,
    /// Energy of the relative rotation of the bodies, J.
    motion: f64,
    /// Damping with respect to the twist that the joint was given, N m s/rad.
    pub damping: f64,
}

impl Turn {
    /// Data for an element from the gradient of its twist at the middle of a step. Returns none if the twist has no meaning.
    pub(crate) fn of(element: &Element, line: &Line, bodies: &[Body], time: f64) -> Option<Self> {
        let [a, b] = element
            .ends
            .each_ref()
            .map(|end| (end.rotation(bodies), end.angular_velocity(bodies)));
        let [middle_a, middle_b] = [a, b].map(|(now, spin)| turn(0.5 * time * spin) * now);
        let gradient = element.twist_gradient([middle_a, middle_b])?;
        let length = gradient.length();
        let axis = middle_a.inverse() * (gradient / length);
        let along = a.0 * axis;
        let relative = b.1 - a.1;
        let across = relative - relative.dot(along) * along;
        Some(Self {
            relative: a.0.inverse() * b.0,
            axis,
            leverage: length.min(LEVERAGE),
            across: time * across.length(),
            motion: 0.5 * relative.length_squared() * line.direction.length_squared()
                / line.inverse_mass.max(f64::MIN_POSITIVE),
            damping: 0.0,
        })
    }

    /// Least damping divided by the stiffness, s. `time` is the duration of the step.
    pub(crate) fn across_damping(&self, time: f64) -> f64 {
        ACROSS * self.across * self.leverage * time
    }

    /// Rotation of the bodies about the joint's axis in the step, rad. `relative` is the rotation of B in the frame of A now.
    fn turned(&self, relative: DQuat) -> f64 {
        let by = shortest(relative * self.relative.inverse());
        2.0 * asin(by.xyz().dot(self.axis).clamp(-1.0, 1.0))
    }

    /// Returns the twist after a step, and whether it counts as slipped: it differs from the rotation of the bodies, or their
    /// tilt is too large to be sure. `before` is the twist at the start of the step, `seen` the twist that the bodies show, up to
    /// full turns. `slipped` is the state before the step; `energy` gives the stored energy at a twist.
    pub(crate) fn arrive(
        &self,
        [before, seen]: [f64; 2],
        relative: DQuat,
        slipped: bool,
        time: f64,
        energy: impl Fn(f64) -> f64,
    ) -> (f64, bool) {
        let by = self.turned(relative);
        let carried = before + self.leverage * by;
        let off = seen - carried;
        let off = off - TAU * (off / TAU).round();
        let whole = carried + off;
        // The energy that the element would gain must come from the energy that its damping took.
        let won = energy(whole) - energy(carried);
        if !won.is_finite() {
            // A custom law gives no number here. The turn itself is known.
            return (whole, true);
        }
        let taken = self.damping * (self.leverage * by).powi(2) / time;
        let upright = self.leverage <= UPRIGHT;
        let spare = if upright && !slipped {
            SURE * self.motion
        } else {
            0.0
        };
        if won <= taken + spare {
            (whole, !upright)
        } else {
            (carried + off * (taken / won), true)
        }
    }
}
