//! Scene: Duffing's oscillator, a body on a hardening spring.

use super::Scene;
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::{DVec3, Vec3};

/// Angular frequency for small amplitudes, rad/s.
const OMEGA: f64 = 6.0;
const SECONDS: f64 = 10.0;
/// Number of steps of the reference solution per 1/960 s.
const FINE: u32 = 20;

pub const SCENE: Scene = Scene {
    name: "duffing",
    title: "Duffing's oscillator",
    note: "1 kg on a spring with tension ω²(x + x³), ω = 6 rad/s (ω·dt = 0.1 at 60 Hz), from x = 1 m at rest; 10 s \
           against the classic Runge–Kutta in steps of 5e-5 s. No joint has such a law.",
    make: || Problem {
        gravity: Vec3::ZERO,
        bodies: vec![Body::fixed(Vec3::NEG_X * 3.0), Body::point(1.0, Vec3::X)],
        links: vec![Link::new(0, 1, 36.0, 0.0, 3.0).hardening(36.0)],
        ground: false,
        seconds: SECONDS,
        size: 1.0,
        energy: Some(36.0 * (0.5 + 0.25)),
        truth: truth(),
    },
    few: false,
};

fn truth() -> Truth {
    let h = 1.0 / (960.0 * f64::from(FINE));
    let force = |x: f64| -OMEGA * OMEGA * (x + x * x * x);
    let (mut x, mut v) = (1.0, 0.0);
    let mut places = vec![x];
    for _ in 0..(960.0 * SECONDS) as usize {
        for _ in 0..FINE {
            let (k1, l1) = (v, force(x));
            let (k2, l2) = (v + 0.5 * h * l1, force(x + 0.5 * h * k1));
            let (k3, l3) = (v + 0.5 * h * l2, force(x + 0.5 * h * k2));
            let (k4, l4) = (v + h * l3, force(x + h * k3));
            x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            v += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
        }
        places.push(x);
    }
    Truth {
        watched: vec![1],
        at: Box::new(move |t| {
            let row = (t * 960.0).round();
            let exact = (t * 960.0 - row).abs() < 1e-6;
            let x = places.get(row as usize).filter(|_| exact)?;
            Some(vec![DVec3::X * *x])
        }),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_reference_has_the_period_of_the_elliptic_integral_and_the_known_place() {
        let truth = super::truth();
        // After one period, 4.768022/ω, the body is at x = 1 m again, at rest. The nearest point of the 1/960 s grid
        // is `near`. There x is smaller by half the acceleration (72 m/s²) times the squared time difference.
        let period = 4.768_022 / super::OMEGA;
        let near = (period * 960.0).round() / 960.0;
        let x = (truth.at)(near).map_or(0.0, |at| at[0].x);
        let bend = 0.5 * 72.0 * (near - period) * (near - period);
        assert!((x - 1.0 + bend).abs() < 1e-6, "{x}");
    }
}
