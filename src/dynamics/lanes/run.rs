//! The micro-steps of [`crate::dynamics::pair`] for four plain elements at once.

use super::vectors::{Each, Four, Mask, Vectors};
use crate::dynamics::arc::{HALVED, MOST_PULL, RESOLVED_TURN, ROUNDS, TILT};
use pulp::Simd;

/// Constants of the four elements.
#[derive(Clone, Copy)]
pub(super) struct Motion<S: Simd> {
    pub simd: S,
    /// Duration of the whole step, s.
    pub time: f64,
    /// Acceleration of end B minus that of end A from everything but the element, m/s².
    pub outside: Vectors<S>,
    pub rest_length: Four<S>,
    /// ω², 1/s².
    pub square: Four<S>,
    /// Separation up to which the ends count as coincident, because it may be rounding, m.
    pub rounding: Four<S>,
}

/// Their micro-steps.
pub(super) struct Run<S: Simd> {
    of: Motion<S>,
    /// Duration of a micro-step, s.
    step: f64,
    /// Number of micro-steps.
    count: u32,
    /// Coefficients [`restoring`, `loss`, `speed`, `skew`](crate::dynamics::poles::Poles).
    poles: [Four<S>; 4],
}

/// State of the four separations after the step.
pub(super) struct Reached<S: Simd> {
    pub d: Vectors<S>,
    pub v: Vectors<S>,
    /// Unit vectors along the separations.
    pub side: Vectors<S>,
    /// Lengths of the separations, m.
    pub length: Four<S>,
    /// Lanes whose ends came so close that they counted as coincident.
    pub met: Mask<S>,
}

impl<S: Simd> Reached<S> {
    /// Extrapolates from the state that half as many micro-steps reached; see `pair::Separation::extrapolate`. `odd` are lanes in
    /// which that is wrong.
    #[inline(always)]
    pub(super) fn extrapolated(self, simd: S, coarse: &Self, odd: Mask<S>) -> Self {
        let less = Four::all(simd, HALVED - 1.0);
        let d = self.d.plus(self.d.minus(coarse.d).over(less));
        Self {
            d,
            v: self.v.plus(self.v.minus(coarse.v).over(less)),
            side: self.side,
            length: d.length(),
            met: self.met | coarse.met | odd,
        }
    }
}

/// The lines at an instant; see `pair::Line`.
struct Lines<S: Simd> {
    length: Four<S>,
    axial: Four<S>,
    lateral: Vectors<S>,
    lateral_square: Four<S>,
    pushed: Four<S>,
}

/// The middle of a kick; see `arc::Middle`.
struct Middle<S: Simd> {
    step: Four<S>,
    /// 1/L, 1/m.
    inverse: Four<S>,
    /// Square of the velocity across the line, m²/s², and the coefficients of its growth.
    lateral_square: Four<S>,
    gained: Four<S>,
    across_square: Four<S>,
    braked: Four<S>,
    /// [`MOST_PULL`].
    most: Four<S>,
    /// The share of the corrections that counts.
    share: Four<S>,
}

impl<S: Simd> Middle<S> {
    #[inline(always)]
    fn lateral_square(&self, time: Four<S>) -> Four<S> {
        self.lateral_square + time * (self.gained + time * self.across_square)
    }

    #[inline(always)]
    fn number(&self, pull: Four<S>) -> Four<S> {
        let number = self.step * self.step * (pull + self.braked) * self.inverse;
        self.share * number.max(-self.most).min(self.most)
    }
}

impl<S: Simd> Run<S> {
    #[inline(always)]
    pub(super) fn new(of: Motion<S>, count: u32, poles: &[Each; 4]) -> Self {
        let [restoring, loss, speed, skew] = poles;
        Self {
            of,
            step: of.time / f64::from(count),
            count,
            poles: [
                Four::load(of.simd, restoring),
                Four::load(of.simd, loss),
                Four::load(of.simd, speed),
                Four::load(of.simd, skew),
            ],
        }
    }

    #[inline(always)]
    fn all(&self, number: f64) -> Four<S> {
        Four::all(self.of.simd, number)
    }

    #[inline(always)]
    fn along(&self, v: Vectors<S>, direction: Vectors<S>, length: Four<S>) -> Lines<S> {
        let axial = v.dot(direction);
        let lateral = v.minus(direction.times(axial));
        Lines {
            length,
            axial,
            lateral,
            lateral_square: lateral.dot(lateral),
            pushed: self.of.outside.dot(direction),
        }
    }

    /// Lanes in which the line turns so far in two micro-steps that extrapolation from them would not converge; see
    /// `Pair::resolved`.
    #[inline(always)]
    pub(super) fn turns_far(&self, d: Vectors<S>, v: Vectors<S>, length: Four<S>) -> Mask<S> {
        let lines = self.along(v, d.times(self.all(1.0) / length), length);
        let coarse = self.all(2.0) * self.all(self.step);
        (length * length).at_most(coarse * coarse * lines.lateral_square)
    }

    /// See `Pair::turning_at_end`.
    #[inline(always)]
    fn turning_at_end(&self, length: Four<S>, lateral_square: Four<S>) -> Four<S> {
        let turned = self.per_length(length) * lateral_square;
        lateral_square / (length * (self.all(0.25) * turned).max(self.all(1.0)))
    }

    /// (h/L)².
    #[inline(always)]
    fn per_length(&self, length: Four<S>) -> Four<S> {
        let step = self.all(self.step);
        step * step / (length * length)
    }

    /// See `arc::tilt`.
    #[inline(always)]
    fn tilt(&self, pull: Four<S>) -> Four<S> {
        let mut sum = self.all(0.0);
        for coefficient in TILT.iter().rev() {
            sum = (sum + self.all(*coefficient)) * pull;
        }
        sum
    }

