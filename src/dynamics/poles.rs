//! Computes the coefficients with which one drift–kick–drift step of a damped oscillator has exactly the true decay and
//! frequency, whatever the step.

use crate::functions::{cos, exp, exp_m1, sin, tanh};

/// Phase per step up to which the frequency is exact, rad. Above π, the sampled motion would look like a slower one. So a
/// greater phase is reduced to this value, and only the energy is exact. Stepped velocities are then smaller than true
/// ones, so that drifts are no longer than the true motion. Pinned by `poles::tests`.
pub(crate) const RESOLVED_PHASE: f64 = 2.5;

/// Least decay exponent per step of motion whose phase is far from resolved. The engine rounds positions to f32, and a
/// spring of ω h = 100 turns each rounding error into a hundred times as much speed. Without this decay, a swinging rod
/// would gain several per cent of energy in a minute. Pinned by `stiff_by_default`: with ten times as much, a stiff spring loses
/// a fifth of its energy in a step.
pub(crate) const UNRESOLVED_DECAY: f64 = 0.01;

/// Decay exponent per step below which one step is the exact flow. Pinned by `decay::started_with_a_velocity_it_is_as_exact`.
const RESOLVED_DECAY: f64 = 2.0;

/// Coefficients of one step h for y″ = −ω²y − 2γy′ + a, with z = (ωh)² and g = γh.
///
/// With r = ω²y − a, the kick after the first half drift is `Δv = −h·restoring·r − loss·v`. The step then has exactly the
/// trace and determinant of the exact flow. Its velocity differs by the map `v_true = speed·v + skew·h·r`.
/// [`super::kick`] applies this map and its inverse, so that one step is the exact flow for any initial state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Poles {
    /// (1 − p₁)(1 − p₂)/z, where p₁ and p₂ are the poles of the flow.
    pub restoring: f64,
    /// 1 − p₁p₂ = 1 − e^(−2g).
    pub loss: f64,
    /// Ratio of true to stepped velocity.
    pub speed: f64,
    /// Part of the true velocity per h·r.
    pub skew: f64,
}

/// (1 − e^(−x))/x.
pub(crate) fn decay_ratio(x: f64) -> f64 {
    if x < 1e-12 { 1.0 } else { -exp_m1(-x) / x }
}

/// How far the phase √`z` of a step is from resolved: zero up to [`RESOLVED_PHASE`], nearly one far above it.
pub(crate) fn unresolved(z: f64) -> f64 {
    (1.0 - RESOLVED_PHASE * RESOLVED_PHASE / z).max(0.0)
}

/// The decay exponent of a step: γh, and a little more where the phase is far from resolved.
fn decay(z: f64, g: f64) -> f64 {
    g.max(UNRESOLVED_DECAY * unresolved(z))
}

impl Poles {
    pub(crate) const UNKNOWN: Self = Self {
        restoring: f64::NAN,
        loss: f64::NAN,
        speed: f64::NAN,
        skew: f64::NAN,
    };

    /// `z` = k h²/m, `g` = c h/(2 m); both finite and not negative.
    pub(crate) fn new(z: f64, g: f64) -> Self {
        let [restoring, loss] = Self::of_kick(z, g);
        let [speed, skew] = Self::of_map(z, g);
        Self {
            restoring,
            loss,
            speed,
            skew,
        }
    }

    /// `restoring` and `loss`, which the kick needs.
    pub(crate) fn of_kick(z: f64, g: f64) -> [f64; 2] {
        let g = decay(z, g);
        let discriminant = z - g * g;
        let restoring = if discriminant > 0.0 {
            let phase = discriminant.sqrt().min(RESOLVED_PHASE);
            let half = sin(phase / 2.0);
            let settle = -exp_m1(-g);
            (settle * settle + 4.0 * exp(-g) * half * half) / z
        } else {
            let [slow, fast] = overdamped(z, g, discriminant);
            decay_ratio(fast) * decay_ratio(slow)
        };
        [restoring, -exp_m1(-2.0 * g)]
    }

