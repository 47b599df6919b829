//! Compares forces with weights, the work of the winch with the potential energy, and the swing with theory.

use super::load::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{DT, Finding, larger};
use std::f32::consts::TAU;

/// Time span in which forces are averaged while the crate stands at first, s.
const STANDS: [f32; 2] = [1.5, 2.5];
/// Time span in which forces are averaged while the crate hangs, s.
const HANGS: [f32; 2] = [9.5, 10.8];
/// Time span in which forces are averaged while the crate stands again, s.
const DOWN: [f32; 2] = [38.5, 39.5];
/// Time span in which the swing is recorded, s.
const SWINGS: [f32; 2] = [CARRY[1] + 0.1, SET[0]];

/// Energies, J.
#[derive(Clone, Copy, Default)]
struct Account {
    work: f32,
    heat: f32,
    stored: f32,
    height: f32,
}

/// Measurements of one way of the crate.
#[derive(Clone, Default)]
struct Way {
    /// Mean vertical force of all cables in `STANDS`, `HANGS` and `DOWN`, N.
    stands: f32,
    hangs: f32,
    down: f32,
    /// Greatest force in a sling while the crate stands, N.
    slack: f32,
    /// Energies before and after the lift.
    lifted: [Account; 2],
    /// Length of the cables during the swing, m.
    length: f32,
    /// Time (s) and position relative to the trolley (m) of the crate during the swing.
    swing: Vec<[f32; 2]>,
    /// Speed of the crate at the end, m/s.
    speed: f32,
    /// Energy taken by the linear drag of the air, J.
    air: f32,
}

/// The last finished way, and the current one.
#[derive(Resource, Default)]
pub struct Seen {
    whole: Way,
    now: Way,
    pushed: f32,
    faults: usize,
}

pub fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    cables: Query<(&SpringDamper, &SpringReadout), With<Cable>>,
    slings: Query<&SpringReadout, With<Sling>>,
    places: Query<&Transform>,
    crates: Query<(&Transform, &Velocity), With<Crate>>,
    hooks: Query<(&Transform, &Velocity), With<Hook>>,
    faults: Query<&SpringFault>,
) {
    let (Ok((load, rate)), Ok((hook, hook_rate))) = (crates.single(), hooks.single()) else {
        return;
    };
    seen.faults += faults.iter().count();
    let all = cables.iter().map(|(_, readout)| readout).chain(&slings);
    let pushed = all.clone().map(|readout| -readout.force());
    seen.pushed = pushed.fold(seen.pushed, larger);
    let t = time.elapsed_secs() % ROUND;
    let there = ((time.elapsed_secs() / ROUND) as u32).is_multiple_of(2);
    let is_at = |moment: f32| (t - moment).abs() < 0.5 * DT;
    let is_in = |[from, to]: [f32; 2]| t > from + 0.5 * DT && t < to + 0.5 * DT;
    let mut lift = 0.0;
    for (cable, readout) in &cables {
        if let Ok([top, end]) = places.get_many([cable.body_a, cable.body_b]) {
            let along = (top.translation - end.translation).normalize_or_zero();
            lift += readout.force() * along.y;
        }
    }
    let share = |[from, to]: [f32; 2]| DT / (to - from);
    let now = &mut seen.now;
    let squares = HOOK * hook_rate.linear.length_squared() + CRATE * rate.linear.length_squared();
    now.air += AIR * DT * squares;
    if is_in(STANDS) {
        now.stands += share(STANDS) * lift;
        now.slack = slings.iter().map(|r| r.force()).fold(now.slack, larger);
    }
    if is_in(HANGS) {
        now.hangs += share(HANGS) * lift;
    }
    if is_in(DOWN) {
        now.down += share(DOWN) * lift;
        now.slack = slings.iter().map(|r| r.force()).fold(now.slack, larger);
        now.speed = now.speed.max(rate.linear.length());
    }
    for (i, moment) in [STANDS[1], HANGS[1]].into_iter().enumerate() {
        if is_at(moment) {
            let height = HOOK * hook.translation.y + CRATE * load.translation.y;
            now.lifted[i] = Account {
                work: all.clone().map(|r| r.work).sum(),
                heat: now.air + all.clone().map(|r| r.dissipated_energy).sum::<f32>(),
                stored: all.clone().map(|r| r.stored_energy).sum(),
                height: GRAVITY * height,
            };
        }
    }
    if is_in(SWINGS) {
        now.length = cables.iter().map(|(_, r)| r.length).sum::<f32>() / 2.0;
        let side = if there { 1.0 } else { -1.0 };
        now.swing
            .push([t, side * (load.translation.x - place(time.elapsed_secs()))]);
    }
    if is_at(DOWN[1]) {
        seen.whole = std::mem::take(&mut seen.now);
    }
}

