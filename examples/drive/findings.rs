//! Compares the measurements with statics and vibration theory.

use super::car::*;
use super::course;
use super::driver::{CIRCLE, CORNER_SPEED, FAST, Leg, SLOW};
use super::log::{Log, Sample};
use super::tyre::load_at_rest;
use bevy::prelude::*;
use stage::{DT, Finding, larger};
use std::f32::consts::TAU;

/// Returns the mean, or NaN without values.
fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v, count + 1.0));
    sum / count
}

/// Returns the standard deviation.
fn spread(values: impl Iterator<Item = f32>) -> f32 {
    let values: Vec<f32> = values.collect();
    let middle = mean(values.iter().copied());
    mean(values.iter().map(|v| (v - middle).powi(2))).sqrt()
}

fn most(values: impl Iterator<Item = f32>) -> f32 {
    values.fold(f32::NEG_INFINITY, larger)
}

/// Sum of mass times height above the road over chassis and wheels, kg m.
const MOMENT: f32 = CHASSIS * HEIGHT + 4.0 * WHEEL * RADIUS;

pub fn check(world: &mut World) -> Vec<Finding> {
    let log = world.resource::<Log>();
    if log.by_hand {
        return vec![];
    }
    let mut out = vec![];
    out.extend(standing(log));
    out.extend(washboard(log));
    out.extend(fast(log));
    out.extend(braking(log));
    out.extend(corner(log));
    out.extend(jump(log));
    out.extend(slope(log));
    out
}

fn standing(log: &Log) -> Option<Finding> {
    let last = log.of(Leg::Stand).last()?;
    Some(Finding::close("ride height", last.at.y, HEIGHT, "m", 2e-3))
}

/// Variation of the wheel load on the slow washboard. The chassis bounces too slowly to follow the washboard and
/// stays level, so each hub moves as the road does. Spring, damper and wheel mass then give the force.
fn washboard(log: &Log) -> Vec<Finding> {
    let on = |s: &&Sample| (course::SLOW_WASH + 14.0..course::SLOW_WASH + 37.0).contains(&s.at.x);
    let samples: Vec<_> = log.of(Leg::SlowWash).filter(on).collect();
    let loads = (0..4).flat_map(|i| samples.iter().map(move |s| s.loads[i]));
    let theory = (0..4).flat_map(|i| {
        let height = |s: &Sample| course::washboard(s.hubs[i].x - course::SLOW_WASH);
        let load = move |w: &[&Sample]| {
            let [a, b, c] = [height(w[0]), height(w[1]), height(w[2])];
            let rate = (c - b) / DT;
            let damping = if rate > 0.0 { BUMP } else { REBOUND };
            let rises = (a - 2.0 * b + c) / DT.powi(2);
            STIFFNESS * c + damping * rate + WHEEL * rises
        };
        samples.windows(3).map(load).collect::<Vec<_>>()
    });
    let speed = mean(samples.iter().map(|s| s.velocity.x));
    let rest = load_at_rest(CHASSIS, GRAVITY);
    vec![
        Finding::close("speed on the washboard", speed, SLOW, "m/s", 0.1),
        Finding::close(
            "  mean load of a wheel",
            mean(loads.clone()),
            rest,
            "N",
            0.05,
        ),
        Finding::close(
            "  variation of the load",
            spread(loads),
            spread(theory),
            "N",
            0.25,
        ),
    ]
}

fn fast(log: &Log) -> Vec<Finding> {
    let on = |s: &&Sample| (course::FAST_WASH..course::FAST_WASH + 60.0).contains(&s.at.x);
    let samples: Vec<_> = log.of(Leg::FastWash).filter(on).collect();
    let speed = mean(samples.iter().map(|s| s.velocity.x));
    let lean = most(samples.iter().map(|s| s.lean.to_degrees()));
    let off = most(samples.iter().map(|s| s.at.z.abs()));
    vec![
        Finding::close("speed on the fast washboard", speed, FAST, "m/s", 0.05),
        Finding::between("  most lean", lean, 0.0, 3.0, "degrees"),
        Finding::between("  beside the middle of the road", off, 0.0, 0.5, "m"),
    ]
}

