//! Steps a lone element on bodies that it does not turn, in closed form.
//!
//! Forces along the line do not move the common centre of mass. So only the separation d from end A to end B must be
//! solved: it moves like one point with the effective mass, under the difference of the external accelerations. This is
//! the method of [`super::kick`] without arms and inertia, at a fraction of the cost.

use super::arc::Along;
use super::kick::Memo;
use super::line;
use super::poles::Poles;
use super::thresholds::{converges, is_damper_stiff, is_resolved};
use bevy::math::DVec3;

/// An element, and the properties of its ends that are constant over an engine step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N s/m.
    pub damping: f64,
    /// Rest length, m.
    pub rest_length: f64,
    /// Sum of the inverse masses of both ends, 1/kg; above zero.
    pub inverse_mass: f64,
    /// Acceleration of end B minus that of end A from everything but the element, m/s².
    pub outside: DVec3,
    /// Separation up to which the ends count as coincident, because it may be rounding of the engine's f32, m.
    pub rounding: f64,
}

/// State of the separation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separation {
    /// Vector from end A to end B, m.
    pub d: DVec3,
    /// Rate of `d`, m/s.
    pub v: DVec3,
    /// Last well-defined direction from end A to end B.
    pub direction: Option<DVec3>,
    /// Whether the damper is strong. Then a spring of zero rest length is not treated as isotropic.
    pub(super) stiff_damper: bool,
}

/// The line from end A to end B at an instant, and its motion.
pub(super) struct Line {
    pub direction: DVec3,
    pub length: f64,
    isotropic: bool,
    pub axial: f64,
    pub lateral: DVec3,
    pub lateral_square: f64,
    pub pushed: f64,
}

impl Separation {
    pub(crate) fn new(d: DVec3, v: DVec3, direction: Option<DVec3>) -> Self {
        Self {
            d,
            v,
            direction,
            stiff_damper: false,
        }
    }

    /// Extrapolates from a solution with half as many micro-steps, whose error is so many times as large.
    pub(super) fn extrapolate(&mut self, coarse: &Self, times: f64) {
        self.d += (self.d - coarse.d) / (times - 1.0);
        self.v += (self.v - coarse.v) / (times - 1.0);
    }
}

impl Pair {
    /// (ω h)².
    pub(super) fn stiffness_number(&self, step: f64) -> f64 {
        stiffness_number(self.stiffness, self.inverse_mass, step)
    }

    pub(super) fn poles(&self, step: f64, memo: &mut Memo) -> Poles {
        let damping = self.damping * self.inverse_mass * step;
        memo.poles(self.stiffness_number(step), damping / 2.0)
    }

    pub(super) fn microsteps(
        &self,
        state: &mut Separation,
        time: f64,
        count: u32,
        memo: &mut Memo,
    ) {
        let step = time / f64::from(count);
        let poles = self.poles(step, memo);
        let mut aimed = self.aim(state, step);
        self.map(state, aimed, &poles, step, |axial, offset, speed| {
            ((axial - offset) / poles.speed, 1.0 / speed)
        });
        for _ in 0..count {
            state.d += 0.5 * step * state.v;
            self.kick(state, &poles, step);
            state.d += 0.5 * step * state.v;
            aimed = self.aim(state, step);
        }
        self.map(state, aimed, &poles, step, |axial, offset, speed| {
            (poles.speed * axial + offset, speed)
        });
    }

    /// Stores on which side of end A end B is (see `Element::aim`). Returns direction and length of the line; none if the
    /// ends coincide.
    fn aim(&self, state: &mut Separation, step: f64) -> Option<(DVec3, f64)> {
        let decay = self.damping * self.inverse_mass * step;
        state.stiff_damper = is_damper_stiff(self.stiffness_number(step), decay);
        let length = state.d.length();
        if length <= self.rounding {
            return None;
        }
        let direction = length.recip() * state.d;
        state.direction = Some(direction);
        Some((direction, length))
    }

    /// Returns the line, or `None` if the ends coincide and no direction is known. The length is negative while end B is
    /// on the far side of end A during a drift.
    pub(super) fn line(&self, state: &Separation) -> Option<Line> {
        let distance = state.d.length();
        if distance <= self.rounding {
            let direction = match state.direction {
                Some(side) => side,
                None if self.rest_length == 0.0 => {
                    // Relative velocity and acceleration give the direction. If both are zero, any axis will do.
                    let hint = state.v + self.outside;
                    hint.try_normalize().unwrap_or(DVec3::Y)
                }
                None => return None,
            };
            return Some(self.along(state, direction, state.d.dot(direction)));
        }
        let length = match state.direction {
            Some(side) => distance.copysign(state.d.dot(side)),
            None => distance,
        };
        Some(self.along(state, length.recip() * state.d, length))
    }

