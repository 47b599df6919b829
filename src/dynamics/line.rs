//! The line from end to end at an instant, its motion, and impulses along it.

use super::body::{Body, Spin, is_same_along_all_axes};
use super::element::Element;
use super::flight::Flight;
use super::hold::Hold;
use bevy::math::DVec3;

/// Distance up to which two points count as coincident, as a share of their greatest coordinate. So short a distance may be
/// rounding, and then it gives no direction. It is between the rounding of f64, in which elements are solved, and that of the engine's
/// f32. Pinned by `hard_cases`.
pub(super) const COINCIDENT: f64 = 1e-9;

/// Coordinate up to which [`COINCIDENT`] does not shrink further, m. At the origin it would be zero. Pinned by `hard_cases`.
pub(super) const AT_ORIGIN: f64 = 1e-3;

/// Velocity-dependent quantities of the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Rate of the length, m/s.
    pub axial: f64,
    /// Square of the speed across the line, m²/s².
    pub lateral_square: f64,
    /// Velocity across the line, m/s.
    pub lateral: DVec3,
    /// Acceleration across the line from external forces, m/s².
    pub pushed_across: DVec3,
    /// Axial acceleration of the separation from external forces, m/s².
    pub pushed: f64,
    /// Axial acceleration of the separation from rotation of the arms in free flight, m/s².
    pub arms: f64,
    /// Axial acceleration of the separation from the turning of the line itself (centripetal), m/s².
    pub turning: f64,
}

impl Motion {
    /// Length that the straight half drift of a step added by turning, m. The kick must not count it as stretch, because the
    /// kick already contains the whole turning.
    pub(crate) fn drifted(&self, step: f64) -> f64 {
        step * step / 8.0 * (self.turning + self.arms)
    }

    /// Axial acceleration of the separation from everything but elements, m/s².
    pub(crate) fn outside(&self) -> f64 {
        self.pushed + self.arms + self.turning
    }
}

/// The line from end A to end B at an instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub holds: [Hold; 2],
    pub length: f64,
    pub direction: DVec3,
    /// Inverse effective masses of the two ends along the line, 1/kg.
    pub inverse_masses: [f64; 2],
    /// Inverse of the effective mass along the line, 1/kg: the sum of both.
    pub inverse_mass: f64,
    /// Whether the element is an isotropic oscillator, without a special axis, because its rest length is zero.
    pub isotropic: bool,
    /// Whether the guide gives the direction instead of the ends.
    pub guided: bool,
}

impl Line {
    /// Length without the sign that it may have during a drift; see [`Element::line`]. A guided length keeps its sign.
    pub(crate) fn distance(&self) -> f64 {
        if self.guided {
            self.length
        } else {
            self.length.abs()
        }
    }

    /// Largest coordinate of its ends, m. It determines the resolution of f32 there.
    pub(crate) fn reach(&self) -> f64 {
        let [a, b] = self.holds.map(|hold| hold.position.abs().max_element());
        a.max(b)
    }

    /// Motion of the line at the bodies' present velocities. `step` bounds the centripetal acceleration.
    pub(crate) fn motion(&self, element: &Element, bodies: &[Body], step: f64) -> Motion {
        self.motion_of(element, |index| bodies[index].flight(), step)
    }

    /// Like [`Self::motion`], for bodies whose motion `flight` returns. Several elements at a body then share it.
    #[inline]
    pub(crate) fn motion_of(
        &self,
        element: &Element,
        flight: impl Fn(usize) -> Flight,
        step: f64,
    ) -> Motion {
        if self.guided {
            return self.guided_motion(element, &flight);
        }
        let [a, b] = [0, 1].map(|i| element.ends[i].motion_of(&self.holds[i], &flight));
        let velocity = b.0 - a.0;
        let axial = velocity.dot(self.direction);
        let lateral = velocity - axial * self.direction;
        let lateral_square = lateral.length_squared();
        let arms = (b.2 - a.2).dot(self.direction);
        let pushed = b.1 - a.1;
        let pushed_along = pushed.dot(self.direction);
        Motion {
            axial,
            lateral_square,
            lateral,
            pushed_across: pushed - pushed_along * self.direction,
            pushed: pushed_along,
            arms,
            turning: self.turning(lateral_square, step),
        }
    }