    /// `speed` and `skew`, which the velocity map needs.
    pub(crate) fn of_map(z: f64, g: f64) -> [f64; 2] {
        let g = decay(z, g);
        let discriminant = z - g * g;
        let slow = if discriminant > 0.0 {
            g
        } else {
            overdamped(z, g, discriminant)[0]
        };
        // If the motion decays within the step, this map does not matter and is badly conditioned.
        if slow < RESOLVED_DECAY {
            velocity_map(z, g)
        } else {
            [1.0, 0.0]
        }
    }

    /// Ratio of true to stepped velocity for undamped motion across the line under the same kick. It gives the stepped
    /// orbit the energy of the true one.
    pub(crate) fn speed_across(&self, z: f64) -> f64 {
        (0.5 * ((4.0 - self.restoring * z) / self.restoring)
            .max(0.0)
            .sqrt())
        .max(1e-3)
    }
}

/// The exponents of slow and fast decay of an overdamped step.
fn overdamped(z: f64, g: f64, discriminant: f64) -> [f64; 2] {
    let fast = g + (-discriminant).sqrt();
    let slow = if fast > 0.0 { z / fast } else { 0.0 };
    [slow, fast]
}

/// Returns `speed` and `skew`. They solve E P = P M for P = [[1, 0], [p, speed]] with p = skew·z/h, where E is the exact
/// flow and M the drift–kick–drift step.
fn velocity_map(z: f64, g: f64) -> [f64; 2] {
    let square = g * g - z;
    // e^(−g)·φ and e^(−g)·C, where φ = sin σ/σ (or sinh r/r) and C = cos σ (or cosh r).
    let (sine, cosine) = if square < 0.0 {
        let phase = (-square).sqrt();
        let used = phase.min(RESOLVED_PHASE);
        let sine = if phase < 1e-4 {
            1.0 - phase * phase / 6.0
        } else {
            sin(used) / phase
        };
        (exp(-g) * sine, exp(-g) * cos(used))
    } else {
        let r = square.sqrt();
        let slow = if g + r > 0.0 { z / (g + r) } else { 0.0 };
        let (p1, p2) = (exp(-slow), exp(-g - r));
        let sine = if r < 1e-4 {
            exp(-g)
        } else {
            (p1 - p2) / (2.0 * r)
        };
        (sine, (p1 + p2) / 2.0)
    };
    let scaled_cosh = (1.0 + exp(-2.0 * g)) / 2.0;
    let speed = (scaled_cosh + cosine) / (2.0 * sine);
    let skew = if g == 0.0 {
        0.0
    } else if g * g < 0.5 && square.abs() < 0.5 {
        // (sinhc(g) − φ)/z as a series, which avoids cancellation.
        let (u, w) = (g * g, square);
        let series = 1.0 / 6.0
            + (u + w) / 120.0
            + (u * u + u * w + w * w) / 5040.0
            + (u + w) * (u * u + w * w) / 362_880.0;
        g * exp(-g) * series / sine
    } else if z < 1e-5 * g * g {
        // Hardly any spring: the limit for small z.
        (1.0 / tanh(g) - 1.0 / g) / 2.0
    } else {
        ((1.0 - exp(-2.0 * g)) / (2.0 * sine) - g) / z
    };
    [speed, skew]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exact flow over h = 1, from the series of the matrix exponential of [[0, 1], [−z, −2g]].
    fn exact(z: f64, g: f64) -> [[f64; 2]; 2] {
        let halvings = 20;
        let h = 0.5_f64.powi(halvings);
        let a = [[0.0, h], [-z * h, -2.0 * g * h]];
        let mul = |x: [[f64; 2]; 2], y: [[f64; 2]; 2]| {
            let mut out = [[0.0; 2]; 2];
            for i in 0..2 {
                for j in 0..2 {
                    out[i][j] = x[i][0] * y[0][j] + x[i][1] * y[1][j];
                }
            }
            out
        };
        let mut power = [[1.0, 0.0], [0.0, 1.0]];
        let mut sum = power;
        let mut factorial = 1.0;
        for n in 1..8 {
            power = mul(power, a);
            factorial *= n as f64;
            for i in 0..2 {
                for j in 0..2 {
                    sum[i][j] += power[i][j] / factorial;
                }
            }
        }
        for _ in 0..halvings {
            sum = mul(sum, sum);
        }
        sum
    }

    /// One step over h = 1 from the state (y, v): inverse velocity map, drift–kick–drift, velocity map.
    fn step(z: f64, g: f64, y: f64, v: f64) -> (f64, f64) {
        let p = Poles::new(z, g);
        let v = (v - p.skew * z * y) / p.speed;
        let q = y + v / 2.0;
        let v2 = v - p.restoring * z * q - p.loss * v;
        let y2 = q + v2 / 2.0;
        (y2, p.speed * v2 + p.skew * z * y2)
    }

    #[test]
    fn one_step_is_the_true_flow_for_any_initial_state() {
        for phase in [1e-6_f64, 1e-3, 0.02, 0.3, 1.0, 2.0, 2.4] {
            for zeta in [0.0, 1e-6, 0.05, 0.5, 0.999, 1.0, 1.001, 3.0, 20.0] {
                let (z, g) = (phase * phase, zeta * phase);
                let slow = if zeta > 1.0 {
                    z / (g + (g * g - z).sqrt())
                } else {
                    g
                };
                if slow >= RESOLVED_DECAY {
                    continue;
                }
                let e = exact(z, g);
                for (y, v) in [(1.0, 0.0), (0.0, 1.0)] {
                    let (y2, v2) = step(z, g, y, v);
                    let (y3, v3) = (e[0][0] * y + e[0][1] * v, e[1][0] * y + e[1][1] * v);
                    assert!(
                        (y2 - y3).abs() < 2e-8 && (v2 - v3).abs() < 2e-8,
                        "ωh {phase} ζ {zeta} from ({y}, {v}): ({y2}, {v2}) against ({y3}, {v3})"
                    );
                }
            }
        }
    }

    #[test]
    fn coefficients_stay_finite_and_bounded_at_any_stiffness() {
        for phase in [0.0_f64, 1e-9, 0.5, 2.6, 3.1, 3.2, 6.3, 100.0, 1e6] {
            for g in [0.0, 1e-9, 0.1, 1.0, 30.0, 1e3, 1e9] {
                let p = Poles::new(phase * phase, g);
                for value in [p.restoring, p.loss, p.speed, p.skew] {
                    assert!(value.is_finite(), "ωh {phase} γh {g}: {p:?}");
                }
                assert!(p.speed > 0.0, "ωh {phase} γh {g}: {p:?}");
                // The kick never moves the end beyond the mirror image of its position.
                assert!(p.restoring * phase * phase <= 4.0 + 1e-12);
            }
        }
    }

    #[test]
    fn energy_is_kept_where_the_phase_is_no_longer_resolved() {
        for phase in [2.6_f64, 6.3, 37.0, 100.0, 1e4] {
            let z = phase * phase;
            let (mut y, mut v) = (0.3 / phase, 1.0);
            let energy = |y: f64, v: f64| z * y * y + v * v;
            let start = energy(y, v);
            for _ in 0..100 {
                (y, v) = step(z, 0.0, y, v);
                assert!(energy(y, v) < start * 1.02, "ωh {phase}: gained");
            }
            // Only the decay that damps rounding errors takes energy.
            let least = (-2.0 * 100.0 * UNRESOLVED_DECAY).exp();
            let left = energy(y, v) / start;
            assert!(left > 0.5 * least, "ωh {phase}: {left} left");
        }
    }
}
