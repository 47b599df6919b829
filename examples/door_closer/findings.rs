//! Compares both doors with the damped oscillator, from the moment each of them turns back.

use super::doors::{CLOSER, Closer, HANDLE, SIZE, SWING};
use super::person::PUSHES;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use stage::{Finding, larger, smaller, tracks};
use std::f32::consts::PI;

/// Angle just before the door meets its frame, rad.
const NEAR: f32 = 0.01;

/// A time, s, with the read-out at that time: angle, rad, and rate, rad/s.
type Moment = (f32, SpringReadout);

/// Returns the track from the moment the door turns back after the push. Nothing touches the door from then on.
fn back(track: &[Moment], push: [f32; 2]) -> &[Moment] {
    let after = track.partition_point(|(t, _)| *t <= push[1]);
    let falls = track[after..].iter().position(|(_, r)| r.rate <= 0.0);
    &track[after + falls.unwrap_or(0)..]
}

/// Returns the angle of a free door as a function of the time since the first of these moments.
fn free(closer: &Closer, door: &[Moment]) -> impl Fn(f32) -> f32 {
    let (x, v) = match door {
        // The rate of a read-out is that of the step before it. The mean of two is the rate at this moment.
        [(_, first), (_, next), ..] => (first.length - closer.rest, 0.5 * (first.rate + next.rate)),
        _ => (f32::NAN, f32::NAN),
    };
    let (omega, rest) = (closer.omega(), closer.rest);
    let decay = closer.ratio * omega;
    let turn = (omega * omega - decay * decay).max(0.0).sqrt();
    move |t| {
        // sin(turn t)/turn, which tends to t at critical damping.
        let (cos, sin) = if turn > 1e-4 {
            ((turn * t).cos(), (turn * t).sin() / turn)
        } else {
            (1.0, t)
        };
        rest + (-decay * t).exp() * (x * cos + (v + decay * x) * sin)
    }
}

/// Returns the time at which the angle falls to zero, s.
fn shut(angle: impl Fn(f32) -> f32) -> f32 {
    let (mut open, mut shut) = (0.0, 30.0);
    for _ in 0..50 {
        let middle = 0.5 * (open + shut);
        if angle(middle) > 0.0 {
            open = middle;
        } else {
            shut = middle;
        }
    }
    shut
}

/// Returns the work of the hand, and the heat plus the change of stored energy until the end, J.
fn account(track: &[Moment], ([from, to], newtons): ([f32; 2], f32)) -> [f32; 2] {
    let at = |moment: f32| {
        let i = track.partition_point(|(t, _)| *t <= moment);
        track.get(i.max(1) - 1).map(|(_, r)| *r).unwrap_or_default()
    };
    let work = newtons * HANDLE * (at(to).length - at(from).length);
    let end = at(f32::INFINITY);
    [
        work,
        end.dissipated_energy + end.stored_energy - at(from).stored_energy,
    ]
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let all = tracks(world);
    let [closer, swing] = [&all[0].0[..], &all[1].0[..]];
    let mut findings = vec![];
    findings.extend(closes(closer));
    findings.extend(swings(swing));
    findings
}

fn closes(track: &[Moment]) -> Vec<Finding> {
    let door = back(track, PUSHES[0].0);
    let [work, spent] = account(track, PUSHES[0]);
    let Some((begun, start)) = door.first() else {
        return vec![Finding::small("doors that turned round", f32::NAN, 0.0, "")];
    };
    let theory = free(&CLOSER, door);
    let due = shut(|t| theory(t) - NEAR);
    let until = door.partition_point(|(_, r)| r.length > NEAR);
    let errors = door[..until]
        .iter()
        .map(|(t, r)| (r.length - theory(t - begun)).abs());
    // Interpolates between two ticks.
    let (before, after) = (&door[until.max(1) - 1], &door[until.min(door.len() - 1)]);
    let share = (before.1.length - NEAR) / (before.1.length - after.1.length);
    let took = before.0 + share * (after.0 - before.0) - begun;
    let rate = (theory(due) - theory(due - 1e-2)) / 1e-2;
    let met = door.partition_point(|(_, r)| r.length > 0.0);
    let pressed = door[met..].iter().map(|(_, r)| -r.length);
    let bounced = door[met..].iter().map(|(_, r)| r.length);
    let omega = CLOSER.omega();
    let slam = omega * (start.length - CLOSER.rest);
    vec![
        Finding::between("the door closer opens to", start.length, 1.2, 1.6, "rad"),
        Finding::close("  it shuts in", took, due, "s", 5e-3),
        Finding::small(
            "  largest error of its angle",
            errors.fold(0.0, larger),
            2e-3,
            "rad",
        ),
        Finding::close(
            "  its edge meets the frame at",
            -before.1.rate * SIZE.x,
            -rate * SIZE.x,
            "m/s",
            0.05,
        ),
        Finding::between(
            "  share of what it would be undamped",
            -before.1.rate / slam,
            0.0,
            0.1,
            "",
        ),
        Finding::small(
            "  it presses the frame in by",
            pressed.fold(0.0, larger),
            5e-3,
            "rad",
        ),
        Finding::small("  it comes back by", bounced.fold(0.0, larger), 1e-3, "rad"),
        Finding::close("  work of the hand", work, spent, "J", 0.01),
    ]
}

fn swings(track: &[Moment]) -> Vec<Finding> {
    let door = back(track, PUSHES[1].0);
    let [work, spent] = account(track, PUSHES[1]);
    let Some((begun, start)) = door.first() else {
        return vec![Finding::small("doors that turned round", f32::NAN, 0.0, "")];
    };
    let theory = free(&SWING, door);
    let errors = door
        .iter()
        .map(|(t, r)| (r.length - theory(t - begun)).abs());
    // Amplitude on the far side, relative to the start.
    let far = door.iter().map(|(_, r)| r.length);
    let over = -far.fold(f32::INFINITY, smaller) / start.length;
    let turn = (1.0 - SWING.ratio * SWING.ratio).sqrt();
    let crossings: Vec<f32> = door
        .windows(2)
        .filter(|w| (w[0].1.length > 0.0) != (w[1].1.length > 0.0))
        .map(|w| {
            let share = w[0].1.length / (w[0].1.length - w[1].1.length);
            w[0].0 + share * (w[1].0 - w[0].0)
        })
        .collect();
    let half = match crossings[..] {
        [first, second, ..] => second - first,
        _ => f32::NAN,
    };
    let last = door.last().map(|(_, r)| r.length).unwrap_or(f32::NAN);
    vec![
        Finding::between("the swing door opens to", start.length, 1.2, 1.6, "rad"),
        Finding::close(
            "  half a swing takes",
            half,
            PI / (turn * SWING.omega()),
            "s",
            5e-3,
        ),
        Finding::close(
            "  and leaves of it",
            over,
            (-PI * SWING.ratio / turn).exp(),
            "",
            5e-3,
        ),
        Finding::small(
            "  largest error of its angle",
            errors.fold(0.0, larger),
            5e-3,
            "rad",
        ),
        Finding::small("  in the end it is at", last, 0.1, "rad"),
        Finding::close("  work of the hand", work, spent, "J", 0.02),
    ]
}
