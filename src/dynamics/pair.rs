//! A lone element between ends that do not turn: the closed form on the separation alone.
//!
//! What acts along the line leaves the common centre of mass alone, so the whole motion is that of one
//! point, the separation d from end A to end B with the effective mass, under the difference of the
//! outside accelerations. It is [`super::kick`] without arms and inertia, at a fraction of the price.

use super::kick::Memo;
use super::law::Law;
use super::line;
use super::nonlinear_pair::NonlinearPair;
use super::poles::{Poles, RESOLVED_PHASE};
use super::resolution::{EXTRAPOLATION_LIMIT, RESOLVED};
use crate::functions::exp;
use bevy::math::DVec3;

/// c h/m above which a step's energy is watched; see [`super::guard`].
const STRONG: f64 = 0.5;

/// c h/m beyond which energy-keeping steps would turn a motion round instead of stopping it.
const FIERCE: f64 = 40.0;

/// Share of kinetic and stored energy that a step may gain before it is taken again.
const GAIN: f64 = 0.02;

/// The element and what is constant about its ends over an engine step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
    /// m.
    pub rest_length: f64,
    /// Of both ends together, 1/kg; above zero.
    pub inverse_mass: f64,
    /// Acceleration of end B less that of end A by everything but the element.
    pub outside: DVec3,
    /// Separation below which it is rounding of the engine's f32.
    pub rounding: f64,
}

/// State of the separation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Separation {
    /// From end A to end B.
    pub d: DVec3,
    /// Its rate.
    pub v: DVec3,
    /// Last well-defined direction.
    pub direction: Option<DVec3>,
    /// A strong damper: then a spring of zero rest length has an axis after all.
    pub(super) stiff_damper: bool,
}

