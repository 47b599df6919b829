//! Steps a lone element with a force law, between ends that do not turn.
//!
//! Where the law is smooth over a micro-step and the step resolves it, the step is that of [`super::pair`], with the law's
//! slopes as stiffness and damping, and with its true force. For a smooth potential this is the force-gradient kick of
//! M. Takahashi and M. Imada (1984), so long runs conserve energy. Elsewhere (a rope becomes taut, a stop is hit, the step is
//! too long for the stiffness) the mean force over the step does exactly the work of the law's energy. This is the step of
//! D. Greenspan and R. LaBudde (1974), which conserves energy and angular momentum for any law and any step.

mod motion;
mod pair_view;

pub(crate) use pair_view::PairView;

use super::arc::Along;
use super::kick::Memo;
use super::law::Law;
use super::network::{damper_placement, steep};
use super::pair::{Pair, Separation};
use super::poles::{UNRESOLVED_DECAY, decay_ratio, unresolved};
use super::thresholds::STRONG;
use crate::functions::exp_m1;
use bevy::math::DVec3;

/// (ω h)² up to which the kick is used for a law without kinks. Pinned by
/// `nonlinear_pair::tests::duffing_and_the_cubic_spring_keep_their_periods`.
const SMOOTH: f64 = 2.0;
/// (ω h)² up to which the kick is used for a law with kinks. The energy of kicked motion oscillates a little, and at a kink the
/// momentary difference would become permanent. Pinned by `nonlinear_pair::tests::no_law_gains_energy_at_any_step`.
const BENT: f64 = 0.04;
/// ω h that the energy-conserving steps aim at. Pinned by
/// `laws::one_way::a_strut_with_a_limit_and_a_damper_gives_a_cart_all_of_its_push`.
const FINE: f64 = 0.2;
/// Least and greatest number of energy-conserving steps in a micro-step: two where damping is split between them, and so many that the
/// greatest costs a few microseconds. Pinned by `nonlinear_pair::tests::no_law_gains_energy_at_any_step`.
const PARTS: [f64; 2] = [2.0, 16.0];
/// Number of iterations that estimate how far the motion can reach. Pinned by
/// `nonlinear_pair::tests::no_law_gains_energy_at_any_step`.
const REACHES: usize = 6;
/// Greatest number of bisections and secants that find the length at the end of a step. Pinned by
/// `nonlinear_pair::tests::no_law_gains_energy_at_any_step`.
const TRIES: usize = 80;

/// Share of a linear damper's force above which no limit cuts it. No tuning constant: it only allows for rounding.
const WHOLE: f64 = 0.999;

/// A pair under a force law, and its present state.
pub(crate) struct NonlinearPair<'a> {
    pub pair: &'a Pair,
    pub law: &'a Law,
    pub state: Separation,
    /// Duration of the whole step, s.
    pub time: f64,
    /// Whether all micro-steps of the last step were kicks.
    kicked: bool,
    memo: &'a mut Memo,
    saved: [Separation; 3],
}

impl<'a> NonlinearPair<'a> {
    pub(crate) fn new(
        pair: &'a Pair,
        law: &'a Law,
        mut state: Separation,
        memo: &'a mut Memo,
    ) -> Self {
        // A law's slope along the line differs from that across it, so it is not isotropic even at zero rest length.
        state.stiff_damper = true;
        Self {
            pair,
            law,
            state,
            time: 0.0,
            kicked: false,
            memo,
            saved: [state; 3],
        }
    }

    /// Energy about the common centre of mass, J: kinetic, stored, and potential in the external forces.
    pub(crate) fn energy(&self) -> f64 {
        let Separation { d, v, .. } = self.state;
        let motion = 0.5 * v.length_squared() - self.pair.outside.dot(d);
        self.law.elastic(d.length(), self.rest_length()).energy + motion / self.pair.inverse_mass
    }

    fn rest_length(&self) -> f64 {
        self.pair.rest_length
    }

    /// Linear damping that the law has at a length and rate, if damping is light there. It is zero where a limit or a slack rope
    /// cuts the damper or a part of it.
    fn light_damping(&self, length: f64, rate: f64, step: f64) -> Option<f64> {
        let drag = self.law.drag(length, self.rest_length(), rate);
        let is_light = steep(drag, rate) * self.pair.inverse_mass * step < STRONG;
        let linear = self.law.drag.linear().unwrap_or(0.0);
        let is_whole = drag.force.abs() >= WHOLE * (linear * rate).abs();
        is_light.then(|| {
            if is_whole {
                drag.slope.min(linear)
            } else {
                0.0
            }
        })
    }

    /// Whether the law has no kink between two lengths.
    fn is_one_part(&self, [from, to]: [f64; 2]) -> bool {
        let rest = self.rest_length();
        from > 0.0 && to > 0.0 && self.law.part(from, rest) == self.law.part(to, rest)
    }

