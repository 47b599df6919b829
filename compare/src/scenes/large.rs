//! Large scenes: a cloth of 10 000 points, a bridge of 1000 planks, and a tower that sways.

use super::praised::{point, problem, sheet};
use super::{GRAVITY, Scene};
use crate::problem::{Link, Problem, Truth};
use bevy::math::Vec3;

pub const CLOTH: Scene = Scene {
    name: "cloth-100",
    title: "Cloth 100×100",
    note: "The same with 10 000 points and 39 402 springs; a quarter of a second against DOP853. A few settings at two rates.",
    make: cloth,
    few: true,
};

pub const BRIDGE: Scene = Scene {
    name: "bridge-1000",
    title: "Bridge of 1000 planks",
    note: "A thousand and one points of 2 kg, 0.2 m apart along a parabola that sags by 10 m, the outer two fixed, joined by \
           10 MN/m and 2 kN s/m (ω·dt = 75 at 60 Hz), let go without tension, and 500 kg on its middle; points 250, 500 and 501 over \
           2 s against DOP853.",
    make: bridge,
    few: true,
};

pub const TOWER: Scene = Scene {
    name: "tower",
    title: "Tower of springs",
    note: "Twenty-four storeys of 1 m, four points of 5 kg each, and 100 kg more on each of the upmost; columns, beams and diagonals of \
           10 MN/m and 2 kN s/m (ω·dt over 60 at 60 Hz), struck at its top with 2 m/s; both upper corners in front over 3 s against DOP853.",
    make: tower,
    few: false,
};

fn cloth() -> Problem {
    sheet::<100>(include_str!("../../data/cloth-100.csv"), 0.25)
}

fn bridge() -> Problem {
    const PLANKS: usize = 1000;
    let at: Vec<Vec3> = (0..=PLANKS)
        .map(|i| {
            let x = 0.2 * i as f64;
            Vec3::new(x as f32, (-x * (200.0 - x) * 1e-3) as f32, 0.0)
        })
        .collect();
    let mass = |i| match i {
        0 | PLANKS => 0.0,
        500 => 502.0,
        _ => 2.0,
    };
    let bodies = at.iter().enumerate().map(|(i, at)| point(mass(i), *at));
    let links = (1..=PLANKS).map(|i| Link::new(i - 1, i, 1e7, 2e3, at[i].distance(at[i - 1])));
    let truth = include_str!("../../data/bridge-1000.csv");
    let truth = Truth::rows(truth, &[250, 500, 501], 3);
    problem(bodies.collect(), links.collect(), GRAVITY, 2.0, truth)
}

fn tower() -> Problem {
    const STOREYS: usize = 24;
    let at: Vec<Vec3> = (0..4 * (STOREYS + 1))
        .map(|p| {
            let (corner, storey) = (p % 4, p / 4);
            let (x, z) = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)][corner];
            Vec3::new(x, storey as f32, z)
        })
        .collect();
    let mass = |p| match p / 4 {
        0 => 0.0,
        STOREYS => 105.0,
        _ => 5.0,
    };
    let bodies = at.iter().enumerate().map(|(p, at)| {
        let body = point(mass(p), *at);
        if p / 4 == STOREYS {
            body.moving(Vec3::X * 2.0)
        } else {
            body
        }
    });
    let mut links = Vec::new();
    for storey in 1..=STOREYS {
        let (lower, here) = (4 * (storey - 1), 4 * storey);
        for corner in 0..4 {
            let next = (corner + 1) % 4;
            let pairs = [
                (lower + corner, here + corner),
                (here + corner, here + next),
                (lower + corner, here + next),
                (lower + next, here + corner),
            ];
            links.extend(pairs);
        }
        links.extend([(here, here + 2), (here + 1, here + 3)]);
    }
    let links = links
        .into_iter()
        .map(|(a, b)| Link::new(a, b, 1e7, 2e3, at[a].distance(at[b])));
    let truth = include_str!("../../data/tower.csv");
    let truth = Truth::rows(truth, &[4 * STOREYS, 4 * STOREYS + 1], 3);
    problem(bodies.collect(), links.collect(), GRAVITY, 3.0, truth)
}
