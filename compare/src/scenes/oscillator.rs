//! Scene: one body on one spring, moving along one line.

use super::Scene;
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::{DVec3, Vec3};

/// Initial stretch, m.
pub const AMPLITUDE: f64 = 0.1;

pub const SCENE: Scene = Scene {
    name: "oscillator",
    title: "Single oscillator",
    note: "1 kg on a fixed point, along the line, ω = 18 rad/s (ω·dt = 0.3 at 60 Hz), ζ = 0.1, stretched by \
           0.1 m and pushed outwards, no gravity; 5 s against the formula.",
    make: || oscillator(18.0, 0.1, 5.0),
    few: false,
};

/// A body of 1 kg on a spring with an angular frequency (rad/s) and a damping ratio.
pub fn oscillator(omega: f64, zeta: f64, seconds: f64) -> Problem {
    // The engine gets single-precision numbers, so the truth is computed from the rounded numbers.
    let stiffness = (omega * omega) as f32;
    let damping = (2.0 * zeta * omega) as f32;
    let omega = f64::from(stiffness).sqrt();
    let zeta = 0.5 * f64::from(damping) / omega;
    let velocity = (0.5 * omega * AMPLITUDE) as f32;
    let place = 1.0 + AMPLITUDE as f32;
    let start = (f64::from(place) - 1.0, f64::from(velocity));
    let energy = 0.5 * (start.1.powi(2) + (omega * start.0).powi(2));
    Problem {
        gravity: Vec3::ZERO,
        bodies: vec![
            Body::fixed(Vec3::ZERO),
            Body::point(1.0, Vec3::X * place).moving(Vec3::X * velocity),
        ],
        links: vec![Link::new(0, 1, stiffness, damping, 1.0)],
        ground: false,
        seconds,
        size: AMPLITUDE,
        energy: (zeta == 0.0).then_some(energy),
        truth: Truth::formula(1, move |t| {
            DVec3::X * (1.0 + free(omega, zeta, start.0, start.1, t))
        }),
    }
}

/// Solution y(t) of y'' + 2ζω y' + ω² y = 0 with y(0) = y and y'(0) = v.
pub fn free(omega: f64, zeta: f64, y: f64, v: f64, t: f64) -> f64 {
    let gamma = zeta * omega;
    let square = omega * omega - gamma * gamma;
    let root = square.abs().sqrt();
    // cos and sin/root, or cosh and sinh/root if overdamped, each times the decay. The overdamped case adds the
    // exponents before it takes the exponential, because cosh and sinh alone would overflow.
    let (c, s) = if root * t < 1e-9 {
        ((-gamma * t).exp(), t * (-gamma * t).exp())
    } else if square > 0.0 {
        let decay = (-gamma * t).exp();
        (decay * (root * t).cos(), decay * (root * t).sin() / root)
    } else {
        let (slow, fast) = (((root - gamma) * t).exp(), ((-root - gamma) * t).exp());
        (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
    };
    y * c + (v + gamma * y) * s
}

#[cfg(test)]
mod tests {
    use super::free;

    #[test]
    fn the_formula_solves_the_equation() {
        for zeta in [0.0, 0.1, 1.0, 3.0] {
            let (omega, h, t) = (2.0, 1e-4, 0.7);
            let y = |t| free(omega, zeta, 0.3, -0.2, t);
            let rate = (y(t + h) - y(t - h)) / (2.0 * h);
            let bend = (y(t + h) - 2.0 * y(t) + y(t - h)) / (h * h);
            let rest = bend + 2.0 * zeta * omega * rate + omega * omega * y(t);
            assert!(rest.abs() < 1e-5, "ζ {zeta}: {rest:e}");
            assert!((y(0.0) - 0.3).abs() < 1e-12);
        }
    }
}