    /// See `arc::fade`.
    #[inline(always)]
    fn fade(&self, turned: Four<S>) -> Four<S> {
        let [from, to] = RESOLVED_TURN;
        let (none, all) = (self.all(0.0), self.all(1.0));
        let beyond = (turned - self.all(from)) * self.all(1.0 / (to - from));
        let beyond = beyond.max(none).min(all);
        let left = all - beyond * beyond;
        left * left
    }

    /// See `line::backward_rate`.
    #[inline(always)]
    fn backward_rate(&self, lines: &Lines<S>) -> Four<S> {
        let (step, length) = (self.all(self.step), lines.length);
        let along = length - step * lines.axial;
        let before = (along * along + step * step * lines.lateral_square).sqrt();
        let flips = (along * length).at_most(self.all(0.0));
        flips.select(lines.axial, (length - before.copysign(along)) / step)
    }

    /// The kick; see `Pair::kick_in_arc`, whose code it follows line by line in one function. Returns the separation and its
    /// velocity.
    #[inline(always)]
    fn kick(&self, v: Vectors<S>, d: Vectors<S>, length: Four<S>) -> [Vectors<S>; 2] {
        let (step, one, two) = (self.all(self.step), self.all(1.0), self.all(2.0));
        let half = self.all(0.5) * step;
        let [restoring, loss, ..] = self.poles;
        let inverse = one / length;
        let direction = d.times(inverse);
        let lines = self.along(v, direction, length);
        let braked = loss / step * self.backward_rate(&lines);
        let across = self.of.outside.minus(direction.times(lines.pushed));
        let per_length = step * inverse;
        let per_length = per_length * per_length;

        let mut middle = Middle {
            step,
            inverse,
            lateral_square: lines.lateral_square,
            gained: two * lines.lateral.dot(across),
            across_square: across.dot(across),
            braked,
            most: self.all(MOST_PULL),
            share: one,
        };
        let pull = self.of.square * (length - self.of.rest_length);
        middle.share = self.fade(per_length * middle.lateral_square(half));
        let share = middle.share;

        let mut time = half;
        for _ in 0..ROUNDS {
            let turned = (per_length * middle.lateral_square(time)).min(one);
            let drifted = self.all(0.125) * turned * length;
            let number = middle.number(pull - self.of.square * drifted);
            time = half - half * number * self.all(1.0 / 6.0);
        }
        let lateral = lines.lateral.plus(across.times(time));
        let lateral_square = lateral.dot(lateral);

        let turned = per_length * lateral_square;
        let within = turned.min(one);
        let doubled = one + (one - within).sqrt();
        let cosine = (self.all(0.5) * doubled).sqrt();
        let turning = two * lateral_square * inverse / (doubled * turned.max(one));
        let lessened = one - share * (one - cosine);
        let pull = lessened * (self.of.square * (cosine * length - self.of.rest_length));
        let damped = self.all(0.5)
            * share
            * (loss * step * inverse * lateral.dot(self.of.outside)
                - (one - loss) * within * braked);
        let total = damped - braked - restoring * (pull - turning) - turning;
        let pushed_for = half * restoring;
        let axial = lines.axial + pushed_for * lines.pushed + step * total;

        let tangent = self.tilt(middle.number(pull)) * step * inverse;
        let tilted = tangent * tangent * lateral_square;
        let scale = one / (one + tilted);
        let cos = (one - tilted) * scale;
        let sin = two * tangent * scale;
        let rotated = direction.times(cos).plus(lateral.times(sin));
        let lateral = lateral
            .times(cos)
            .minus(direction.times(sin * lateral_square));
        let axial = axial + (pushed_for - time) * self.of.outside.dot(rotated);
        let velocity = rotated
            .times(axial)
            .plus(lateral)
            .plus(self.of.outside.times(time));
        [rotated.times(length), velocity]
    }

    /// ω²·stretch − a_out at the lengths; see `kick::residual_acceleration`.
    #[inline(always)]
    fn residual_acceleration(&self, length: Four<S>, outside: Four<S>) -> Four<S> {
        self.of.square * (length - self.of.rest_length) - outside
    }

    /// Takes all micro-steps. It is one function because it follows the code of `Pair::microsteps` line by line. A test
    /// requires bitwise equal results.
    #[inline(always)]
    pub(super) fn go(
        &self,
        mut d: Vectors<S>,
        mut v: Vectors<S>,
        mut length: Four<S>,
    ) -> Reached<S> {
        let run = self;
        let step = self.all(run.step);
        let half = self.all(0.5 * run.step);
        let rounding = run.of.rounding;
        let [.., speed, skew] = run.poles;

        // Map to the stepped velocities.
        let mut met = length.at_most(rounding);
        let mut side = d.times(self.all(1.0) / length);
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning_at_end(length, lines.lateral_square);
        let offset = skew * step * run.residual_acceleration(length, outside);
        let mapped = (lines.axial - offset) / speed;
        v = v.plus(side.times(mapped - lines.axial));
        for _ in 0..run.count {
            d = d.plus(v.times(half));
            let distance = d.length();
            met = met | distance.at_most(rounding);
            length = distance.copysign(d.dot(side));
            [d, v] = run.kick(v, d, length);
            d = d.plus(v.times(half));
            length = d.length();
            met = met | length.at_most(rounding);
            side = d.times(self.all(1.0) / length);
        }
        // Map back to the true velocities.
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning_at_end(length, lines.lateral_square);
        let offset = skew * step * run.residual_acceleration(length, outside);
        let mapped = speed * lines.axial + offset;
        v = v.plus(side.times(mapped - lines.axial));

        Reached {
            d,
            v,
            side,
            length,
            met,
        }
    }
}
