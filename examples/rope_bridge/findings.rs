//! Compares the measurements while the walker stands with statics.

use super::bridge::*;
use super::walker::{FOOT, HALF, MASS, QUARTER, ROUND, Walker};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{DT, Finding, larger};

/// Time span of the means while the walker stands in the middle, s.
const MIDDLE: [f32; 2] = [20.0, 22.0];
/// Time span of the means while the walker stands at a quarter of the bridge, s.
const ASIDE: [f32; 2] = [36.0, 38.0];
/// Time span of the means after the walker has left the bridge, s.
const GONE: [f32; 2] = [57.0, 59.0];

/// Means over one of these time spans.
#[derive(Clone, Copy, Default, Debug)]
struct Stand {
    /// Downward force on the first and on the second bank in walking direction, N.
    banks: [f32; 2],
    /// Horizontal tension of all ropes in the middle, N.
    pull: f32,
    /// Sum over these ropes of horizontal tension times depth below the rope's ends, N m.
    moment: f32,
    /// Sag of the planks' ropes in the middle, m.
    sag: f32,
    /// Greatest speed of a plank, m/s.
    speed: f32,
}

/// The latest means for each time span.
#[derive(Resource, Default)]
pub struct Seen {
    middle: Stand,
    aside: Stand,
    gone: Stand,
    now: Stand,
    /// Least and greatest height of the walker's feet above the plank's upper side, m.
    feet: Option<[f32; 2]>,
    faults: usize,
}

pub fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    ropes: Query<(
        &SpringDamper,
        &Anchors,
        &SpringReadout,
        Option<&AtBank>,
        Has<InTheMiddle>,
    )>,
    places: Query<&Transform>,
    planks: Query<(&Transform, &Velocity), With<Plank>>,
    walkers: Query<&Transform, With<Walker>>,
    faults: Query<&SpringFault>,
) {
    seen.faults += faults.iter().count();
    for walker in &walkers {
        let from = |at: &Transform| (at.translation.x - walker.translation.x).abs();
        let below = planks.iter().min_by(|a, b| from(a.0).total_cmp(&from(b.0)));
        if let Some((plank, _)) = below.filter(|(plank, _)| from(plank) < 0.5 * SIZE.x) {
            // Height above the plank's upper side, along the plank's own up axis.
            let foot = walker.translation - HALF * Vec3::Y;
            let gap = plank.rotation.inverse() * (foot - plank.translation);
            let gap = gap.y - 0.5 * SIZE.y;
            let [least, most] = seen.feet.unwrap_or([gap; 2]);
            seen.feet = Some([least.min(gap), most.max(gap)]);
        }
    }
    let t = time.elapsed_secs() % ROUND;
    let there = ((time.elapsed_secs() / ROUND) as u32).is_multiple_of(2);
    for (which, [from, to]) in [MIDDLE, ASIDE, GONE].into_iter().enumerate() {
        let ticks = ((to - from) / DT).round();
        if t < from + 0.5 * DT || t > to + 0.5 * DT {
            continue;
        }
        let mut now = seen.now;
        for (spring, anchors, readout, bank, middle) in &ropes {
            let at = |entity, anchor| places.get(entity).map(|at| at.transform_point(anchor));
            let (Ok(a), Ok(b)) = (at(spring.body_a, anchors.a), at(spring.body_b, anchors.b))
            else {
                continue;
            };
            let force = readout.force() * (b - a).normalize() / ticks;
            if let Some(AtBank(side)) = bank {
                // On the way back, left and right are swapped.
                let first = (*side < 0.0) == there;
                now.banks[usize::from(!first)] += side * force.y;
            }
            if middle {
                let top = if a.y > 0.3 * RAIL - SAG { RAIL } else { 0.0 };
                let below = top - 0.5 * (a.y + b.y);
                now.pull += force.x;
                now.moment += force.x * below;
                if top == 0.0 {
                    now.sag += 0.5 * below / ticks;
                }
            }
        }
        let speeds = planks.iter().map(|(_, v)| v.linear.length());
        now.speed = speeds.fold(now.speed, larger);
        seen.now = now;
        // The last tick of the time span.
        if t > to - 0.5 * DT {
            let now = std::mem::take(&mut seen.now);
            *match which {
                0 => &mut seen.middle,
                1 => &mut seen.aside,
                _ => &mut seen.gone,
            } = now;
        }
    }
}

/// Returns the weight of everything between the banks, N. The planks' ropes have no mass.
fn weight() -> f32 {
    (PLANK + 2.0 * ROPE) * GRAVITY * PLANKS as f32
}

/// Returns the moment in the middle of a beam with that weight and a walker in its middle, N m.
fn moment(walker: f32) -> f32 {
    let planks = (0..PLANKS / 2).map(|i| (i as f32 + 0.5) * PITCH);
    let hanging: f32 = planks.map(|x| (PLANK + 2.0 * ROPE) * GRAVITY * x).sum();
    0.5 * (weight() + walker) * EDGE - hanging - 0.5 * walker * FOOT
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let walkers = world.query::<&Walker>().iter(world).count();
    let seen = world.resource::<Seen>();
    let walker = MASS * GRAVITY;
    let carried = |stand: &Stand| stand.banks[0] + stand.banks[1];
    let Stand { sag, speed, .. } = seen.gone;
    let [least, most] = seen.feet.unwrap_or([f32::NAN; 2]);
    let sag_of = |what, stand: &Stand, walker| {
        // On average all ropes have the same sag.
        let measured = stand.moment / stand.pull;
        Finding::close(what, measured, moment(walker) / stand.pull, "m", 0.01)
    };
    let far = 0.5 * (1.0 - QUARTER / EDGE) * walker + 0.5 * weight();
    vec![
        Finding::close(
            "banks carry the bridge",
            carried(&seen.gone),
            weight(),
            "N",
            2e-3,
        ),
        Finding::close(
            "and with a walker",
            carried(&seen.middle),
            weight() + walker,
            "N",
            5e-3,
        ),
        Finding::close(
            "far bank, walker at a quarter",
            seen.aside.banks[0],
            far,
            "N",
            0.01,
        ),
        sag_of("sag without walker, by its moment", &seen.gone, 0.0),
        sag_of("sag under the walker, by its moment", &seen.middle, walker),
        Finding::close("sag without walker, as hung", sag, SAG, "m", 0.02),
        Finding::between(
            "sag under the walker",
            seen.middle.sag,
            SAG + 0.05,
            SAG + 0.4,
            "m",
        ),
        Finding::small("speed of the empty bridge", speed, 5e-3, "m/s"),
        Finding::between("least of the feet over a plank", least, -0.03, 0.05, "m"),
        Finding::between("most of the feet over a plank", most, 0.0, 0.12, "m"),
        Finding::small("faults", seen.faults as f32, 0.5, ""),
        Finding::between("walkers", walkers as f32, 1.0, 1.0, ""),
    ]
}
