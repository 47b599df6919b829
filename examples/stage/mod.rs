//! What the examples share: a window where there is a display, frames where there is only an adapter,
//! and read-outs everywhere.
#![allow(dead_code)]

mod film;
mod look;
mod means;

pub use look::{Paint, Shape};

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use means::Means;
use std::path::PathBuf;

/// Seconds of a tick.
pub const DT: f32 = 1.0 / 60.0;

/// An example: what to set up, how long to look, what to say in the end.
pub struct Stage {
    pub title: &'static str,
    /// Adds systems and resources; spawn in `Startup`.
    pub setup: fn(&mut App),
    /// Seconds after which the report is due.
    pub seconds: f32,
    /// Measured against theory, a line each.
    pub report: fn(&mut World) -> Vec<String>,
    /// From where it is seen.
    pub eye: Vec3,
    pub target: Vec3,
}

/// What the command line asks for.
#[derive(Default)]
struct Arguments {
    headless: bool,
    screenshot: Option<PathBuf>,
    frames: Option<PathBuf>,
}

impl Arguments {
    fn read() -> Result<Self, String> {
        let mut out = Self::default();
        let mut words = std::env::args().skip(1);
        while let Some(word) = words.next() {
            let mut path = || {
                words
                    .next()
                    .map(PathBuf::from)
                    .ok_or(format!("{word} needs a path"))
            };
            match word.as_str() {
                "--headless" => out.headless = true,
                "--screenshot" => out.screenshot = Some(path()?),
                "--frames" => out.frames = Some(path()?),
                _ => return Err(format!("unknown argument {word}")),
            }
        }
        Ok(out)
    }
}

/// Runs an example as the machine and the command line allow.
pub fn run(stage: &Stage) -> AppExit {
    let arguments = match Arguments::read() {
        Ok(arguments) => arguments,
        Err(wrong) => {
            eprintln!("{wrong}; use --headless, --screenshot FILE or --frames FOLDER");
            return AppExit::error();
        }
    };
    let means = Means::find(arguments.headless, arguments.screenshot, arguments.frames);
    println!("{}: {means}", stage.title);
    match means {
        Means::Window => window(stage),
        Means::Film { film, .. } => film::shoot(stage, film),
        Means::Headless(_) => headless(stage),
    }
}

/// Physics alone, as fast as it runs.
fn headless(stage: &Stage) -> AppExit {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, CoiloverPlugin::default()));
    physics(&mut app, stage, 1);
    app.finish();
    app.cleanup();
    for _ in 0..=(stage.seconds / DT).round() as u32 {
        app.update();
    }
    say(stage, app.world_mut());
    AppExit::Success
}

fn window(stage: &Stage) -> AppExit {
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins.set(WindowPlugin {
            primary_window: Some(Window {
                title: stage.title.into(),
                ..default()
            }),
            ..default()
        }),
        CoiloverPlugins,
    ));
    physics(&mut app, stage, 0);
    look::dress(&mut app, stage.eye, stage.target, None);
    let (report, seconds, title) = (stage.report, stage.seconds, stage.title);
    let mut told = false;
    app.add_systems(Last, move |world: &mut World| {
        if !told && world.resource::<Time<Fixed>>().elapsed_secs() >= seconds {
            told = true;
            println!("{title}, after {seconds} s:");
            report(world).iter().for_each(|line| println!("  {line}"));
        }
    });
    app.run()
}

/// An app without window whose frames can be taken.
fn offscreen() -> App {
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .disable::<WinitPlugin>(),
        ScheduleRunnerPlugin::default(),
        CoiloverPlugins,
    ));
    app
}

/// Rapier at a fixed step, so many ticks in each update; 0 follows the clock.
fn physics(app: &mut App, stage: &Stage, ticks: u32) {
    app.insert_resource(Time::<Fixed>::from_seconds(f64::from(DT)))
        .insert_resource(TimestepMode::Fixed {
            dt: DT,
            substeps: 1,
        })
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule());
    if ticks > 0 {
        let tick = app.world().resource::<Time<Fixed>>().timestep();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(tick * ticks));
    }
    (stage.setup)(app);
}

fn say(stage: &Stage, world: &mut World) {
    println!("{}, after {} s:", stage.title, stage.seconds);
    (stage.report)(world)
        .iter()
        .for_each(|line| println!("  {line}"));
}
