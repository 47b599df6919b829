//! Checks over many minutes, without drawing, that a scene still looks as it should.

use super::toll::Toll;
use super::{Again, DT, Finding, Stage, again, headless_app};
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy::transform::StaticTransformOptimizations;
use bevy_rapier3d::prelude::*;
use std::collections::HashMap;

/// On a body that must stay upright: largest rotation from the world's axes, rad.
#[derive(Component)]
pub struct Upright(pub f32);

/// Inserted by a `setup`: a check that must hold after every minute, however many have passed.
#[derive(Resource, Clone, Copy)]
pub struct Lasting(pub fn(&mut World) -> Vec<Finding>);

/// Longest time that a body may be outside the picture, s: bodies drive through it.
const OUTSIDE: f32 = 3.0;
/// A scene that restarts no more often than once an hour does not restart, s.
const HOUR: f32 = 3600.0;
/// Half the height of the picture over its distance.
const HALF: f32 = 0.309_336;
/// Width of the picture over its height.
const ASPECT: f32 = 16.0 / 9.0;

/// Runs the scene for this time, and restarts it as a window does; at least until its check after the first restart. Fails as soon as a body has left the picture or is no longer
/// upright, where the scene's check does not hold at its time after any restart, and if a long run takes more and more memory.
pub fn watch(stage: &Stage, minutes: f32) -> AppExit {
    let mut app = headless_app(stage);
    // As in the tests of physics: looking for what rests takes threads too.
    app.insert_resource(StaticTransformOptimizations::Disabled);
    again::repeat(&mut app, stage.again);
    // Each system does so little that threads cost more than they gain.
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app.finish();
    app.cleanup();
    let mut outside = HashMap::new();
    let mut most = (0.0_f32, 0.0_f32);
    let minute = (60.0 / DT).round() as u32;
    let due = (stage.seconds / DT).round() as u32;
    let first = if stage.again < HOUR { stage.again } else { 0.0 };
    let minutes = minutes.max((first + stage.seconds + 1.0) / 60.0);
    let mut checks = 0;
    let ticks = (60.0 * minutes / DT).round() as u32;
    let mut toll = Toll::of(ticks);
    for tick in 0..=ticks {
        app.update();
        let scene = app.world().resource::<Time<Fixed>>().as_generic();
        if again::tick(&scene) == due {
            let findings = (stage.check)(app.world_mut());
            let times = app.world().resource::<Again>().times;
            if !are_good(&findings, &format!("after {times} restarts")) {
                return AppExit::error();
            }
            checks += 1;
        }
        if !toll.tell(tick) {
            eprintln!("{}: memory grows", stage.title);
            return AppExit::error();
        }
        if tick > 0 && tick.is_multiple_of(minute) && !lasts(app.world_mut(), tick / minute) {
            return AppExit::error();
        }
        if let Err(wrong) = look(stage, app.world_mut(), &mut outside, &mut most) {
            let times = app.world().resource::<Again>().times;
            let seconds = tick as f32 * DT;
            eprintln!(
                "{}: after {seconds:.1} s and {times} restarts, {wrong}",
                stage.title
            );
            return AppExit::error();
        }
    }
    if checks <= usize::from(first > 0.0) {
        eprintln!("{}: its check ran {checks} times only", stage.title);
        return AppExit::error();
    }
    println!(
        "{}: {minutes} minutes, {} restarts; nothing was outside the picture for more than {:.1} s, or turned by more \
         than {:.2} degrees where it should be upright",
        stage.title,
        app.world().resource::<Again>().times,
        most.0,
        most.1.to_degrees()
    );
    AppExit::Success
}

/// Returns whether the check holds after this number of minutes, and prints what does not.
fn lasts(world: &mut World, minutes: u32) -> bool {
    let Some(Lasting(check)) = world.get_resource().copied() else {
        return true;
    };
    let findings = check(world);
    let when = format!("minute {minutes}");
    for finding in findings.iter().filter(|finding| finding.good) {
        println!("  {when}: {finding}");
    }
    are_good(&findings, &when)
}

/// Returns whether all findings are good, and prints those that are not.
fn are_good(findings: &[Finding], when: &str) -> bool {
    let mut wrong = findings.iter().filter(|finding| !finding.good).peekable();
    let good = wrong.peek().is_none();
    wrong.for_each(|finding| eprintln!("  {when}: {finding}"));
    good
}

/// Records how long each body has been outside the picture. Keeps the largest of these times (s) and of all angles
/// (rad).
fn look(
    stage: &Stage,
    world: &mut World,
    outside: &mut HashMap<Entity, f32>,
    most: &mut (f32, f32),
) -> Result<(), String> {
    let mut bodies = world.query::<(Entity, &RigidBody, &Transform, Option<&Upright>)>();
    let mut seen = 0;
    let before = std::mem::take(outside);
    for (entity, body, at, upright) in bodies.iter(world) {
        if *body == RigidBody::Fixed {
            continue;
        }
        seen += 1;
        if !at.is_finite() {
            return Err(format!("{entity} is nowhere"));
        }
        if !is_in_picture(stage, at.translation) {
            let since = before.get(&entity).copied().unwrap_or(0.0) + DT;
            outside.insert(entity, since);
            most.0 = most.0.max(since);
            if since > OUTSIDE {
                return Err(format!("{entity} has left the picture: {}", at.translation));
            }
        }
        if let Some(Upright(limit)) = upright {
            let angle = at.rotation.angle_between(Quat::IDENTITY);
            most.1 = most.1.max(angle);
            if angle > *limit {
                let degrees = angle.to_degrees();
                return Err(format!("{entity} lies askew by {degrees:.1} degrees"));
            }
        }
    }
    if seen == 0 {
        return Err("there are no bodies".into());
    }
    Ok(())
}

fn is_in_picture(stage: &Stage, point: Vec3) -> bool {
    let view = Transform::from_translation(stage.eye).looking_at(stage.target, Vec3::Y);
    let seen = view.rotation.inverse() * (point - stage.eye);
    let reach = -HALF * seen.z;
    seen.y.abs() <= reach && seen.x.abs() <= ASPECT * reach
}
