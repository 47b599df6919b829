//! Four lone elements at a time: the plain micro-steps of [`super::pair`], each operation on all four, and to the
//! last bit what that makes of each. One after the other they would wait for their roots and divisions.

use super::kick::Memo;
use super::pair::{Pair, Separation};
use bevy::math::DVec3;
use wide::{CmpLe, f64x4};

/// Elements side by side.
pub(crate) const LANES: usize = 4;

/// One number for each lane.
type Each = [f64; LANES];

/// Four elements between ends that do not turn, and what became of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    d: [Each; 3],
    v: [Each; 3],
    direction: [Each; 3],
    outside: [Each; 3],
    /// Of the separation at the end.
    length: Each,
    rest_length: Each,
    rounding: Each,
    /// ω².
    square: Each,
    restoring: Each,
    loss: Each,
    speed: Each,
    skew: Each,
    /// Ends came so close that the direction between them is rounding.
    met: u32,
}

/// Vectors of each.
#[derive(Clone, Copy)]
struct Vectors([f64x4; 3]);

impl Vectors {
    fn load(from: &[Each; 3]) -> Self {
        Self(from.map(f64x4::new))
    }

    fn store(&self) -> [Each; 3] {
        self.0.map(f64x4::to_array)
    }

    fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    fn minus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    fn times(self, by: f64x4) -> Self {
        let [a, b, c] = self.0;
        Self([by * a, by * b, by * c])
    }

    fn dot(self, other: Self) -> f64x4 {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    fn length(self) -> f64x4 {
        self.dot(self).sqrt()
    }
}

/// Constants of a run.
struct Run {
    step: f64x4,
    outside: Vectors,
    rest_length: f64x4,
    square: f64x4,
}

/// The lines at an instant: see `pair::Line`.
struct Lines {
    length: f64x4,
    axial: f64x4,
    lateral: Vectors,
    lateral_square: f64x4,
    pushed: f64x4,
}

fn all(value: f64) -> f64x4 {
    f64x4::splat(value)
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
        let half = all(0.5) * self.step;
        let reach = (length * length + half * half * lateral_square).sqrt();
        (all(2.0) * lateral_square / (length.abs() + reach)).copysign(length)
    }

    /// See `line::backward_rate`.
    fn backward_rate(&self, lines: &Lines) -> f64x4 {
        let (step, length) = (self.step, lines.length);
        let along = length - step * lines.axial;
        let before = (along * along + step * step * lines.lateral_square).sqrt();
        let flips = (along * length).cmp_le(all(0.0));
        flips.blend(lines.axial, (length - before.copysign(along)) / step)
    }

    /// What the elements have yet to answer at these lengths.
    fn residual_acceleration(&self, length: f64x4, outside: f64x4) -> f64x4 {
        self.square * (length - self.rest_length) - outside
    }
}

impl Lanes {
    /// Takes one in. It has a rest length, its step is resolved and no strong damper in it: see
    /// [`Pair::is_plain`].
    pub(crate) fn take_in(
        &mut self,
        lane: usize,
        pair: &Pair,
        state: &Separation,
        step: f64,
        memo: &mut Memo,
    ) {
        let poles = pair.poles(step, memo);
        for axis in 0..3 {
            self.d[axis][lane] = state.d[axis];
            self.v[axis][lane] = state.v[axis];
            self.outside[axis][lane] = pair.outside[axis];
        }
        self.rest_length[lane] = pair.rest_length;
        self.rounding[lane] = pair.rounding;
        self.square[lane] = pair.stiffness * pair.inverse_mass;
        self.restoring[lane] = poles.restoring;
        self.loss[lane] = poles.loss;
        self.speed[lane] = poles.speed;
        self.skew[lane] = poles.skew;
    }

    /// Where one is, and its length; none if its ends met on the way, which is not for here.
    pub(crate) fn state(&self, lane: usize) -> Option<(Separation, f64)> {
        let of = |v: &[Each; 3]| DVec3::new(v[0][lane], v[1][lane], v[2][lane]);
        (self.met & (1 << lane) == 0).then(|| {
            let direction = Some(of(&self.direction));
            let state = Separation::new(of(&self.d), of(&self.v), direction);
            (state, self.length[lane])
        })
    }

