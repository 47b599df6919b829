//! The force of the wind on the cloth: pressure on each cell as on a plate, and friction along it.

use super::GUST;
use super::cloth::{Flag, MASS, Point};
use super::findings::Seen;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::DT;

/// Density of the air, kg/m³.
const AIR: f32 = 1.2;
/// Drag coefficient of a plate across the wind.
const ACROSS: f32 = 1.3;
/// Friction coefficient of cloth along the wind.
const ALONG: f32 = 0.06;
/// Speed of the wind before and after the gust, m/s.
const BREEZE: f32 = 6.0;
/// Speed of the wind in the gust, m/s. At 34 m/s the least rounding decides whether 5 threads tear or 50.
const STORM: f32 = 44.0;

/// Returns the velocity of the air, m/s. Eddies travel with the air.
fn wind(t: f32, at: Vec3) -> Vec3 {
    let rise = |from: f32| ((t - from) / 1.5).clamp(0.0, 1.0);
    let speed = BREEZE + (STORM - BREEZE) * (rise(GUST[0]) - rise(GUST[1]));
    let eddy = |long: f32, fast: f32| (at.x * long - fast * t + 2.0 * at.y).sin();
    let aside = 0.16 * eddy(2.3, 9.0) + 0.10 * eddy(1.1, 4.1);
    let up = 0.05 * eddy(1.7, 6.3);
    speed * Vec3::new(1.0 + 0.12 * eddy(0.7, 1.9), up, aside)
}

pub fn blow(
    time: Res<Time>,
    flag: Res<Flag>,
    mut seen: ResMut<Seen>,
    places: Query<(&Transform, Option<&Velocity>)>,
    mut points: Query<(&Point, &mut ExternalForce)>,
) {
    let t = time.elapsed_secs();
    let mut forces = vec![Vec3::ZERO; flag.points.len()];
    for cell in &flag.cells {
        let Ok(corners) = places.get_many(cell.map(|i| flag.points[i])) else {
            continue;
        };
        let [a, b, c, d] = corners.map(|(at, _)| at.translation);
        let moves = corners.map(|(_, v)| v.map_or(Vec3::ZERO, |v| v.linear));
        let center = 0.25 * (a + b + c + d);
        let past = wind(t, center) - 0.25 * moves.into_iter().sum::<Vec3>();
        let area = 0.5 * (d - a).cross(c - b);
        let (normal, area) = (area.normalize_or_zero(), area.length());
        let through = past.dot(normal);
        let pushes = 0.5 * AIR * area * ACROSS * through.abs();
        let drags = 0.5 * AIR * area * ALONG * past.length();
        // Implicit in the velocity of the cloth: with an explicit force, cloth this light would oscillate.
        let push = pushes / (1.0 + 2.0 * pushes * DT / MASS) * through * normal;
        let force = push + drags * (past - through * normal);
        for i in cell {
            forces[*i] += 0.25 * force;
        }
    }
    seen.drag = Vec3::ZERO;
    for (point, mut force) in &mut points {
        force.force = forces[point.0];
        seen.drag += forces[point.0];
    }
}
