//! The line from end to end at an instant, what it does, and pushing along it.

use super::body::{Body, Spin};
use super::element::{Element, Hold};
use bevy::math::DVec3;

/// Velocity-dependent quantities of the line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    /// Rate of the length.
    pub axial: f64,
    /// Square of the speed across the line.
    pub lateral_square: f64,
    /// Velocity across the line.
    pub lateral: DVec3,
    /// Acceleration across it by outside forces.
    pub pushed_across: DVec3,
    /// Axial acceleration of the separation by outside forces,
    pub pushed: f64,
    /// by the arms' turning in free flight,
    pub arms: f64,
    /// and by the turning of the line itself.
    pub turning: f64,
}

impl Motion {
    /// What the straight half drift of a step added to the length by turning; the kick must not take
    /// that for stretch, for it answers all turning at once.
    pub(crate) fn drifted(&self, step: f64) -> f64 {
        step * step / 8.0 * (self.turning + self.arms)
    }

    /// Axial acceleration of the separation by everything but elements.
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
    /// Inverse of the effective mass along the line, 1/kg.
    pub inverse_mass: f64,
    /// Zero rest length: the spring is an isotropic oscillator and has no special axis.
    pub isotropic: bool,
    /// The direction is given; it is not that from end to end.
    pub guided: bool,
}

impl Line {
    /// Length with the sign it has at rest.
    pub(crate) fn distance(&self) -> f64 {
        if self.guided {
            self.length
        } else {
            self.length.abs()
        }
    }

    /// Largest coordinate of its ends, which says how coarse their f32 is.
    pub(crate) fn reach(&self) -> f64 {
        let [a, b] = self.holds.map(|hold| hold.position.abs().max_element());
        a.max(b)
    }

    /// What the line does at the bodies' present velocities; `step` resolves the turning.
    pub(crate) fn motion(&self, element: &Element, bodies: &[Body], step: f64) -> Motion {
        if self.guided {
            return self.guided_motion(element, bodies);
        }
        let [a, b] = [0, 1].map(|i| element.ends[i].motion(&self.holds[i], bodies));
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

    /// |lateral|²/L, bounded where the line turns further than the step can follow.
    fn turning(&self, lateral_square: f64, step: f64) -> f64 {
        if self.isotropic || self.guided || lateral_square == 0.0 {
            return 0.0;
        }
        turning(self.length, lateral_square, step)
    }

    /// Whether pushing along the line leaves the motion across it alone: no body turns, or is freer along
    /// one axis than another.
    pub(crate) fn is_plain(&self, bodies: &[Body]) -> bool {
        self.holds.iter().all(|hold| {
            let w = hold.inverse_mass;
            w.x == w.y
                && w.y == w.z
                && hold
                    .body
                    .is_none_or(|index| bodies[index].spin == Spin::Ignored)
        })
    }

    /// The motion after a step's outside forces and any push along the line, for a plain one.
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

    /// Length change over the step that led here, divided by the step: with it damping is second order.
    pub(crate) fn backward_rate(&self, motion: &Motion, step: f64) -> f64 {
        let rate = if self.isotropic || self.guided {
            motion.axial
        } else {
            backward_rate(self.length, motion.axial, motion.lateral_square, step)
        };
        rate - 0.5 * step * motion.arms
    }

    /// An impulse pair along the line, positive pushing the ends apart.
    pub(crate) fn push(&self, bodies: &mut [Body], impulse: f64) {
        self.impulse(bodies, impulse * self.direction);
    }

    /// Changes the relative velocity across the line.
    pub(crate) fn push_across(&self, bodies: &mut [Body], change: DVec3) {
        let Some(across) = change.try_normalize() else {
            return;
        };
        let inverse_mass: f64 = self
            .holds
            .iter()
            .map(|h| h.inverse_mass_along(across))
            .sum();
        if inverse_mass > 0.0 {
            self.impulse(bodies, change / inverse_mass);
        }
    }

    /// An impulse on end B and its opposite on end A.
    pub(crate) fn impulse(&self, bodies: &mut [Body], impulse: DVec3) {
        for (hold, sign) in self.holds.iter().zip([-1.0, 1.0]) {
            match hold.body {
                Some(index) if hold.twist => {
                    bodies[index].apply_twist(sign * impulse, hold.inverse_inertia);
                }
                Some(index) => bodies[index].apply(sign * impulse, hold.arm, hold.inverse_inertia),
                None => {}
            }
        }
    }
}

/// |lateral|²/L, bounded where the line turns further than the step can follow.
pub(super) fn turning(length: f64, lateral_square: f64, step: f64) -> f64 {
    let half = 0.5 * step;
    let reach = (length * length + half * half * lateral_square).sqrt();
    (2.0 * lateral_square / (length.abs() + reach)).copysign(length)
}

/// Change of a length over the step that led there, divided by the step, for ends that moved straight.
pub(super) fn backward_rate(length: f64, axial: f64, lateral_square: f64, step: f64) -> f64 {
    let along = length - step * axial;
    if along * length <= 0.0 {
        // Through the centre: the line flips, its rate does not.
        return axial;
    }
    let before = (along * along + step * step * lateral_square)
        .sqrt()
        .copysign(along);
    (length - before) / step
}
