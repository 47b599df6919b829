//! Shared by the examples: a window where there is a display, frames where there is only a graphics adapter, and
//! read-outs everywhere.
//!
//! A scene is a [`Stage`] with a `setup` and a `check`. `setup` adds systems. They spawn in [`Begin`], which runs
//! again at every restart. Give bodies a [`Shape`], and elements to be measured a [`Track`]. `check` returns
//! [`Finding`]s. `main` returns `stage::run(&Stage { .. })`, whose exit code says whether all findings are good.

mod again;
mod check;
mod film;
mod hand;
mod keys;
mod living;
mod look;
mod means;
pub mod offscreen;
mod orbit;
mod plain;
mod plot;
mod progress;
mod rope;
mod skin;
mod strip;
mod toll;

pub use again::{Again, Begin, fresh, tick};
pub use check::{Finding, Track, larger, smaller, tracks};
pub use keys::SpaceIsTaken;
pub use living::{Lasting, Upright};
pub use look::{Paint, Shape, floor};
pub use plot::Plot;
pub use rope::Rope;
pub use skin::{Skin, Vertex};

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use means::{Film, Means};
use std::path::PathBuf;

/// Duration of a tick, s.
pub const DT: f32 = 1.0 / 60.0;

/// An example: its setup, its duration, and its check.
#[derive(Clone, Copy)]
pub struct Stage {
    pub title: &'static str,
    /// Adds systems and resources. Spawn in [`Begin`].
    pub setup: fn(&mut App),
    /// Time of the check, s.
    pub seconds: f32,
    /// Time after which the scene restarts in a window, s; at least `seconds`.
    pub again: f32,
    /// Compares measurements with theory.
    pub check: fn(&mut World) -> Vec<Finding>,
    /// Position of the camera, m.
    pub eye: Vec3,
    /// Point that the camera looks at, m.
    pub target: Vec3,
}

/// Inserted by a `setup`: time of the `--screenshot` picture, s, where it is not the end.
#[derive(Resource)]
pub struct PictureAt(pub f32);

/// Inserted by a `setup` that moves bodies by their `Transform`: Rapier's plugin reads it only once a frame.
#[derive(Resource)]
pub struct TickByTick;

/// The command line arguments.
#[derive(Default)]
struct Arguments {
    headless: bool,
    /// Duration for which the scene is watched, in minutes.
    minutes: Option<f32>,
    film: Option<Film>,
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
                "--minutes" => {
                    let minutes = words.next().and_then(|m| m.parse().ok());
                    out.minutes = Some(minutes.ok_or("--minutes needs a number")?);
                }
                "--screenshot" => out.film = Some(Film::Still(path()?)),
                "--frames" => out.film = Some(Film::Frames(path()?)),
                // Read by scenes with a plot.
                "--plot" => drop(path()?),
                // Read by scenes with an alternative in Rapier's own springs.
                "--rapier" => {}
                // Read where pictures are made.
                "--small" => {}
                "--film" => out.film = Some(Film::Last(path()?)),
                _ => return Err(format!("unknown argument {word}")),
            }
        }
        Ok(out)
    }
}

/// Returns the path for the plot if the command line asks for one.
pub fn plot_path() -> Option<PathBuf> {
    let words: Vec<_> = std::env::args().collect();
    let at = words.iter().position(|word| word == "--plot")?;
    words.get(at + 1).map(PathBuf::from)
}

/// Returns whether the command line contains this word.
pub fn given(word: &str) -> bool {
    std::env::args().any(|other| other == word)
}

/// Runs an example as machine and command line allow.
pub fn run(stage: &Stage) -> AppExit {
    let arguments = match Arguments::read() {
        Ok(arguments) => arguments,
        Err(wrong) => {
            eprintln!(
                "{wrong}; use --headless, --minutes NUMBER, --screenshot FILE, --frames FOLDER or --film FOLDER, and --small"
            );
            return AppExit::error();
        }
    };
    if let Some(minutes) = arguments.minutes {
        return living::watch(stage, minutes);
    }
    let means = Means::find(arguments.headless, arguments.film);
    println!("{}: {means}", stage.title);
    match means {
        Means::Window => window(stage),
        Means::Film { film, .. } => film::shoot(stage, film),
        Means::Headless(_) => headless(stage),
    }
}

/// Returns an app with physics only, one tick in each update.
fn headless_app(stage: &Stage) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, CoiloverPlugin::default()));
    physics(&mut app, stage, 1);
    app
}

/// Runs only the check, as fast as possible.
fn headless(stage: &Stage) -> AppExit {
    let mut app = headless_app(stage);
    app.finish();
    app.cleanup();
    for _ in 0..=(stage.seconds / DT).round() as u32 {
        app.update();
    }
    if say(stage, app.world_mut()) {
        AppExit::Success
    } else {
        AppExit::error()
    }
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
    again::repeat(&mut app, stage.again);
    look::dress(&mut app, stage.eye, stage.target, None);
    plain::add(&mut app);
    hand::add(&mut app);
    orbit::add(&mut app, stage);
    keys::add(&mut app, stage);
    let (stage, mut told) = (*stage, false);
    app.add_systems(Last, move |world: &mut World| {
        if !told && world.resource::<Time<Fixed>>().elapsed_secs() >= stage.seconds {
            told = true;
            say(&stage, world);
        }
    });
    app.run()
}

/// Adds Rapier with a fixed step. Each update runs this number of ticks; 0 follows the clock.
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
    // Nothing is recorded after the check.
    let due = stage.seconds + 0.5 * DT;
    app.add_systems(
        FixedUpdate,
        check::record
            .after(CoiloverSystems::Readout)
            .run_if(move |time: Res<Time>| time.elapsed_secs() < due),
    );
    again::begin(app);
    (stage.setup)(app);
}

/// Prints the check. Returns whether all findings are good.
fn say(stage: &Stage, world: &mut World) -> bool {
    println!("{}, after {} s:", stage.title, stage.seconds);
    let findings = (stage.check)(world);
    findings.iter().for_each(|finding| println!("  {finding}"));
    // A check that measured nothing has not been passed.
    !findings.is_empty() && findings.iter().all(|finding| finding.good)
}
