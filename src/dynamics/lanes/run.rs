//! The plain micro-steps of [`crate::dynamics::pair`], each operation on four elements at once.

use super::vectors::{Vectors, all};
use wide::{CmpLe, f64x4};

/// Constants of a run.
pub(super) struct Run {
    /// Of one micro-step, s.
    pub step: f64,
    /// How many.
    pub count: u32,
    pub outside: Vectors,
    pub rest_length: f64x4,
    /// ω².
    pub square: f64x4,
    /// The poles' [`restoring`, `loss`, `speed`, `skew`](crate::dynamics::poles::Poles).
    pub poles: [f64x4; 4],
    /// Separation below which it is rounding.
    pub rounding: f64x4,
}

/// What four separations have come to.
pub(super) struct Reached {
    pub d: Vectors,
    pub v: Vectors,
    /// Unit vectors along them,
    pub side: Vectors,
    /// and their lengths.
    pub length: f64x4,
    /// Lanes whose ends came so close that the direction between them is rounding.
    pub met: f64x4,
}

/// The lines at an instant: see `pair::Line`.
struct Lines {
    length: f64x4,
    axial: f64x4,
    lateral: Vectors,
    lateral_square: f64x4,
    pushed: f64x4,
}

impl Run {
    fn along(&self, v: Vectors, direction: Vectors, length: f64x4) -> Lines {
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

    /// See `line::turning`.
    fn turning(&self, length: f64x4, lateral_square: f64x4) -> f64x4 {
        let half = all(0.5) * all(self.step);
        let reach = (length * length + half * half * lateral_square).sqrt();
        (all(2.0) * lateral_square / (length.abs() + reach)).copysign(length)
    }

    /// See `line::backward_rate`.
    fn backward_rate(&self, lines: &Lines) -> f64x4 {
        let (step, length) = (all(self.step), lines.length);
        let along = length - step * lines.axial;
        let before = (along * along + step * step * lines.lateral_square).sqrt();
        let flips = (along * length).cmp_le(all(0.0));
        flips.blend(lines.axial, (length - before.copysign(along)) / step)
    }

    /// What the elements have yet to answer at these lengths.
    fn residual_acceleration(&self, length: f64x4, outside: f64x4) -> f64x4 {
        self.square * (length - self.rest_length) - outside
    }

    /// Takes all of them over the step. In one piece, for it is the recipe of `Moving`, line by line: a test holds them to the
    /// same bits.
    pub(super) fn go(&self, mut d: Vectors, mut v: Vectors, mut length: f64x4) -> Reached {
        let run = self;
        let step = all(run.step);
        let half = all(0.5 * run.step);
        let eighth = all(run.step * run.step / 8.0);
        let rounding = run.rounding;
        let [restoring, loss, speed, skew] = run.poles;
        let per_step = loss / step;

        // To the stepped velocities.
        let mut met = length.cmp_le(rounding);
        let mut side = d.times(all(1.0) / length);
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning(length, lines.lateral_square);
        let offset = skew * step * run.residual_acceleration(length, outside);
        let mapped = (lines.axial - offset) / speed;
        v = v.plus(side.times(mapped - lines.axial));
        for _ in 0..run.count {
            d = d.plus(v.times(half));
            // The kick.
            let distance = d.length();
            met |= distance.cmp_le(rounding);
            length = distance.copysign(d.dot(side));
            let direction = d.times(all(1.0) / length);
            let lines = run.along(v, direction, length);
            let rate = run.backward_rate(&lines);
            let across = run.outside.minus(direction.times(lines.pushed));
            let after = lines.lateral.plus(across.times(step));
            let turning = all(0.5)
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
            met |= length.cmp_le(rounding);
            side = d.times(all(1.0) / length);
        }
        // And back to the true ones.
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
