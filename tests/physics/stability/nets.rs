//! Descriptions of the networks, before any entity is spawned.

use bevy::prelude::*;

/// A network: points with masses in kg (`None` for a fixed point), and links of two points with a rest length in m.
pub struct Net {
    pub name: &'static str,
    pub points: Vec<(Vec3, Option<f32>)>,
    pub links: Vec<(usize, usize, f32)>,
}

pub const HEAVY: f32 = 1.0;

/// Mass of the i-th body, kg: all alike, or every other one ten thousand times lighter.
fn mass(i: usize, unequal: bool) -> Option<f32> {
    Some(if unequal && i % 2 == 1 {
        1e-4 * HEAVY
    } else {
        HEAVY
    })
}

/// Twenty springs in a zigzag between two hooks, released without strain. They fall, whip and swing.
pub fn chain(unequal: bool, _: f32) -> Net {
    let n = 20;
    let points: Vec<_> = (0..=n)
        .map(|i| {
            let held = i == 0 || i == n;
            let mass = (!held).then(|| mass(i, unequal)).flatten();
            let up = if i % 2 == 1 { 0.23 } else { 0.0 };
            (Vec3::new(0.5 * i as f32, up, 0.0), mass)
        })
        .collect();
    let length = points[0].0.distance(points[1].0);
    Net {
        name: "chain of 20",
        points,
        links: (0..n).map(|i| (i, i + 1, length)).collect(),
    }
}

/// A cube of 6 × 6 × 6 bodies that hangs at the four corners of its top.
pub fn lattice(unequal: bool, _: f32) -> Net {
    let n = 6;
    let index = |x: usize, y: usize, z: usize| (x * n + y) * n + z;
    let (mut points, mut links) = (Vec::new(), Vec::new());
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                let corner = y == n - 1 && (x == 0 || x == n - 1) && (z == 0 || z == n - 1);
                let own = (!corner).then(|| mass(x + y + z, unequal)).flatten();
                points.push((Vec3::new(x as f32, y as f32, z as f32), own));
                let here = index(x, y, z);
                for (nx, ny, nz) in [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)] {
                    if nx < n && ny < n && nz < n {
                        links.push((here, index(nx, ny, nz), 1.0));
                    }
                }
            }
        }
    }
    Net {
        name: "lattice 6×6×6",
        points,
        links,
    }
}

/// A hub with fifty spokes in tension on all sides, each with a weight in its middle. The hub starts a little off its
/// place, and less so for stiffer networks, so that speeds stay below the engine's cap.
pub fn star(unequal: bool, phase: f32) -> Net {
    let n = 50;
    let strain = 0.02 / phase;
    let hub = if unequal { 1e-4 * HEAVY } else { HEAVY };
    let mut points = vec![(Vec3::new(2.0, 1.0, 0.0) * strain, Some(hub))];
    let mut links = Vec::new();
    for i in 0..n {
        // The spokes follow a spiral from pole to pole.
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / n as f32;
        let around = 2.4 * i as f32;
        let r = (1.0 - y * y).sqrt();
        let direction = Vec3::new(r * around.cos(), y, r * around.sin());
        let at = points.len();
        points.extend([(direction, Some(HEAVY)), (2.0 * direction, None)]);
        links.extend([(0, at, 1.0 - strain), (at, at + 1, 1.0 - strain)]);
    }
    Net {
        name: "star of 50",
        points,
        links,
    }
}

/// Three struts that do not touch and six cables on three fixed feet: a twisted prism under its own tension. It starts a
/// little off its place.
pub fn tensegrity(unequal: bool, phase: f32) -> Net {
    let strain = 0.02 / phase;
    let ring = |y: f32, turn: f32| {
        (0..3).map(move |i| {
            let angle = turn + std::f32::consts::TAU / 3.0 * i as f32;
            Vec3::new(angle.cos(), y, angle.sin())
        })
    };
    let mut points: Vec<(Vec3, Option<f32>)> = ring(0.0, 0.0).map(|p| (p, None)).collect();
    // Turned by 150° against the bottom, the prism is in equilibrium.
    let top = ring(1.5, 150.0_f32.to_radians());
    points.extend(top.enumerate().map(|(i, p)| (p, mass(i, unequal))));
    let mut links = Vec::new();
    for i in 0..3 {
        let (own, next) = (3 + i, 3 + (i + 1) % 3);
        // The cable of the top, the slanting cable, and the strut.
        for (a, b, part) in [
            (own, next, 1.0 - strain),
            (i, next, 1.0 - strain),
            (i, own, 1.0 + strain),
        ] {
            links.push((a, b, part * points[a].0.distance(points[b].0)));
        }
    }
    for point in &mut points[3..] {
        point.0 += Vec3::new(0.5, 0.3, -0.2) * strain;
    }
    Net {
        name: "tensegrity prism",
        points,
        links,
    }
}
