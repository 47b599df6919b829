//! Compares the winch's work, the arm's speed and the ball's flight with theory.

use super::arm::{Arm, INERTIA, LENGTH, MASS, PAD, REST, STIFFNESS, Skein, Winch};
use super::shot::{Ball, Brick, RADIUS, WALL, WEIGHT};
use super::{RELEASE, WIND};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{DT, Finding};

const GRAVITY: f32 = 9.81;
/// Distance of the ball's centre from the arm's axis, m.
const ABOVE: f32 = RADIUS + 0.02;

#[derive(Resource, Default)]
pub struct Seen {
    /// Work of the winch's rope, heat and stored energy of both ropes, and potential energy of the arm, J: before and
    /// after winding.
    wound: [Option<[f32; 4]>; 2],
    /// Angle of the arm at release, rad from upright.
    from: f32,
    /// Angle (rad) and rate (rad/s) of the arm in the last tick before the pad, and heat of the twisted ropes until
    /// then (J).
    strikes: Option<[f32; 3]>,
    /// Heat of the twisted ropes until the release, J.
    heat: f32,
    /// Time (s), position (m) and velocity (m/s) of the ball when the arm reached the pad.
    flies: Option<(f32, Vec3, Vec3)>,
    /// Time (s) and position (m) of the ball when it reached the wall.
    hits: Option<(f32, Vec3)>,
    /// Time (s) and position (m) of the ball in the last tick.
    last: Option<(f32, Vec3)>,
    /// Rate of the arm at the end, rad/s.
    end: f32,
    /// Number of boxes that have moved at the end.
    moved: usize,
}

/// Returns the angle of the arm from upright, rad, positive forward.
fn angle(at: &Transform) -> f32 {
    let along = at.rotation * Vec3::Y;
    along.x.atan2(along.y)
}

pub fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    arms: Query<(&Transform, &Velocity), With<Arm>>,
    balls: Query<(&Transform, &Velocity), With<Ball>>,
    bricks: Query<&Transform, With<Brick>>,
    skeins: Query<&SpringReadout, With<Skein>>,
    ropes: Query<&SpringReadout, With<Winch>>,
) {
    let (Ok((arm, turns)), Ok(skein)) = (arms.single(), skeins.single()) else {
        return;
    };
    let t = time.elapsed_secs();
    let is_at = |moment: f32| (t - moment).abs() < 0.5 * DT;
    for (i, moment) in [WIND[0], WIND[1] + 0.1].into_iter().enumerate() {
        if is_at(moment)
            && let Ok(rope) = ropes.single()
        {
            let middle = arm.transform_point(0.5 * LENGTH * Vec3::Y);
            seen.wound[i] = Some([
                rope.work,
                rope.dissipated_energy + skein.dissipated_energy,
                rope.stored_energy + skein.stored_energy,
                MASS * GRAVITY * middle.y,
            ]);
        }
    }
    if is_at(RELEASE) {
        (seen.from, seen.heat) = (angle(arm), skein.dissipated_energy);
    }
    if t > RELEASE && seen.flies.is_none() {
        let (angle, rate) = (angle(arm), -turns.angular.z);
        if angle < PAD {
            seen.strikes = Some([angle, rate, skein.dissipated_energy]);
        } else if let Ok((ball, moves)) = balls.single() {
            seen.flies = Some((t, ball.translation, moves.linear));
        }
    }
    if let (Some(_), None, Ok((ball, _))) = (&seen.flies, &seen.hits, balls.single()) {
        let near = WALL - 0.25 - RADIUS;
        if ball.translation.x >= near
            && let Some((before, was)) = seen.last
        {
            let share = (near - was.x) / (ball.translation.x - was.x);
            let at = was.lerp(ball.translation, share);
            seen.hits = Some((before + share * DT, at));
        }
        seen.last = Some((t, ball.translation));
    }
    seen.end = turns.angular.length();
    let moved = |at: &&Transform| (at.translation.x - WALL).abs() > 0.05;
    seen.moved = bricks.iter().filter(moved).count();
}

pub fn check(world: &mut World) -> Vec<Finding> {
    let seen = world.resource::<Seen>();
    let missing = || vec![Finding::small("shots", f32::NAN, 0.0, "")];
    let ([Some(before), Some(after)], Some(strikes)) = (seen.wound, seen.strikes) else {
        return missing();
    };
    let (Some((begun, place, velocity)), Some((met, hit))) = (seen.flies, seen.hits) else {
        return missing();
    };
    let [work, heat, stored, height] = [0, 1, 2, 3].map(|i| after[i] - before[i]);
    // Energy of the twisted ropes, less the energy that lifts arm and ball.
    let [angle, rate, heat_then] = strikes;
    let twist = |at: f32| 0.5 * STIFFNESS * (at - REST) * (at - REST);
    let lift = |at: f32| {
        GRAVITY * (MASS * 0.5 * LENGTH * at.cos() + WEIGHT * (LENGTH * at.cos() - ABOVE * at.sin()))
    };
    let given = twist(seen.from) - twist(angle) - (lift(angle) - lift(seen.from));
    let given = given - (heat_then - seen.heat);
    let of_ball = WEIGHT * (LENGTH * LENGTH + ABOVE * ABOVE + 0.4 * RADIUS * RADIUS);
    let theory = (2.0 * given / (INERTIA + of_ball)).sqrt();
    let flight = met - begun;
    let falls = place + velocity * flight + 0.5 * flight * flight * GRAVITY * Vec3::NEG_Y;
    vec![
        Finding::close("work of the winch", work, heat + stored + height, "J", 1e-2),
        Finding::between("  the arm is down at", seen.from, -1.6, -1.3, "rad"),
        Finding::close("speed of the arm at the pad", rate, theory, "rad/s", 0.02),
        Finding::close(
            "speed of the ball",
            velocity.length(),
            rate * LENGTH.hypot(ABOVE),
            "m/s",
            0.05,
        ),
        Finding::close(
            "  it flies to the wall in",
            flight,
            (hit.x - place.x) / velocity.x,
            "s",
            5e-3,
        ),
        Finding::close(
            "  and comes there at a height of",
            hit.y,
            falls.y,
            "m",
            0.02,
        ),
        Finding::between("boxes that it moved", seen.moved as f32, 1.0, 9.0, ""),
        Finding::small("the arm in the end", seen.end, 1e-2, "rad/s"),
    ]
}