/// Returns the period of the slow mode of a hook on a cable of this length (m) with a crate below it, s.
fn period(length: f32) -> f32 {
    let below = SLING + 0.5 * SIZE.y;
    let inertia = CRATE * (SIZE.x * SIZE.x + SIZE.y * SIZE.y) / 12.0;
    // Mass and stiffness matrix. The coordinates are the hook's displacement, and the crate's angle times its
    // distance from the hook.
    let mass = [HOOK + CRATE, CRATE, CRATE + inertia / (below * below)];
    let weight = [(HOOK + CRATE) * GRAVITY / length, CRATE * GRAVITY / below];
    // det(weights − ω² masses) = 0
    let a = mass[0] * mass[2] - mass[1] * mass[1];
    let b = mass[0] * weight[1] + mass[2] * weight[0];
    let c = weight[0] * weight[1];
    let slow = 2.0 * c / (b + (b * b - 4.0 * a * c).sqrt());
    // Drag lowers the frequency a little.
    TAU / (slow - 0.25 * AIR * AIR).sqrt()
}

/// Returns the times at which the crate passes the trolley on its way forward, s.
fn passes(swing: &[[f32; 2]]) -> Vec<f32> {
    let pairs = swing.windows(2).filter(|w| w[0][1] < 0.0 && w[1][1] >= 0.0);
    pairs
        .map(|w| w[0][0] + (w[1][0] - w[0][0]) * w[0][1] / (w[0][1] - w[1][1]))
        .collect()
}

/// Returns the amplitude of each swing forward, m.
fn tops(swing: &[[f32; 2]]) -> Vec<f32> {
    let tops = swing
        .windows(3)
        .filter(|w| w[1][1] > 0.0 && w[1][1] > w[0][1] && w[1][1] >= w[2][1]);
    tops.map(|w| w[1][1]).collect()
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let seen = world.resource::<Seen>();
    let way = &seen.whole;
    let (mean, fades, first) = (
        match passes(&way.swing)[..] {
            [first, .., last] => (last - first) / (passes(&way.swing).len() - 1) as f32,
            _ => f32::NAN,
        },
        match tops(&way.swing)[..] {
            [first, .., last] => (last / first).powf(1.0 / (tops(&way.swing).len() - 1) as f32),
            _ => f32::NAN,
        },
        tops(&way.swing).first().copied().unwrap_or(f32::NAN),
    );
    let slow = period(way.length);
    let [before, after] = way.lifted;
    let spent = after.heat - before.heat + after.stored - before.stored;
    let weight = |mass: f32| mass * GRAVITY;
    vec![
        Finding::close(
            "cables, crate on the ground",
            way.stands,
            weight(HOOK),
            "N",
            2e-3,
        ),
        Finding::small("  a slack sling has", way.slack, 1e-3, "N"),
        Finding::close(
            "cables, crate in the air",
            way.hangs,
            weight(HOOK + CRATE),
            "N",
            2e-3,
        ),
        Finding::close(
            "work of the winch",
            after.work - before.work,
            after.height - before.height + spent,
            "J",
            5e-3,
        ),
        Finding::between("first swing forward", first, 0.1, 1.0, "m"),
        Finding::close("period of the swing", mean, slow, "s", 5e-3),
        Finding::close(
            "what a period leaves of it",
            fades,
            (-0.5 * AIR * slow).exp(),
            "",
            0.02,
        ),
        Finding::close("cables, crate set down", way.down, weight(HOOK), "N", 2e-3),
        Finding::small("  it moves at", way.speed, 5e-3, "m/s"),
        Finding::small("a cable or sling pushes with", seen.pushed, 1e-3, "N"),
        Finding::small("faults", seen.faults as f32, 0.5, ""),
    ]
}
