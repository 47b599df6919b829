//! Scene: many springs on one hub.

use super::Scene;
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::Vec3;
use std::f64::consts::PI;

const COUNT: usize = 50;

pub const SCENE: Scene = Scene {
    name: "star",
    title: "Star of 50",
    note: "A free hub of 5 kg with 50 satellites of 0.1 kg all round it on springs of 100 N/m and 0.2 N s/m, \
           stretched and swinging, no gravity; the hub and three satellites over 2 s against DOP853.",
    make: star,
    few: false,
};

fn star() -> Problem {
    let mut bodies = vec![Body::point(5.0, Vec3::ZERO)];
    for i in 0..COUNT {
        let z = 1.0 - (2 * i + 1) as f64 / COUNT as f64;
        let turn = i as f64 * PI * (3.0 - 5.0_f64.sqrt());
        let wide = (1.0 - z * z).sqrt();
        let out = bevy::math::DVec3::new(wide * turn.cos(), wide * turn.sin(), z);
        let stretch = 1.0 + 0.05 * (i % 5) as f64;
        let across = out.cross(bevy::math::DVec3::Z) * (0.5 * (1 + i % 3) as f64);
        bodies.push(Body::point(0.1, (out * stretch).as_vec3()).moving(across.as_vec3()));
    }
    Problem {
        gravity: Vec3::ZERO,
        bodies,
        links: (1..=COUNT)
            .map(|i| Link::new(0, i, 100.0, 0.2, 1.0))
            .collect(),
        ground: false,
        seconds: 2.0,
        size: 1.0,
        energy: None,
        truth: Truth::rows(include_str!("../../data/star.csv"), &[0, 1, 18, 50], 3),
    }
}
