//! Scenes that other methods use as demonstrations: large ratios of stiffness and of mass, and a cloth.
//!
//! Spring Ratio and Heavy Rope follow the demonstration of AVBD, Augmented Vertex Block Descent (Giles, Diaz and Yuksel
//! 2025), but with points instead of boxes and with added dampers. Without dampers the true motion never comes to rest.

use super::{GRAVITY, Scene};
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::Vec3;

pub const SPRING_RATIO: Scene = Scene {
    name: "spring-ratio",
    title: "Spring Ratio",
    note: "Eight points of 0.5 kg in a row, 4 m apart, both ends fixed, their springs in turn 1 MN/m with 1 kN s/m and 1 kN/m with \
           30 N s/m, stretched from 1.1 m to 4 m, g = 10 m/s²; points 2 to 4 over 3 s against an implicit Runge–Kutta \
           method (Radau, 1e-10).",
    make: spring_ratio,
    few: false,
};

pub const HEAVY_ROPE: Scene = Scene {
    name: "heavy-rope",
    title: "Heavy Rope",
    note: "Nineteen links of 1 m, 1 MN/m and 500 N s/m, eighteen points of 0.5 kg between them and 900 kg at the end, \
           let go level; the load over 3 s against an implicit Runge–Kutta method (Radau, 1e-10).",
    make: heavy_rope,
    few: false,
};

pub const CLOTH: Scene = Scene {
    name: "cloth",
    title: "Cloth 32×32",
    note: "Points of 0.01 kg, 0.05 m apart, 3906 springs of 400 N/m and 0.5 N s/m along edges and diagonals, hung at two corners \
           and let go as a slanted sheet; the middle and two corners over 0.5 s against DOP853. Later it folds, and where it goes then depends on \
           the last digit.",
    make: cloth,
    few: false,
};

pub(super) fn point(mass: f32, at: Vec3) -> Body {
    if mass > 0.0 {
        Body::point(mass, at)
    } else {
        Body::fixed(at)
    }
}

pub(super) fn problem(
    bodies: Vec<Body>,
    links: Vec<Link>,
    gravity: f32,
    seconds: f64,
    truth: Truth,
) -> Problem {
    Problem {
        gravity: Vec3::NEG_Y * gravity,
        bodies,
        links,
        ground: false,
        seconds,
        size: 1.0,
        energy: None,
        truth,
    }
}

fn spring_ratio() -> Problem {
    let mass = |i| if i == 0 || i == 7 { 0.0 } else { 0.5 };
    let bodies = (0..8).map(|i| point(mass(i), Vec3::new(4.0 * i as f32, 10.0, 0.0)));
    let links = (1..8).map(|i| {
        let (stiffness, damping) = if i % 2 == 0 {
            (1e3, 30.0)
        } else {
            (1e6, 1000.0)
        };
        Link::new(i - 1, i, stiffness, damping, 1.1)
    });
    let truth = Truth::rows(include_str!("../../data/spring-ratio.csv"), &[2, 3, 4], 3);
    problem(bodies.collect(), links.collect(), 10.0, 3.0, truth)
}

fn heavy_rope() -> Problem {
    let mass = |i| match i {
        0 => 0.0,
        19 => 900.0,
        _ => 0.5,
    };
    let bodies = (0..20).map(|i| point(mass(i), Vec3::X * i as f32));
    let links = (1..20).map(|i| Link::new(i - 1, i, 1e6, 500.0, 1.0));
    let truth = Truth::rows(include_str!("../../data/heavy-rope.csv"), &[19], 3);
    problem(bodies.collect(), links.collect(), GRAVITY, 3.0, truth)
}

fn cloth() -> Problem {
    sheet::<32>(include_str!("../../data/cloth.csv"), 0.5)
}

/// A square cloth of `SIDE` × `SIDE` points, hung at two corners. Its middle and its lower corners are watched.
pub(super) fn sheet<const SIDE: usize>(truth: &str, seconds: f64) -> Problem {
    let at: Vec<Vec3> = (0..SIDE * SIDE)
        .map(|p| {
            let (column, row) = ((p % SIDE) as f64, (p / SIDE) as f64);
            Vec3::new(
                (0.05 * column) as f32,
                (-0.05 * row * 0.8) as f32,
                (0.05 * row * 0.6) as f32,
            )
        })
        .collect();
    let mass = |p| if p == 0 || p == SIDE - 1 { 0.0 } else { 0.01 };
    let bodies = at.iter().enumerate().map(|(p, at)| point(mass(p), *at));
    let mut links = Vec::new();
    for (row, column) in (0..SIDE * SIDE).map(|p| (p / SIDE, p % SIDE)) {
        for (right, down) in [(1, 0), (0, 1), (1, 1), (-1, 1)] {
            let (beside, below) = (column.checked_add_signed(right), row + down);
            let Some(beside) = beside.filter(|beside| *beside < SIDE && below < SIDE) else {
                continue;
            };
            let (a, b) = (row * SIDE + column, below * SIDE + beside);
            links.push(Link::new(a, b, 400.0, 0.5, at[a].distance(at[b])));
        }
    }
    let watched = [
        SIDE * SIDE / 2 + SIDE / 2,
        SIDE * (SIDE - 1),
        SIDE * SIDE - 1,
    ];
    let truth = Truth::rows(truth, &watched, 3);
    problem(bodies.collect(), links, GRAVITY, seconds, truth)
}
