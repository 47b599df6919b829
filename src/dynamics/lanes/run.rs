//! The micro-steps of [`crate::dynamics::pair`] for four plain elements at once.

use super::vectors::{Four, Mask, Vectors};
use crate::dynamics::arc::{HALVED, MOST_PULL, RESOLVED_TURN, ROUNDS, TILT};
use pulp::Simd;

/// Constants of the four elements and their micro-steps.
pub(super) struct Run<S: Simd> {
    pub simd: S,
    /// Duration of a micro-step, s.
    pub step: f64,
    /// Number of micro-steps.
    pub count: u32,
    /// Acceleration of end B minus that of end A from everything but the element, m/s².
    pub outside: Vectors<S>,
    pub rest_length: Four<S>,
    /// ω², 1/s².
    pub square: Four<S>,
    /// Coefficients [`restoring`, `loss`, `speed`, `skew`](crate::dynamics::poles::Poles).
    pub poles: [Four<S>; 4],
    /// Separation up to which the ends count as coincident, because it may be rounding, m.
    pub rounding: Four<S>,
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

impl<S: Simd> Run<S> {
    #[inline(always)]
    fn all(&self, number: f64) -> Four<S> {
        Four::all(self.simd, number)
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
            pushed: self.outside.dot(direction),
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
        let terms = TILT.iter().rev();
        terms.fold(self.all(0.0), |sum, coefficient| {
            (sum + self.all(*coefficient)) * pull
        })
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
        let all = |number| self.all(number);
        let step = all(self.step);
        let (half, one, two) = (all(0.5) * step, all(1.0), all(2.0));
        let [restoring, loss, ..] = self.poles;
        let inverse = one / length;
        let direction = d.times(inverse);
        let lines = self.along(v, direction, length);
        let braked = loss / step * self.backward_rate(&lines);
        let across = self.outside.minus(direction.times(lines.pushed));
        let per_length = step * inverse;
        let per_length = per_length * per_length;

        let gained = two * lines.lateral.dot(across);
        let across_square = across.dot(across);
        let lateral_square =
            |time: Four<S>| lines.lateral_square + time * (gained + time * across_square);
        let pull = self.square * (length - self.rest_length);
        let share = self.fade(per_length * lateral_square(half));
        let pull_number = |pull: Four<S>| {
            let number = step * step * (pull + braked) * inverse;
            share * number.max(all(-MOST_PULL)).min(all(MOST_PULL))
        };

        let mut time = half;
        for _ in 0..ROUNDS {
            let turned = (per_length * lateral_square(time)).min(one);
            let drifted = all(0.125) * turned * length;
            time = half - half * pull_number(pull - self.square * drifted) * all(1.0 / 6.0);
        }
        let lateral = lines.lateral.plus(across.times(time));
        let lateral_square = lateral.dot(lateral);

        let turned = per_length * lateral_square;
        let within = turned.min(one);
        let doubled = one + (one - within).sqrt();
        let cosine = (all(0.5) * doubled).sqrt();
        let turning = two * lateral_square * inverse / (doubled * turned.max(one));
        let lessened = one - share * (one - cosine);
        let pull = lessened * (self.square * (cosine * length - self.rest_length));
        let damped = all(0.5)
            * share
            * (loss * step * inverse * lateral.dot(self.outside) - (one - loss) * within * braked);
        let total = damped - braked - restoring * (pull - turning) - turning;
        let pushed_for = half * restoring;
        let axial = lines.axial + pushed_for * lines.pushed + step * total;

        let tangent = self.tilt(pull_number(pull)) * step * inverse;
        let tilted = tangent * tangent * lateral_square;
        let scale = one / (one + tilted);
        let cos = (one - tilted) * scale;
        let sin = two * tangent * scale;
        let rotated = direction.times(cos).plus(lateral.times(sin));
        let lateral = lateral
            .times(cos)
            .minus(direction.times(sin * lateral_square));
        let axial = axial + (pushed_for - time) * self.outside.dot(rotated);
        let velocity = rotated
            .times(axial)
            .plus(lateral)
            .plus(self.outside.times(time));
        [rotated.times(length), velocity]
    }

    /// ω²·stretch − a_out at the lengths; see `kick::residual_acceleration`.
    #[inline(always)]
    fn residual_acceleration(&self, length: Four<S>, outside: Four<S>) -> Four<S> {
        self.square * (length - self.rest_length) - outside
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
        let rounding = run.rounding;
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