    /// Linear damping between two lengths, if the law has no kink there and damping is light and the same at both.
    fn smooth_damping(&self, ends: [f64; 2], rate: f64, step: f64) -> Option<f64> {
        if !self.is_one_part(ends) {
            return None;
        }
        let [first, last] = ends.map(|length| self.light_damping(length, rate, step));
        first.filter(|_| first == last)
    }

    /// Whether a step resolves the stiffness at all lengths that the motion can reach with its present energy. Frequent
    /// changes between both kinds of step would accumulate the energy oscillations of the kick.
    fn is_resolved_in_reach(&self, step: f64) -> bool {
        let (law, pair, rest) = (self.law, self.pair, self.rest_length());
        let weight = pair.inverse_mass * step * step;
        let length = self.state.d.length();
        let energy = law.elastic(length, rest).energy
            + 0.5 * self.state.v.length_squared() / pair.inverse_mass;
        let pushed = pair.outside.length() / pair.inverse_mass;
        let mut reach = (length - rest).abs().max(step * self.state.v.length());
        let mut ends = [rest; 2];
        for _ in 0..REACHES {
            ends = [rest - reach, rest + reach];
            let most = energy + pushed * reach;
            let stored = ends.map(|length| law.elastic(length, rest).energy);
            let stored = stored[0].min(stored[1]);
            if stored >= most || stored <= 0.0 {
                break;
            }
            // Exact if the stored energy grows with the fourth power of the reach. If it grows with the second power, half of
            // the error of the logarithm remains.
            reach *= (most / stored).sqrt().sqrt();
        }
        let limit = if law.is_bent() { BENT } else { SMOOTH };
        law.stiffest(ends, rest) * weight < limit
    }

    /// Advances by `time` seconds in the greatest number of energy-conserving steps.
    pub(super) fn keep_energy(&mut self, time: f64) {
        for _ in 0..PARTS[1] as u32 {
            self.keep_energy_through(time / PARTS[1]);
        }
    }

    fn microstep(&mut self, step: f64, resolved: bool) {
        let before = self.state;
        let from = before.d.length();
        if let Some(line) = self.pair.line(&before) {
            let ahead = (before.d + step * before.v).length();
            let turns = step * step * line.lateral_square > 0.25 * from * from;
            let smooth = self.smooth_damping([from, ahead], line.axial, step);
            if let Some(damping) = smooth.filter(|_| resolved && !turns) {
                self.kick_through(step, damping);
                let to = self.state.d.length();
                let rate = self.rate(to);
                if self.is_one_part([from, to]) && self.light_damping(to, rate, step) == smooth {
                    return;
                }
                self.state = before;
            }
        }
        self.kicked = false;
        let ahead = (before.d + step * before.v).length();
        let stiffest = self.law.stiffest([from, ahead], self.rest_length());
        let z = stiffest * self.pair.inverse_mass * step * step;
        let damped = self.damping_at(from).1 * self.pair.inverse_mass * step;
        let parts = (z.sqrt() / FINE).max(damped).ceil();
        let parts = parts.clamp(PARTS[0], PARTS[1]);
        for _ in 0..parts as u32 {
            self.keep_energy_through(step / parts);
        }
    }

    /// Takes a micro-step: velocity map, half drift, kick, half drift, velocity map. `damping` is the linear damping of the law there.
    fn kick_through(&mut self, step: f64, damping: f64) {
        self.map(step, damping, |axial, offset, speed| {
            (axial - offset) / speed
        });
        self.state.d += 0.5 * step * self.state.v;
        self.kick(step);
        self.state.d += 0.5 * step * self.state.v;
        self.note_side();
        self.map(step, damping, |axial, offset, speed| speed * axial + offset);
    }

    fn note_side(&mut self) {
        let length = self.state.d.length();
        if length > self.pair.rounding {
            self.state.direction = Some(self.state.d / length);
        }
    }

    fn kick(&mut self, step: f64) {
        let (pair, law, rest) = (self.pair, self.law, self.rest_length());
        let Some(line) = pair.line(&self.state) else {
            self.state.v += step * pair.outside;
            return;
        };
        let rate = line.backward_rate(step);
        let drag = law.drag(line.length, rest, rate);
        let damped = drag.slope * pair.inverse_mass * step;
        let along = Along {
            elastic: |length| {
                let elastic = law.elastic(length, rest);
                [elastic.force, elastic.stiffness].map(|x| x * pair.inverse_mass)
            },
            // A damper alone is solved exactly for its present slope: x(1 − e^(−s))/s for a force x of slope s.
            braked: drag.force * pair.inverse_mass * decay_ratio(damped),
            loss: -exp_m1(-damped),
            resolved: true,
        };
        let memo = &mut *self.memo;
        let restoring = |slope: f64| memo.of_kick(slope * step * step, damped / 2.0)[0];
        pair.kick_in_arc(&mut self.state, &line, step, &along, restoring);
    }

