//! The micro-steps of [`crate::dynamics::pair`] for four plain elements at once.

use super::vectors::{Four, Mask, Vectors};
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
    /// Extrapolates from the state that half as many micro-steps reached; see `pair::Separation::towards`. `odd` are lanes in
    /// which that is wrong.
    #[inline(always)]
    pub(super) fn extrapolated(self, simd: S, coarse: &Self, odd: Mask<S>) -> Self {
        let three = Four::all(simd, 3.0);
        let d = self.d.plus(self.d.minus(coarse.d).over(three));
        Self {
            d,
            v: self.v.plus(self.v.minus(coarse.v).over(three)),
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

    /// See `line::turning`.
    #[inline(always)]
    fn turning(&self, length: Four<S>, lateral_square: Four<S>) -> Four<S> {
        let half = self.all(0.5) * self.all(self.step);
        let reach = (length * length + half * half * lateral_square).sqrt();
        (self.all(2.0) * lateral_square / (length.abs() + reach)).copysign(length)
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
        let eighth = self.all(run.step * run.step / 8.0);
        let rounding = run.rounding;
        let [restoring, loss, speed, skew] = run.poles;
        let per_step = loss / step;

        // Map to the stepped velocities.
        let mut met = length.at_most(rounding);
        let mut side = d.times(self.all(1.0) / length);
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning(length, lines.lateral_square);
        let offset = skew * step * run.residual_acceleration(length, outside);
        let mapped = (lines.axial - offset) / speed;
        v = v.plus(side.times(mapped - lines.axial));
        for _ in 0..run.count {
            d = d.plus(v.times(half));
            // The kick.
            let distance = d.length();
            met = met | distance.at_most(rounding);
            length = distance.copysign(d.dot(side));
            let direction = d.times(self.all(1.0) / length);
            let lines = run.along(v, direction, length);
            let rate = run.backward_rate(&lines);
            let across = run.outside.minus(direction.times(lines.pushed));
            let after = lines.lateral.plus(across.times(step));
            let turning = self.all(0.5)
                * (run.turning(length, lines.lateral_square)
                    + run.turning(length, after.dot(after)));
            let outside = lines.pushed + turning;
            let residual_acceleration =
                run.residual_acceleration(length - eighth * turning, outside);
            let total = -restoring * residual_acceleration - per_step * rate;
            let pulled = direction.times(step * (total - outside));
            v = v.plus(pulled.plus(run.outside.times(step)));
            d = d.plus(v.times(half));
            length = d.length();
            met = met | length.at_most(rounding);
            side = d.times(self.all(1.0) / length);
        }
        // Map back to the true velocities.
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning(length, lines.lateral_square);
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