    /// Whether forces act along the line. Without an axis, the element is an isotropic oscillator.
    pub(super) fn has_axis(&self, state: &Separation) -> bool {
        self.rest_length != 0.0 || state.stiff_damper
    }

    /// Splits the motion of the ends into parts along and across a line.
    fn along(&self, state: &Separation, direction: DVec3, length: f64) -> Line {
        let axial = state.v.dot(direction);
        let lateral = state.v - axial * direction;
        Line {
            direction,
            length,
            isotropic: !self.has_axis(state),
            axial,
            lateral,
            lateral_square: lateral.length_squared(),
            pushed: self.outside.dot(direction),
        }
    }

    /// Applies the kick after the first half drift.
    fn kick(&self, state: &mut Separation, poles: &Poles, step: f64) {
        let Some(line) = self.line(state) else {
            state.v += step * self.outside;
            return;
        };
        let resolved = is_resolved(self.stiffness_number(step));
        if line.isotropic && !resolved {
            // The line turns too fast to separate axial from lateral motion, so both lose the same share.
            state.v -= poles.loss * line.lateral;
        }
        let (square, rest) = (self.stiffness * self.inverse_mass, self.rest_length);
        let along = Along {
            elastic: |length| [square * (length - rest), square],
            braked: poles.loss / step * line.backward_rate(step),
            loss: poles.loss,
            resolved,
        };
        let restoring = |_| poles.restoring;
        if line.isotropic {
            self.kick_straight(state, &line, step, &along, restoring);
        } else {
            self.kick_in_arc(state, &line, step, &along, restoring);
        }
    }

    /// Maps the velocity between the true and the stepped motion; see `kick::map_velocity`. `aimed` is the line that
    /// [`Self::aim`] returned. `to` returns the new axial velocity and the factor for the lateral velocity.
    fn map(
        &self,
        state: &mut Separation,
        aimed: Option<(DVec3, f64)>,
        poles: &Poles,
        step: f64,
        to: impl Fn(f64, f64, f64) -> (f64, f64),
    ) {
        let line = match aimed {
            Some((direction, length)) => self.along(state, direction, length),
            None => match self.line(state) {
                Some(line) => line,
                None => return,
            },
        };
        let outside = line.pushed + self.turning_at_end(&line, step);
        let residual_acceleration =
            self.stiffness * self.inverse_mass * (line.length - self.rest_length) - outside;
        let z = self.stiffness_number(step);
        let speed = if line.isotropic && is_resolved(z) {
            poles.speed_across(z)
        } else {
            poles.speed
        };
        let (axial, across) = to(line.axial, poles.skew * step * residual_acceleration, speed);
        state.v += (axial - line.axial) * line.direction;
        if line.isotropic {
            state.v += (across - 1.0) * line.lateral;
        }
    }

    /// Centripetal acceleration |lateral|²/L at an end of the step, m/s². Bounded where the step does not resolve the turning of
    /// the line.
    pub(super) fn turning_at_end(&self, line: &Line, step: f64) -> f64 {
        let length = line.length;
        if line.isotropic || length.abs() <= self.rounding {
            return 0.0;
        }
        let turned = step * step / (length * length) * line.lateral_square;
        line.lateral_square / (length * (0.25 * turned).max(1.0))
    }

    /// Whether a step resolves oscillation, decay, and the turning of the line.
    pub(super) fn resolved(&self, state: &Separation, step: f64) -> bool {
        let Some(line) = self.line(state) else {
            return false;
        };
        let turned = step * step * line.lateral_square;
        let decay = self.damping * self.inverse_mass * step;
        converges(self.stiffness_number(step), decay)
            && (line.isotropic || turned < line.length * line.length)
    }

    /// Kinetic and stored energy about the common centre of mass, J, and both together with the potential in the external
    /// forces.
    pub(super) fn energies(&self, state: &Separation) -> [f64; 2] {
        let stretch = state.d.length() - self.rest_length;
        let scale = 0.5
            * (self.stiffness * stretch * stretch + state.v.length_squared() / self.inverse_mass);
        [scale, scale - self.outside.dot(state.d) / self.inverse_mass]
    }
}

impl Line {
    /// Mean rate of the length over the step that ends here, m/s. With this rate, damping is of second order.
    pub(super) fn backward_rate(&self, step: f64) -> f64 {
        if self.isotropic {
            return self.axial;
        }
        line::backward_rate(self.length, self.axial, self.lateral_square, step)
    }
}

/// (ω h)².
pub(super) fn stiffness_number(stiffness: f64, inverse_mass: f64, step: f64) -> f64 {
    stiffness * inverse_mass * step * step
}