    /// Centripetal acceleration |lateral|²/L, m/s². Bounded where the step does not resolve the turning of the line.
    fn turning(&self, lateral_square: f64, step: f64) -> f64 {
        if self.isotropic || self.guided || lateral_square == 0.0 {
            return 0.0;
        }
        turning(self.length, lateral_square, step)
    }

    /// Whether a push along the line does not change the motion across it: no body turns, and each has the same inverse
    /// mass along all axes.
    pub(crate) fn is_plain(&self, bodies: &[Body]) -> bool {
        self.holds.iter().all(|hold| {
            is_same_along_all_axes(hold.inverse_mass)
                && hold
                    .body
                    .is_none_or(|index| bodies[index].spin == Spin::Ignored)
        })
    }

    /// Motion after a step's external forces and any push along the line, if [`Self::is_plain`].
    pub(crate) fn coasted(&self, before: &Motion, step: f64) -> Motion {
        let lateral = before.lateral + step * before.pushed_across;
        let lateral_square = lateral.length_squared();
        Motion {
            lateral,
            lateral_square,
            turning: self.turning(lateral_square, step),
            ..*before
        }
    }

    /// Mean rate of the length over the step that ends here, m/s. With this rate, damping is of second order.
    pub(crate) fn backward_rate(&self, motion: &Motion, step: f64) -> f64 {
        let rate = if self.isotropic || self.guided {
            motion.axial
        } else {
            backward_rate(self.length, motion.axial, motion.lateral_square, step)
        };
        rate - 0.5 * step * motion.arms
    }

    /// Applies a pair of opposite impulses along the line. A positive impulse (N s) pushes the ends apart.
    pub(crate) fn push(&self, bodies: &mut [Body], impulse: f64) {
        self.impulse(bodies, impulse * self.direction);
    }

    /// Changes the relative velocity across the line by a pair of opposite impulses.
    pub(crate) fn push_across(&self, bodies: &mut [Body], change: DVec3) {
        let Some(across) = change.try_normalize() else {
            return;
        };
        let inverse_mass: f64 = self
            .holds
            .iter()
            .map(|h| h.inverse_mass_along(across, bodies))
            .sum();
        if inverse_mass > 0.0 {
            self.impulse(bodies, change / inverse_mass);
        }
    }

    /// Applies an impulse to end B and its opposite to end A. For a twist, the impulse is angular.
    pub(crate) fn impulse(&self, bodies: &mut [Body], impulse: DVec3) {
        for (hold, sign) in self.holds.iter().zip([-1.0, 1.0]) {
            match hold.body {
                Some(index) if hold.twist => {
                    bodies[index].apply_twist(sign * impulse);
                }
                Some(index) => bodies[index].apply(sign * impulse, hold.arm),
                None => {}
            }
        }
    }
}

/// Centripetal acceleration |lateral|²/L, m/s². Bounded where the step does not resolve the turning of the line.
pub(super) fn turning(length: f64, lateral_square: f64, step: f64) -> f64 {
    let half = 0.5 * step;
    let reach = (length * length + half * half * lateral_square).sqrt();
    (2.0 * lateral_square / (length.abs() + reach)).copysign(length)
}

/// Mean rate of a length over the step that ends with it, m/s, for ends that moved straight.
pub(super) fn backward_rate(length: f64, axial: f64, lateral_square: f64, step: f64) -> f64 {
    let along = length - step * axial;
    if along * length <= 0.0 {
        // The ends passed through each other. The direction of the line reverses, but its rate does not change.
        return axial;
    }
    let before = (along * along + step * step * lateral_square)
        .sqrt()
        .copysign(along);
    (length - before) / step
}