/// Under braking, load moves from the rear to the front wheels: mass times deceleration times height over the
/// wheelbase. Both ends of the car deflect by it.
fn braking(log: &Log) -> Vec<Finding> {
    let steady: Vec<_> = log.of(Leg::Brake).filter(|s| s.time > 1.2).collect();
    let (Some(first), Some(last)) = (steady.first(), steady.last()) else {
        return vec![Finding::small("no braking", 1.0, 0.5, "")];
    };
    let braked = (first.velocity.x - last.velocity.x) / (last.time - first.time);
    let dive = -mean(steady.iter().map(|s| s.pitch));
    let stiff = 4.0 * STIFFNESS * HALF_BASE.powi(2);
    // Pitching also moves the weight of the chassis forward relative to the hubs.
    let theory = MOMENT * braked / (stiff - CHASSIS * GRAVITY * (HEIGHT - RADIUS));
    vec![
        Finding::between("deceleration", braked, 3.0, 9.0, "m/s²"),
        Finding::close(
            "  dive",
            dive.to_degrees(),
            theory.to_degrees(),
            "degrees",
            0.05,
        ),
    ]
}

/// Compares the roll in the corner with statics: roll stiffness of coilovers and bars against the moment of the
/// centrifugal force.
fn corner(log: &Log) -> Vec<Finding> {
    let length = most(log.of(Leg::Corner).map(|s| s.time));
    let steady: Vec<_> = log
        .of(Leg::Corner)
        .filter(|s| s.time > 0.4 * length)
        .collect();
    let (Some(first), Some(last)) = (steady.first(), steady.last()) else {
        return vec![Finding::small("no corner", 1.0, 0.5, "")];
    };
    let heading = |s: &Sample| (-s.velocity.z).atan2(s.velocity.x);
    let turned = (heading(last) - heading(first)).rem_euclid(TAU);
    let speed = mean(steady.iter().map(|s| s.velocity.xz().length()));
    let across = speed * turned / (last.time - first.time);
    let roll = mean(steady.iter().map(|s| s.roll));
    let coilovers = 4.0 * STIFFNESS * HALF_TRACK.powi(2);
    let bars = (BARS[0] + BARS[1]) * (2.0 * HALF_TRACK / ARM).powi(2);
    let theory = MOMENT * across / (coilovers + bars - CHASSIS * GRAVITY * (HEIGHT - RADIUS));
    vec![
        Finding::close(
            "across in the corner",
            across,
            CORNER_SPEED.powi(2) / CIRCLE,
            "m/s²",
            0.15,
        ),
        Finding::close(
            "  roll",
            roll.to_degrees(),
            theory.to_degrees(),
            "degrees",
            0.05,
        ),
    ]
}

fn jump(log: &Log) -> Vec<Finding> {
    let samples: Vec<_> = log.of(Leg::Jump).chain(log.of(Leg::Climb)).collect();
    let flies = |s: &&&Sample| s.at.x > course::JUMP + 10.0 && s.loads == [0.0; 4];
    let height = most(samples.iter().filter(flies).map(|s| s.at.y - HEIGHT));
    let after: Vec<_> = samples
        .iter()
        .filter(|s| s.at.x > course::JUMP + 16.0)
        .collect();
    let shortest = -most(after.iter().flat_map(|s| s.lengths).map(|l| -l));
    let longest = most(after.iter().flat_map(|s| s.lengths));
    let load = most(after.iter().flat_map(|s| s.loads)) / load_at_rest(CHASSIS, GRAVITY);
    let lean = most(
        after
            .iter()
            .filter(|s| s.at.x < course::SLOPE - 5.0)
            .map(|s| s.lean),
    );
    let settled = samples
        .iter()
        .rfind(|s| s.at.x < course::SLOPE - 6.0)
        .map_or(f32::NAN, |s| (s.at.y - HEIGHT).abs());
    vec![
        Finding::between("height of the jump", height, 1.8, 2.6, "m"),
        Finding::between("  shortest coilover", shortest, 0.2, 0.4, "m"),
        Finding::between("  longest coilover", longest, 0.5, 0.68, "m"),
        Finding::between("  greatest load over that at rest", load, 2.0, 25.0, ""),
        // The front wheels leave the ramp first, so the nose drops.
        Finding::between("  most lean", lean.to_degrees(), 0.0, 30.0, "degrees"),
        Finding::small("  off its ride height afterwards", settled, 1e-2, "m"),
    ]
}

fn slope(log: &Log) -> Vec<Finding> {
    let last = log.of(Leg::Slope).last();
    let early = log.of(Leg::Slope).find(|s| s.time > 4.0);
    let (Some(early), Some(last)) = (early, last) else {
        return vec![Finding::small("no slope", 1.0, 0.5, "")];
    };
    let crept = early.at.distance(last.at) / (last.time - early.time);
    vec![
        Finding::close("slope", last.pitch.tan(), course::STEEP, "", 0.1),
        Finding::small("  creeps by", crept, 1e-4, "m/s"),
    ]
}