    /// Takes all of them over the step. In one piece, for it is the recipe of `Moving`, line by line: the test below holds
    /// them to the same bits.
    pub(crate) fn run(&mut self, time: f64, count: u32) {
        let step = time / f64::from(count);
        let half = all(0.5 * step);
        let eighth = all(step * step / 8.0);
        let run = Run {
            step: all(step),
            outside: Vectors::load(&self.outside),
            rest_length: f64x4::new(self.rest_length),
            square: f64x4::new(self.square),
        };
        let rounding = f64x4::new(self.rounding);
        let [restoring, loss, speed, skew] =
            [self.restoring, self.loss, self.speed, self.skew].map(f64x4::new);
        let per_step = loss / run.step;
        let mut d = Vectors::load(&self.d);
        let mut v = Vectors::load(&self.v);

        // To the stepped velocities.
        let mut length = d.length();
        let mut met = length.cmp_le(rounding);
        let mut side = d.times(all(1.0) / length);
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning(length, lines.lateral_square);
        let offset = skew * run.step * run.residual_acceleration(length, outside);
        let mapped = (lines.axial - offset) / speed;
        v = v.plus(side.times(mapped - lines.axial));
        for _ in 0..count {
            d = d.plus(v.times(half));
            // The kick.
            let distance = d.length();
            met |= distance.cmp_le(rounding);
            length = distance.copysign(d.dot(side));
            let direction = d.times(all(1.0) / length);
            let lines = run.along(v, direction, length);
            let rate = run.backward_rate(&lines);
            let across = run.outside.minus(direction.times(lines.pushed));
            let after = lines.lateral.plus(across.times(run.step));
            let turning = all(0.5)
                * (run.turning(length, lines.lateral_square)
                    + run.turning(length, after.dot(after)));
            let outside = lines.pushed + turning;
            let residual_acceleration =
                run.residual_acceleration(length - eighth * turning, outside);
            let total = -restoring * residual_acceleration - per_step * rate;
            let pulled = direction.times(run.step * (total - outside));
            v = v.plus(pulled.plus(run.outside.times(run.step)));
            d = d.plus(v.times(half));
            length = d.length();
            met |= length.cmp_le(rounding);
            side = d.times(all(1.0) / length);
        }
        // And back to the true ones.
        let lines = run.along(v, side, length);
        let outside = lines.pushed + run.turning(length, lines.lateral_square);
        let offset = skew * run.step * run.residual_acceleration(length, outside);
        let mapped = speed * lines.axial + offset;
        v = v.plus(side.times(mapped - lines.axial));

        (self.d, self.v) = (d.store(), v.store());
        self.direction = side.store();
        self.length = length.to_array();
        self.met = met.move_mask() as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::super::moving::Moving;
    use super::super::tolerance::Motion;
    use super::*;

    const DT: f64 = 1.0 / 60.0;

    fn bits(state: &Separation) -> Vec<u64> {
        let direction = state.direction.unwrap_or(DVec3::ZERO);
        let all = [state.d, state.v, direction].map(|v| v.to_array());
        all.into_iter().flatten().map(f64::to_bits).collect()
    }

    #[test]
    fn each_goes_as_it_would_alone_bit_for_bit() {
        let mut seed = 1_u64;
        let mut random = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut vector =
            |size: f64| size * DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5);
        let mut met = 0;
        for count in [1, 2, 4, 16].repeat(500) {
            let step = DT / f64::from(count);
            let some: [_; LANES] = std::array::from_fn(|lane| {
                let pair = Pair {
                    stiffness: 2000.0 * vector(1.0).x.abs(),
                    damping: 10.0 * vector(1.0).x.max(0.0),
                    rest_length: 0.1 + vector(1.0).x.abs(),
                    inverse_mass: 0.1 + vector(4.0).x.abs(),
                    outside: vector(20.0) * f64::from(lane as u32 % 2),
                    rounding: if lane == 0 { 0.05 } else { 1e-9 },
                };
                let direction = (lane > 1).then(|| vector(1.0).normalize());
                let d = vector(if lane == 3 { 0.2 } else { 2.0 });
                (pair, Separation::new(d, vector(20.0), direction))
            });
            let plain = some.iter().all(|(pair, _)| pair.is_plain(step));
            assert!(plain, "nothing else is asked of them");
            let mut lanes = Lanes::default();
            for (lane, (pair, state)) in some.iter().enumerate() {
                lanes.take_in(lane, pair, state, step, &mut Memo::default());
            }
            lanes.run(DT, count);
            for (lane, (pair, state)) in some.iter().enumerate() {
                let mut memo = Memo::default();
                let mut alone = Moving::new(pair, *state, &mut memo);
                alone.run(DT, count);
                let Some((state, length)) = lanes.state(lane) else {
                    met += 1;
                    continue;
                };
                assert_eq!(bits(&state), bits(&alone.state), "lane {lane}");
                assert_eq!(length.to_bits(), alone.state.d.length().to_bits());
            }
        }
        assert!((1..200).contains(&met), "some meet: {met}");
    }
}
