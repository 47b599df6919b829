//! Scenes: the elastic pendulum, soft, damped and stiff.

use super::{GRAVITY, Scene};
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::Vec3;

pub const SOFT: Scene = Scene {
    name: "pendulum-soft",
    title: "Elastic pendulum, soft",
    note: "1 kg on 1 m of spring, 50 N/m, undamped, released level; 10 s against DOP853.",
    make: || {
        let rows = include_str!("../../../tests/data/pendulum_k50.csv");
        pendulum(50.0, 0.0, rows)
    },
    few: false,
};

pub const DAMPED: Scene = Scene {
    name: "pendulum-damped",
    title: "Elastic pendulum, damped",
    note: "The same with 500 N/m and 5 N s/m; 10 s against DOP853.",
    make: || {
        let rows = include_str!("../../../tests/data/pendulum_k500_c5.csv");
        pendulum(500.0, 5.0, rows)
    },
    few: false,
};

pub const STIFF: Scene = Scene {
    name: "pendulum-stiff",
    title: "Elastic pendulum, stiff",
    note: "The same with 50 000 N/m and 100 N s/m (ω·dt = 3.7 at 60 Hz); 10 s against DOP853.",
    make: || {
        let rows = include_str!("../../../tests/data/pendulum_k50000_c100.csv");
        pendulum(50e3, 100.0, rows)
    },
    few: false,
};

fn pendulum(stiffness: f32, damping: f32, rows: &str) -> Problem {
    Problem {
        gravity: Vec3::NEG_Y * GRAVITY,
        bodies: vec![Body::fixed(Vec3::ZERO), Body::point(1.0, Vec3::X)],
        links: vec![Link::new(0, 1, stiffness, damping, 1.0)],
        ground: false,
        seconds: 10.0,
        size: 1.0,
        // Potential energy of 1 kg over a height of 1 m.
        energy: (damping == 0.0).then_some(f64::from(GRAVITY)),
        truth: Truth::rows(rows, &[1], 2),
    }
}
