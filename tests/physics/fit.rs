//! Least-squares fits of measured motions, and the exact solution of the damped oscillator.

/// y ≈ offset + cosine·cos ωt + sine·sin ωt.
#[derive(Clone, Copy, Debug)]
pub struct Sine {
    pub cosine: f64,
    pub sine: f64,
    /// Sum of squared residuals.
    pub residual: f64,
}

impl Sine {
    pub fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }

    /// Best fit with a known angular frequency, rad/s. Samples are (t, y).
    pub fn fit(samples: &[(f64, f64)], omega: f64) -> Self {
        let basis = |t: f64| [1.0, (omega * t).cos(), (omega * t).sin()];
        let mut m = [[0.0_f64; 4]; 3];
        for (t, y) in samples {
            let b = basis(*t);
            for r in 0..3 {
                for c in 0..3 {
                    m[r][c] += b[r] * b[c];
                }
                m[r][3] += b[r] * y;
            }
        }
        for i in 0..3 {
            let pivot = m[i];
            for r in (0..3).filter(|r| *r != i) {
                let factor = m[r][i] / pivot[i];
                for c in 0..4 {
                    m[r][c] -= factor * pivot[c];
                }
            }
        }
        let [offset, cosine, sine] = [0, 1, 2].map(|i| m[i][3] / m[i][i]);
        let residual = samples
            .iter()
            .map(|(t, y)| {
                let b = basis(*t);
                (y - offset - cosine * b[1] - sine * b[2]).powi(2)
            })
            .sum();
        Self {
            cosine,
            sine,
            residual,
        }
    }
}

/// Angular frequency of the best fit, within 1 % of `guess`.
pub fn frequency(samples: &[(f64, f64)], guess: f64) -> f64 {
    let (mut low, mut high) = (guess * 0.99, guess * 1.01);
    for _ in 0..80 {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if Sine::fit(samples, a).residual < Sine::fit(samples, b).residual {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}

/// Exact free motion at time t from the initial state (y, v), with angular frequency ω and damping ratio ζ.
pub fn exact(omega: f64, zeta: f64, y: f64, v: f64, t: f64) -> f64 {
    let gamma = zeta * omega;
    let square = omega * omega - gamma * gamma;
    if square.abs() < 1e-9 * omega * omega {
        return (-gamma * t).exp() * (y + (v + gamma * y) * t);
    }
    if square > 0.0 {
        let w = square.sqrt();
        (-gamma * t).exp() * (y * (w * t).cos() + (v + gamma * y) / w * (w * t).sin())
    } else {
        let r = (-square).sqrt();
        let (slow, fast) = (-(omega * omega) / (gamma + r), -gamma - r);
        let a = (v - fast * y) / (slow - fast);
        a * (slow * t).exp() + (y - a) * (fast * t).exp()
    }
}
