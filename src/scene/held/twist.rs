//! Torsion inside the engine's solver.
//!
//! Rapier turns two bodies about an axis that is fixed to the first. What a torsion element acts about is the gradient of
//! its twist, which follows both bodies; so it is the gradient in the middle of the step that is ordered. What the bodies
//! have really twisted beyond what was ordered is taken in afterwards, as far as that is true: where they are tilted by
//! nearly half a turn a twist has no meaning, and there the spring slips rather than win energy.

use crate::dynamics::body::{Body, shortest, turn};
use crate::dynamics::element::Element;
use crate::dynamics::line::Line;
use crate::functions::asin;
use bevy::math::{DQuat, DVec3};
use std::f64::consts::TAU;

/// Greatest leverage of a gradient, reached at 140° of tilt: beyond it turns faster than a step can follow.
/// Pinned by `ground::torsion`.
const LEVERAGE: f64 = 3.0;

/// Damping of a torsion element for each radian that its bodies turn across its axis in a step, in units of
/// stiffness · step: the gradient changes its direction meanwhile, and a stiff element would win by that.
/// Pinned by `ground::torsion`.
const ACROSS: f64 = 1.0;

/// Leverage up to which a twist is true whatever it is: 120° of tilt. Pinned by `ground::torsion`.
const UPRIGHT: f64 = 2.0;

/// Share of the energy of the bodies' turning that a step may be off by, whatever it was. Pinned by `ground::torsion`.
const SURE: f64 = 1e-3;

/// What a torsion element is to do in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turn {
    /// Rotation of body B in the frame of body A, at the start.
    pub relative: DQuat,
    /// What it acts about, a unit vector in the frame of body A.
    pub axis: DVec3,
    /// Twist for each radian about it.
    pub leverage: f64,
    /// How far the bodies turn across it in the step, rad.
    across: f64,
    /// Energy of their turning, J.
    motion: f64,
    /// Damping that is ordered, N m s/rad.
    pub damping: f64,
}

impl Turn {
    /// The gradient of an element's twist in the middle of a step; none where it has no meaning.
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

    /// Least damping in units of stiffness, s.
    pub(crate) fn across_damping(&self, time: f64) -> f64 {
        ACROSS * self.across * self.leverage * time
    }

    /// How far the bodies have turned about what was ordered, rad, now that B stands like this in the frame of A.
    fn turned(&self, relative: DQuat) -> f64 {
        let by = shortest(relative * self.relative.inverse());
        2.0 * asin(by.xyz().dot(self.axis).clamp(-1.0, 1.0))
    }

    /// The twist after a step that began with `before`, where it now seems to be `seen` within some turns, and whether it
    /// still is another one. `slipped` if it was before the step; `energy` is what the element stores at a twist.
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
        // What would be won has to come from what its damping took.
        let won = energy(whole) - energy(carried);
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
