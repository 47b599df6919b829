//! Scene: two spinning bricks, joined by a spring with off-centre anchors.

use super::Scene;
use crate::problem::{Body, Kind, Link, Problem, Truth};
use bevy::math::Vec3;

pub const SCENE: Scene = Scene {
    name: "dumbbell",
    title: "Spinning dumbbell",
    note: "Two free bricks of 2 kg and 0.5 kg, spinning, on one undamped spring of 20 N/m with off-centre \
           anchors, no gravity; both centres over 3 s against DOP853.",
    make: dumbbell,
    few: false,
};

fn dumbbell() -> Problem {
    let brick = |mass, inertia, at| Body::new(Kind::Free { mass, inertia }, at);
    Problem {
        gravity: Vec3::ZERO,
        bodies: vec![
            brick(2.0, Vec3::new(0.2, 0.3, 0.45), Vec3::ZERO)
                .moving(Vec3::new(0.0, -0.25, -0.125))
                .spinning(Vec3::new(1.0, -2.0, 0.5)),
            brick(0.5, Vec3::new(0.02, 0.05, 0.06), Vec3::new(2.0, 0.3, -0.1))
                .moving(Vec3::new(0.0, 1.0, 0.5))
                .spinning(Vec3::new(-1.0, 0.5, 3.0)),
        ],
        links: vec![Link {
            anchors: [Vec3::new(0.4, 0.2, 0.1), Vec3::new(-0.3, 0.1, 0.2)],
            ..Link::new(0, 1, 20.0, 0.0, 1.0)
        }],
        ground: false,
        seconds: 3.0,
        size: 1.0,
        // Scale of the initial energy, which is 2.4 J: 1.4 J kinetic and 1.0 J in the spring.
        energy: Some(3.0),
        truth: Truth::rows(include_str!("../../data/dumbbell.csv"), &[0, 1], 3),
    }
}
