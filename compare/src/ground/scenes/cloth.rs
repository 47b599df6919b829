//! Scene: balls on a wide cloth of light points.

use super::{Head, Scene, Unit};
use crate::ground::stage::{Motion, Part, Shape, Stage};
use bevy::math::Vec3;

const SIDE: usize = 30;
const PITCH: f32 = 0.1;

pub const SCENE: Scene = Scene {
    name: "cloth",
    title: "Balls on a cloth",
    note: "Balls of 2, 3 and 5 kg fall 1.2 m onto a cloth of 30 × 30 points, which is held at its rim. \
           Its springs have 3 kN/m and its points 0.05 kg each. \
           The figure is the greatest energy over 15 s less that at first: above zero the method has gained energy from nothing.",
    speeds: &[0.0],
    heads: &[Head {
        name: "energy gain",
        unit: Unit::Joule,
    }],
    make: |_| cloth(),
    figures: |run| {
        let [most, _] = run.most(15.0);
        vec![most - run.first()]
    },
    quick: false,
};

fn is_rim(point: usize) -> bool {
    let (x, z) = (point % SIDE, point / SIDE);
    [x, z].iter().any(|n| *n == 0 || *n == SIDE - 1)
}

fn cloth() -> Stage {
    let mut stage = Stage::default();
    let middle = 0.5 * (SIDE - 1) as f32;
    for i in 0..SIDE * SIDE {
        let (x, z) = (i % SIDE, i / SIDE);
        let at = PITCH * Vec3::new(x as f32 - middle, 0.0, z as f32 - middle) + Vec3::Y * 3.0;
        stage.part(if is_rim(i) {
            Part::held(Motion::Fixed, at, None)
        } else {
            // The points of the cloth collide with balls only.
            let point = Part::new(0.05, at, Some(Shape::Ball(0.04)));
            point.upright().grouped(1, 2)
        });
    }
    for i in 0..SIDE * SIDE {
        let (x, z) = (i % SIDE, i / SIDE);
        for (fits, j) in [(x + 1 < SIDE, i + 1), (z + 1 < SIDE, i + SIDE)] {
            // A spring between two fixed points would have no effect.
            if fits && !(is_rim(i) && is_rim(j)) {
                stage.coil([i, j], [Vec3::ZERO; 2], [3e3, 1.0], Some(0.8 * PITCH));
            }
        }
    }
    for (x, z, radius, mass) in [
        (-0.5, 0.2, 0.3, 5.0),
        (0.5, -0.3, 0.25, 3.0),
        (0.3, 0.6, 0.2, 2.0),
    ] {
        let ball = Part::new(mass, Vec3::new(x, 4.5, z), Some(Shape::Ball(radius)));
        stage.part(ball.grouped(2, u32::MAX));
    }
    stage
}
