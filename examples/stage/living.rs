//! Does a scene still look as it should after many minutes? Watched without drawing anything.

use super::{Again, DT, Finding, Stage, again, headless_app};
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::collections::HashMap;

/// On a body that lies askew when it is turned further than this from the world's axes, rad.
#[derive(Component)]
pub struct Upright(pub f32);

/// Inserted by a `setup`: what must hold after every minute, however many there have been.
#[derive(Resource, Clone, Copy)]
pub struct Lasting(pub fn(&mut World) -> Vec<Finding>);

/// What drives through the picture may be outside it for so long, s.
const OUTSIDE: f32 = 3.0;
/// Height of the picture over its distance, halved, and its width over its height.
const HALF: f32 = 0.309_336;
const ASPECT: f32 = 16.0 / 9.0;

/// Runs the scene for so long; fails as soon as a body has left the picture or lies askew.
pub fn watch(stage: &Stage, minutes: f32) -> AppExit {
    let mut app = headless_app(stage);
    again::repeat(&mut app, stage.again);
    // For so little in each system, threads cost more than they gain.
    for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app.finish();
    app.cleanup();
    let mut outside = HashMap::new();
    let mut most = (0.0_f32, 0.0_f32);
    let minute = (60.0 / DT).round() as u32;
    for tick in 0..=(60.0 * minutes / DT).round() as u32 {
        app.update();
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

/// Whether all is still as it should be after so many minutes; says what is not.
fn lasts(world: &mut World, minutes: u32) -> bool {
    let Some(Lasting(check)) = world.get_resource().copied() else {
        return true;
    };
    let findings = check(world);
    for finding in &findings {
        if finding.good {
            println!("  minute {minutes}: {finding}");
        } else {
            eprintln!("  minute {minutes}: {finding}");
        }
    }
    findings.iter().all(|finding| finding.good)
}

/// Notes how long each body has been outside the picture, and keeps the most of that (s) and of all angles (rad).
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
