//! Compares the free fall, the energy, and the shape at rest before and after the ball with theory and statics.

use super::ball::{self, Ball, WEIGHT};
use super::lattice::{Jelly, Link, MASS, Point, RADIUS};
use super::statics::rest;
use super::{BALL, SECONDS};
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{DT, Finding, larger};

const GRAVITY: f32 = 9.81;
/// Time at which the first free fall ends, s.
const FALL: f32 = 0.1;
/// Times at which the jelly is at rest, s: before the ball, and at the end.
const RESTS: [f32; 2] = [BALL - 0.5, SECONDS - 0.5];

#[derive(Resource, Default)]
pub struct Seen {
    /// Mean height of all points at the start, m.
    from: Option<f32>,
    /// Largest error of that height in free fall, m.
    fall: f32,
    /// Total energy at the start, J.
    begun: f32,
    /// Largest increase of the energy until the ball comes, J.
    most: f32,
    /// Total energy when the ball comes, J.
    ball: Option<f32>,
    /// Largest increase of the energy since then, J.
    most_with_ball: f32,
    /// State at rest, before the ball and at the end.
    rests: [Option<Rest>; 2],
    /// Largest drop of the highest point since the rest before the ball, m.
    deepest: f32,
}

struct Rest {
    /// Positions of the points, m.
    places: Vec<Vec3>,
    /// Greatest speed of a point, m/s.
    fastest: f32,
    /// Vertical force of the springs across a cut at half height, and the weight of the points above it, N.
    carried: [f32; 2],
}

pub fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    jelly: Res<Jelly>,
    points: Query<(&Transform, &Velocity), With<Point>>,
    balls: Query<(&Transform, &Velocity), With<Ball>>,
    springs: Query<(&Link, &SpringReadout)>,
) {
    let t = time.elapsed_secs();
    let energy = |mass: f32, (at, v): (&Transform, &Velocity)| {
        mass * (GRAVITY * at.translation.y + 0.5 * v.linear.length_squared())
    };
    let mut all: f32 = points.iter().map(|point| energy(MASS, point)).sum();
    all += springs
        .iter()
        .map(|(_, r)| r.stored_energy + r.dissipated_energy)
        .sum::<f32>();
    if let Ok(ball) = balls.single() {
        // Includes the rotation: 2/5 m r² ω² of a rolling ball is 2/5 m v².
        let turning = 0.2 * WEIGHT * (ball::RADIUS * ball.1.angular.length()).powi(2);
        all += energy(WEIGHT, ball) + turning;
        let begun = *seen.ball.get_or_insert(all);
        seen.most_with_ball = seen.most_with_ball.max(all - begun);
    } else {
        if seen.from.is_none() {
            seen.begun = all;
        }
        seen.most = seen.most.max(all - seen.begun);
    }
    let heights = points.iter().map(|(at, _)| at.translation.y);
    let middle = heights.clone().sum::<f32>() / heights.len() as f32;
    let from = *seen.from.get_or_insert(middle + 0.5 * GRAVITY * DT * DT);
    if t < FALL {
        let theory = from - 0.5 * GRAVITY * t * t;
        seen.fall = seen.fall.max((middle - theory).abs());
    }
    for (i, moment) in RESTS.into_iter().enumerate() {
        if (t - moment).abs() < 0.5 * DT {
            seen.rests[i] = look(&jelly, &points, &springs);
        }
    }
    if t > BALL {
        let top = heights.fold(f32::NEG_INFINITY, larger);
        if let Some(Rest { places, .. }) = &seen.rests[0] {
            let was = places.iter().map(|p| p.y).fold(f32::NEG_INFINITY, larger);
            seen.deepest = seen.deepest.max(was - top);
        }
    }
}

/// Returns positions, greatest speed, and the force across a cut at half height.
fn look(
    jelly: &Jelly,
    points: &Query<(&Transform, &Velocity), With<Point>>,
    springs: &Query<(&Link, &SpringReadout)>,
) -> Option<Rest> {
    let all: Vec<_> = jelly.0.iter().filter_map(|p| points.get(*p).ok()).collect();
    let places: Vec<Vec3> = all.iter().map(|(at, _)| at.translation).collect();
    let speeds = all.iter().map(|(_, v)| v.linear.length());
    let heights = places.iter().map(|p| p.y);
    let (low, high) = heights
        .clone()
        .fold((f32::MAX, f32::MIN), |(a, b), y| (a.min(y), b.max(y)));
    let cut = 0.5 * (low + high);
    let above = heights.filter(|y| *y > cut).count() as f32 * MASS * GRAVITY;
    let carried = springs.iter().map(|(Link([a, b]), readout)| {
        let [a, b] = [places[*a], places[*b]];
        if (a.y > cut) == (b.y > cut) {
            return 0.0;
        }
        -readout.force() * (a - b).normalize_or_zero().y.abs()
    });
    Some(Rest {
        fastest: speeds.fold(0.0, larger),
        carried: [carried.sum(), above],
        places,
    })
}

/// Returns the largest difference from statics of the points that do not touch the ground, and the sag of the top in
/// statics, m.
fn against_statics(places: &[Vec3]) -> [f32; 2] {
    let stays: Vec<bool> = places.iter().map(|p| p.y < RADIUS + 0.01).collect();
    let exact: Vec<DVec3> = places.iter().map(|p| p.as_dvec3()).collect();
    let should = rest(exact.clone(), &stays);
    let errors = should.iter().zip(&exact).map(|(a, b)| a.distance(*b));
    let high = |places: &[DVec3]| places.iter().map(|p| p.y).fold(f64::MIN, larger);
    let side = f64::from(super::lattice::PITCH) * (super::lattice::SIDE - 1) as f64;
    let sag = side + f64::from(RADIUS) - high(&should);
    [errors.fold(0.0, larger) as f32, sag as f32]
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let seen = world.resource::<Seen>();
    let [Some(before), Some(after)] = &seen.rests else {
        return vec![Finding::small("times at rest", f32::NAN, 0.0, "")];
    };
    let [error, sag] = against_statics(&before.places);
    let [error_after, _] = against_statics(&after.places);
    let high = |rest: &Rest| rest.places.iter().map(|p| p.y).fold(f32::MIN, larger);
    vec![
        Finding::small("error of the free fall", seen.fall, 1e-4, "m"),
        Finding::small("energy from nothing in the fall", seen.most, 0.5, "J"),
        Finding::small("it rests at", before.fastest, 5e-3, "m/s"),
        Finding::between("  it has sagged by", sag, 0.01, 0.2, "m"),
        Finding::small("  points away from statics by", error, 1e-3, "m"),
        Finding::close(
            "  the lower half carries",
            before.carried[0],
            before.carried[1],
            "N",
            5e-3,
        ),
        Finding::between(
            "the ball presses the top in by",
            seen.deepest,
            0.005,
            0.3,
            "m",
        ),
        Finding::small("  energy from nothing", seen.most_with_ball, 0.5, "J"),
        Finding::close(
            "  then it stands as high",
            high(after),
            high(before),
            "m",
            5e-3,
        ),
        Finding::small("  it rests at", after.fastest, 5e-3, "m/s"),
        Finding::small("  points away from statics by", error_after, 1e-3, "m"),
    ]
}