/// The line at an instant, and what it does.
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

    /// Goes a third of the way on from a coarser solution.
    pub(super) fn towards(&mut self, coarse: &Self) {
        self.d += (self.d - coarse.d) / 3.0;
        self.v += (self.v - coarse.v) / 3.0;
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

    /// Whether a step's energy is watched.
    fn is_watched(&self, step: f64) -> bool {
        is_watched(
            self.damping * self.inverse_mass * step,
            self.stiffness_number(step),
        )
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
        let before = self.is_watched(step).then(|| (self.energy(state), *state));
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
        if let Some((Some(energy), start)) = before {
            self.keep_energy(state, energy, &start, time, memo);
        }
    }

    /// Notes on which side of end A end B is (see `Element::aim`), and returns the line's direction and
    /// length, unless the ends coincide.
    fn aim(&self, state: &mut Separation, step: f64) -> Option<(DVec3, f64)> {
        let resolved = self.stiffness_number(step) < 4.0;
        state.stiff_damper = resolved && self.damping * self.inverse_mass * step > 0.5;
        let length = state.d.length();
        if length <= self.rounding {
            return None;
        }
        let direction = length.recip() * state.d;
        state.direction = Some(direction);
        Some((direction, length))
    }

    /// The line, or `None` where the ends coincide and nothing says which way to push. Its length is
    /// negative while end B is on the far side of end A during a drift.
    pub(super) fn line(&self, state: &Separation) -> Option<Line> {
        let distance = state.d.length();
        if distance <= self.rounding {
            let direction = match state.direction {
                Some(side) => side,
                None if self.rest_length == 0.0 => {
                    // Whatever acts on the ends decides; with nothing acting any axis will do.
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

    /// What the ends do along a line.
    fn along(&self, state: &Separation, direction: DVec3, length: f64) -> Line {
        let axial = state.v.dot(direction);
        let lateral = state.v - axial * direction;
        Line {
            direction,
            length,
            isotropic: self.rest_length == 0.0 && !state.stiff_damper,
            axial,
            lateral,
            lateral_square: lateral.length_squared(),
            pushed: self.outside.dot(direction),
        }
    }

    /// The change of velocity at the half drift; the formulas are [`super::kick`]'s.
    fn kick(&self, state: &mut Separation, poles: &Poles, step: f64) {
        let Some(line) = self.line(state) else {
            state.v += step * self.outside;
            return;
        };
        let rate = line.backward_rate(step);
        if line.isotropic && !is_resolved(self.stiffness_number(step)) {
            // The line turns too fast to tell along from across: what is lost along it is lost across.
            state.v -= poles.loss * line.lateral;
        }
        // The mean of before and after the kick makes the step its own mirror image in time.
        let across = self.outside - line.pushed * line.direction;
        let after = (line.lateral + step * across).length_squared();
        let turning = 0.5 * (line.turning(line.lateral_square, step) + line.turning(after, step));
        let outside = line.pushed + turning;
        // The straight half drift lengthened the line by that already.
        let length = line.length - step * step / 8.0 * turning;
        let residual_acceleration =
            self.stiffness * self.inverse_mass * (length - self.rest_length) - outside;
        let total = -poles.restoring * residual_acceleration - poles.loss / step * rate;
        state.v += step * (total - outside) * line.direction + step * self.outside;
    }

    /// The change of velocity between the true motion and the stepped one: see `kick::map_velocity`.
    /// `aimed` is the line as [`Self::aim`] saw it, `to` gives the new axial velocity and the factor across the line.
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
        let outside = line.pushed + line.turning(line.lateral_square, step);
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

    /// Whether a step resolves oscillation, decay, and the turning of the line.
    pub(super) fn resolved(&self, state: &Separation, step: f64) -> bool {
        let Some(line) = self.line(state) else {
            return false;
        };
        let turned = step * step * line.lateral_square;
        self.stiffness_number(step) < EXTRAPOLATION_LIMIT * EXTRAPOLATION_LIMIT
            && self.damping * self.inverse_mass * step < EXTRAPOLATION_LIMIT
            && (line.isotropic || turned < line.length * line.length)
    }

    /// Energy of the motion about the common centre of mass, in the outside forces.
    fn energy(&self, state: &Separation) -> Option<f64> {
        let stretch = self.line(state)?.length - self.rest_length;
        let motion = 0.5 * state.v.length_squared() - self.outside.dot(state.d);
        Some(0.5 * self.stiffness * stretch * stretch + motion / self.inverse_mass)
    }

    /// A step that went too far for its energy, because it follows neither the motion nor its decay, is taken
    /// again by [`super::nonlinear_pair`], which keeps energy at any stiffness. Very strong damping is not its field; there
    /// the motion along the line is over so soon that its exact solution is taken, and what surplus is left comes out
    /// of that motion.
    fn keep_energy(
        &self,
        state: &mut Separation,
        before: f64,
        start: &Separation,
        time: f64,
        memo: &mut Memo,
    ) {
        let surplus = |state: &Separation| self.energy(state).map_or(0.0, |after| after - before);
        let scale = before.abs().max(self.scale(start));
        if surplus(state) <= 1e-9 * before.abs() {
            return;
        }
        let damped = self.damping * self.inverse_mass * time;
        if surplus(state) > GAIN * scale {
            let kept = if damped < FIERCE {
                let law = Law::linear(self.stiffness, self.damping);
                let mut again = NonlinearPair::new(self, &law, *start, memo);
                again.keep_energy(time);
                again.state
            } else {
                self.creep(start, time)
            };
            if surplus(&kept) < surplus(state) {
                *state = Separation {
                    stiff_damper: start.stiff_damper,
                    ..kept
                };
            }
        }
        let surplus = surplus(state);
        if damped >= STRONG
            && surplus > 1e-9 * before.abs()
            && let Some(line) = self.line(state)
        {
            let rate = line.axial;
            let left = (rate * rate - 2.0 * self.inverse_mass * surplus)
                .max(0.0)
                .sqrt();
            state.v += (left.copysign(rate) - rate) * line.direction;
        }
    }

    /// The exact overdamped motion along the line as it is at the start, beside a straight one across it.
    fn creep(&self, start: &Separation, time: f64) -> Separation {
        let Some(line) = self.line(start) else {
            return *start;
        };
        let decay = 0.5 * self.damping * self.inverse_mass;
        let square = self.stiffness * self.inverse_mass;
        let spread = (decay * decay - square).max(0.0).sqrt();
        let fast = decay + spread;
        let slow = square / fast;
        let stretch = line.length - self.rest_length;
        // Where it creeps to, or without a spring how fast it creeps.
        let (rest, flow) = if square > 0.0 {
            (line.pushed / square, 0.0)
        } else {
            (0.0, line.pushed / fast)
        };
        let (away, rate) = (stretch - rest, line.axial - flow);
        let [slowly, hastily] = [slow, fast].map(|rate| exp(-rate * time));
        let (even, odd) = if spread * time > 1e-4 {
            (0.5 * (slowly + hastily), 0.5 * (slowly - hastily) / spread)
        } else {
            (slowly, time * slowly)
        };
        let left = even * away + odd * (rate + decay * away);
        let axial = flow + even * rate - odd * (decay * rate + square * away);
        let moved = rest + flow * time + left - stretch;
        let d = start.d + moved * line.direction + time * line.lateral;
        let direction = d.try_normalize().filter(|_| d.length() > self.rounding);
        Separation {
            d,
            v: axial * line.direction + line.lateral,
            direction: direction.or(start.direction),
            stiff_damper: start.stiff_damper,
        }
    }

    /// Kinetic and stored energy.
    fn scale(&self, state: &Separation) -> f64 {
        let stored = self.line(state).map_or(0.0, |line| {
            0.5 * self.stiffness * (line.length - self.rest_length).powi(2)
        });
        stored + 0.5 * state.v.length_squared() / self.inverse_mass
    }
}

impl Line {
    /// |lateral|²/L, bounded where the line turns further than the step can follow.
    pub(super) fn turning(&self, lateral_square: f64, step: f64) -> f64 {
        if self.isotropic || lateral_square == 0.0 {
            return 0.0;
        }
        line::turning(self.length, lateral_square, step)
    }

    /// Length change over the step that led here, divided by the step: with it damping is second order.
    pub(super) fn backward_rate(&self, step: f64) -> f64 {
        if self.isotropic {
            return self.axial;
        }
        line::backward_rate(self.length, self.axial, self.lateral_square, step)
    }
}

/// (ω h)².
fn stiffness_number(stiffness: f64, inverse_mass: f64, step: f64) -> f64 {
    stiffness * inverse_mass * step * step
}

/// Whether the energy of a step is watched: c h/m, and (ω h)².
fn is_watched(damping: f64, stiffness_number: f64) -> bool {
    damping >= STRONG || !is_resolved(stiffness_number)
}

/// The poles of an element whose micro-steps of so long are kicks along the line and nothing else: then it can go several at
/// once in [`super::lanes`]. Its rest length is above zero. It takes no more micro-steps to be resolved, where it may.
#[inline(always)]
pub(crate) fn plain_poles(
    [stiffness, damping]: [f64; 2],
    inverse_mass: f64,
    (step, may_resolve): (f64, bool),
    memo: &mut Memo,
) -> Option<Poles> {
    let damping = damping * inverse_mass * step;
    let stiffness = stiffness_number(stiffness, inverse_mass, step);
    let finer = may_resolve && stiffness > RESOLVED;
    (!finer && !is_watched(damping, stiffness)).then(|| memo.poles(stiffness, damping / 2.0))
}

fn is_resolved(z: f64) -> bool {
    z < RESOLVED_PHASE * RESOLVED_PHASE
}