    /// Maps the axial velocity between the true and the stepped motion, as in [`super::pair`].
    fn map(&mut self, step: f64, damping: f64, to: impl Fn(f64, f64, f64) -> f64) {
        let Some(line) = self.pair.line(&self.state) else {
            return;
        };
        let weight = self.pair.inverse_mass * step;
        let elastic = self.law.elastic(line.length, self.rest_length());
        let z = elastic.stiffness * weight * step;
        // Only linear damping, because a slope that depends on speed would differ before and after the map.
        let [speed, skew] = self.memo.of_map(z, damping * weight / 2.0);
        let outside = line.pushed + self.pair.turning_at_end(&line, step);
        let residual_acceleration = elastic.force * self.pair.inverse_mass - outside;
        let axial = to(line.axial, skew * step * residual_acceleration, speed);
        self.state.v += (axial - line.axial) * line.direction;
    }

    /// Takes one step whose mean force does the work of the law's energy.
    fn keep_energy_through(&mut self, step: f64) {
        let from = self.state.d.length();
        let braking = self.braking(from, step);
        let to = self.length_after(from, step, braking);
        let sigma = self.share(from, to, step, braking);
        let d = self.after(sigma, step);
        self.state.v = 2.0 / step * (d - self.state.d) - self.state.v;
        self.state.d = d;
        self.note_side();
    }

    /// Rate at the start of a step from the length `from`, m/s, and the time whose rate determines the force of the damper, in halves
    /// of the step. With the middle of the step, a strong damper would throw its ends back and forth.
    fn braking(&self, from: f64, step: f64) -> [f64; 2] {
        let (rate, damping) = self.damping_at(from);
        let placement = damper_placement(damping * self.pair.inverse_mass * step);
        [rate, 2.0 * placement]
    }

    /// Rate of the length now, m/s. `length` is the present length.
    fn rate(&self, length: f64) -> f64 {
        if length > 0.0 {
            self.state.v.dot(self.state.d) / length
        } else {
            0.0
        }
    }

    /// Rate now, m/s, and damping at that rate, N s/m. `length` is the present length.
    fn damping_at(&self, length: f64) -> (f64, f64) {
        let rate = self.rate(length);
        let drag = self.law.drag(length, self.rest_length(), rate);
        (rate, steep(drag, rate))
    }

    /// Displacement towards end A by the step's mean force, as a share of the sum of the separations at both ends of the step.
    /// `from` and `to` are the lengths there; `braking` is that of [`Self::braking`].
    fn share(&self, from: f64, to: f64, step: f64, [start, halves]: [f64; 2]) -> f64 {
        let (law, rest) = (self.law, self.rest_length());
        let middle = 0.5 * (from + to);
        let rate = (to - from) / step;
        let mean = law.mean_force([from, to], rest);
        let braked = start + halves * (rate - start);
        let mut drag = law.drag(middle, rest, braked).force;
        // As in `poles`, unresolved motion is damped a little, because rounding of the engine's f32 excites it.
        let slope = law.elastic(middle, rest).stiffness;
        let z = slope * self.pair.inverse_mass * step * step;
        drag +=
            2.0 / PARTS[1] * UNRESOLVED_DECAY * unresolved(z) * slope * step / z.max(1.0) * rate;
        let pull = (mean + drag) / (from + to).max(f64::MIN_POSITIVE);
        0.5 * step * step * self.pair.inverse_mass * pull
    }

    fn after(&self, sigma: f64, step: f64) -> DVec3 {
        let Separation { d, v, .. } = self.state;
        let free = d + step * v + 0.5 * step * step * self.pair.outside;
        let weight = 1.0 + sigma;
        (free - sigma * d) / weight.abs().max(1e-12).copysign(weight)
    }

    /// Length at the end of the step, m. The mean force depends on it, so the equation is solved by iteration.
    fn length_after(&self, from: f64, step: f64, braking: [f64; 2]) -> f64 {
        let miss = |to: f64| {
            self.after(self.share(from, to, step, braking), step)
                .length()
                - to
        };
        let mut low = (0.0, miss(0.0));
        let free = self.after(0.0, step).length();
        let mut high = (free, miss(free));
        let mut reach = (free - from).abs().max(1e-6);
        while high.1 > 0.0 {
            low = high;
            high.0 += reach;
            high.1 = miss(high.0);
            reach *= 2.0;
            if reach > 1e12 {
                return free;
            }
        }
        // Illinois method: false position that halves the weight of an end that stays.
        let mut stayed = 0;
        for _ in 0..TRIES {
            let width = high.0 - low.0;
            if width <= 1e-14 * high.0 || low.1 == 0.0 {
                break;
            }
            let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let to = if secant > low.0 && secant < high.0 {
                secant
            } else {
                low.0 + 0.5 * width
            };
            let now = miss(to);
            if now.abs() <= 1e-15 * to {
                return to;
            }
            if now > 0.0 {
                low = (to, now);
                if stayed == 1 {
                    high.1 *= 0.5;
                }
                stayed = 1;
            } else {
                high = (to, now);
                if stayed == -1 {
                    low.1 *= 0.5;
                }
                stayed = -1;
            }
        }
        if low.1.abs() < high.1.abs() {
            low.0
        } else {
            high.0
        }
    }
}

#[cfg(test)]
mod tests;
