//! Scenes: point masses joined into a chain and into a sheet.

use super::{GRAVITY, Scene};
use crate::problem::{Body, Link, Problem, Truth};
use bevy::math::Vec3;

pub const CHAIN: Scene = Scene {
    name: "chain",
    title: "Chain of 10",
    note: "Ten points of 0.1 kg, 0.2 m apart, hung from a fixed one and released level, 100 N/m and 0.5 N s/m; \
           points 5 and 10 over 1 s against DOP853.",
    make: chain,
    few: false,
};

pub const LATTICE: Scene = Scene {
    name: "lattice",
    title: "Lattice 6×6",
    note: "Points of 0.05 kg, 0.1 m apart, springs of 100 N/m and 0.5 N s/m along edges and diagonals, hung at \
           two corners; points 14, 33 and 35 over 1 s against DOP853.",
    make: lattice,
    few: false,
};

fn chain() -> Problem {
    let at: Vec<Vec3> = (0..=10).map(|i| Vec3::X * 0.2 * i as f32).collect();
    let pairs: Vec<_> = (0..10).map(|i| (i, i + 1)).collect();
    let rows = include_str!("../../../tests/data/chain10_k100_c0.5.csv");
    net(&at, &[0], 0.1, &pairs, Truth::rows(rows, &[5, 10], 2))
}

fn lattice() -> Problem {
    const SIDE: usize = 6;
    let mut pairs = Vec::new();
    for row in 0..SIDE {
        for column in 0..SIDE {
            let at = |right: usize, down: usize| (row + down) * SIDE + column + right;
            let (inner, above) = (column + 1 < SIDE, row + 1 < SIDE);
            if inner {
                pairs.push((at(0, 0), at(1, 0)));
            }
            if above {
                pairs.push((at(0, 0), at(0, 1)));
            }
            if inner && above {
                pairs.push((at(0, 0), at(1, 1)));
                pairs.push((at(1, 0), at(0, 1)));
            }
        }
    }
    let at: Vec<Vec3> = (0..SIDE * SIDE)
        .map(|p| Vec3::new(0.1 * (p % SIDE) as f32, -0.1 * (p / SIDE) as f32, 0.0))
        .collect();
    let rows = include_str!("../../../tests/data/lattice6_k100_c0.5.csv");
    let truth = Truth::rows(rows, &[14, 33, 35], 2);
    net(&at, &[0, SIDE - 1], 0.05, &pairs, truth)
}

/// A network of point masses. Every spring starts at its rest length.
fn net(at: &[Vec3], fixed: &[usize], mass: f32, pairs: &[(usize, usize)], truth: Truth) -> Problem {
    let body = |(i, at): (usize, &Vec3)| {
        if fixed.contains(&i) {
            Body::fixed(*at)
        } else {
            Body::point(mass, *at)
        }
    };
    Problem {
        gravity: Vec3::NEG_Y * GRAVITY,
        bodies: at.iter().enumerate().map(body).collect(),
        links: pairs
            .iter()
            .map(|(a, b)| Link::new(*a, *b, 100.0, 0.5, at[*a].distance(at[*b])))
            .collect(),
        ground: false,
        seconds: 1.0,
        size: 1.0,
        energy: None,
        truth,
    }
}
