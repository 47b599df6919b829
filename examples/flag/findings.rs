//! Compares the force on the pole with theory, and records how the cloth tears.

use super::cloth::{MASS, Point, Thread};
use super::{GUST, SECONDS};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{DT, Finding, larger, smaller};

const GRAVITY: f32 = 9.81;
/// Time spans of the means, s: before the gust and after it.
const CALM: [[f32; 2]; 2] = [[4.0, GUST[0]], [GUST[1] + 5.0, SECONDS]];

#[derive(Resource, Default)]
pub struct Seen {
    /// Force of the wind on all free points in this tick, N.
    pub drag: Vec3,
    /// Momentum of all points after the last tick, N s.
    momentum: Vec3,
    /// Forces at which threads broke, relative to their limits.
    pub broke: Vec<f32>,
    /// Mean force on the pole, and the theory for it, N, in both time spans of `CALM`.
    pole: [[Vec3; 2]; 2],
    /// Number of threads that broke before the gust.
    early: usize,
    /// Greatest length of an edge before the gust, relative to its rest length.
    longest: f32,
    /// Greatest speed of a point after the gust, m/s.
    fastest: f32,
}

pub fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    places: Query<&Transform>,
    points: Query<&Velocity, With<Point>>,
    threads: Query<(&Thread, &SpringDamper, &SpringReadout)>,
) {
    let t = time.elapsed_secs();
    let long = super::cloth::SIZE[0];
    let momentum: Vec3 = points.iter().map(|v| MASS * v.linear).sum();
    let gained = (momentum - std::mem::replace(&mut seen.momentum, momentum)) / DT;
    if t < GUST[0] {
        seen.early = seen.broke.len();
        let edges = threads.iter().filter(|(thread, ..)| thread.over.is_empty());
        let longest = edges
            .map(|(_, spring, readout)| readout.length / spring.rest_length.unwrap_or(f32::NAN));
        seen.longest = longest.fold(seen.longest, larger);
    }
    for (i, [from, to]) in CALM.into_iter().enumerate() {
        if !(from..to).contains(&t) {
            continue;
        }
        let mut pulls = Vec3::ZERO;
        for (thread, spring, readout) in &threads {
            let sewn = thread.ends.map(|end| end % long == 0);
            if sewn != [false, false]
                && let Ok([a, b]) = places.get_many([spring.body_a, spring.body_b])
            {
                let along = (b.translation - a.translation).normalize_or_zero();
                pulls += readout.force() * if sewn[0] { along } else { -along };
            }
        }
        let count = points.iter().count() as f32;
        let share = DT / (to - from);
        let should = seen.drag - count * MASS * GRAVITY * Vec3::Y - gained;
        seen.pole[i][0] += share * pulls;
        seen.pole[i][1] += share * should;
        if i == 1 {
            let speeds = points.iter().map(|v| v.linear.length());
            seen.fastest = speeds.fold(seen.fastest, larger);
        }
    }
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let left = world.query::<&Point>().iter(world).count() as f32;
    let seen = world.resource::<Seen>();
    let [whole, torn] = seen.pole;
    let least = seen.broke.iter().copied().fold(f32::INFINITY, smaller);
    vec![
        Finding::close(
            "drag in the breeze, at the pole",
            whole[0].x,
            whole[1].x,
            "N",
            0.02,
        ),
        Finding::close("  its weight there", -whole[0].y, -whole[1].y, "N", 0.02),
        Finding::small("  threads that broke", seen.early as f32, 0.5, ""),
        Finding::between(
            "  the longest thread",
            seen.longest,
            1.0,
            1.15,
            "of its length",
        ),
        Finding::between(
            "threads torn by the gust",
            seen.broke.len() as f32,
            10.0,
            400.0,
            "",
        ),
        Finding::between("  the first at", least, 1.0, 1.2, "of what it bears"),
        Finding::between("points left", left, 24.0, 215.0, ""),
        Finding::close(
            "drag of what is left, at the pole",
            torn[0].x,
            torn[1].x,
            "N",
            0.02,
        ),
        Finding::close("  its weight there", -torn[0].y, -torn[1].y, "N", 0.02),
        Finding::between("  its fastest point", seen.fastest, 0.1, 12.0, "m/s"),
    ]
}
