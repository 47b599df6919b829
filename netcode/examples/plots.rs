//! Draws two plots of the guide: the futures of a game that goes back, and the frames that run again over a bad connection.
//!
//! Run `cargo run --release -p netcode --example plots -- docs/guide`. It writes `going_back.svg` and `frames_again.svg` there.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_ggrs::Session;
use bevy_rapier3d::prelude::*;
use netcode::game::{self, Compared, DOWN, Lift, RATE, UP};
use netcode::lossy::Weather;
use netcode::peers::Peers;
use netcode::rollback::{Physics, RollbackPhysicsPlugin};
use plotters::prelude::*;
use plotters::style::Color as _;
use std::error::Error;
use std::path::{Path, PathBuf};

type Drawn = Result<(), Box<dyn Error>>;

/// Number of ticks before the snapshot, and after it.
const BEFORE: usize = 200;
const AFTER: usize = 300;

/// Least drawn distance, m. A logarithmic axis has no zero.
const NOTHING: f32 = 1e-8;

const SIZE: (u32, u32) = (760, 380);
const INK: RGBColor = RGBColor(40, 44, 52);
const FAINT: RGBColor = RGBColor(225, 228, 232);
const BLUE: RGBColor = RGBColor(20, 90, 200);
const RED: RGBColor = RGBColor(200, 40, 50);
const ORANGE: RGBColor = RGBColor(230, 130, 0);

fn main() -> Drawn {
    let folder: PathBuf = std::env::args().nth(1).unwrap_or_else(|| ".".into()).into();
    draw_futures(&folder.join("going_back.svg"))?;
    draw_again(&folder.join("frames_again.svg"))
}

/// State that is restored.
#[derive(Clone, Copy)]
enum Back {
    /// Poses and velocities of bodies.
    Bodies,
    /// The snapshot of Rapier.
    Rapier,
    /// The snapshots of Rapier and of the springs.
    Both,
}

/// The game without a network. The tick number drives its lifts.
struct Game {
    app: App,
    tick: usize,
}

impl Game {
    fn new() -> Result<Self, Box<dyn Error>> {
        let session = Session::SyncTest(game::sync_test(0)?);
        let mut app = game::app(session, RollbackPhysicsPlugin::default());
        app.update();
        let mut game = Self { app, tick: 0 };
        game.play(BEFORE);
        Ok(game)
    }

    /// Plays a number of ticks. Returns the positions of all bodies after each tick, m.
    fn play(&mut self, ticks: usize) -> Vec<Vec<Vec3>> {
        let world = self.app.world_mut();
        let mut lifts = world.query::<(&Lift, &mut SpringDamper)>();
        let mut bodies = world.query_filtered::<&Transform, With<Compared>>();
        let mut seen = Vec::new();
        for _ in 0..ticks {
            for (lift, mut actuator) in lifts.iter_mut(world) {
                let step = match game::press(self.tick as i32, lift.player) {
                    UP => 0.5,
                    DOWN => -0.5,
                    _ => continue,
                } / f32::from(RATE);
                actuator.rest_length = actuator.rest_length.map(|now| (now + step).clamp(0.6, 1.4));
            }
            world.run_schedule(Physics);
            seen.push(bodies.iter(world).map(|at| at.translation).collect());
            self.tick += 1;
        }
        seen
    }
}

/// Plays on, goes back and plays again. Returns the greatest distance of a body from its first future for each tick, m.
fn distances(back: Back) -> Result<Vec<f32>, Box<dyn Error>> {
    let mut game = Game::new()?;
    let world = game.app.world_mut();
    let engine = RapierSnapshot::take(world);
    let springs = CoiloverSnapshot::take(world);
    let mut bodies = world.query::<(Entity, &Transform, &Velocity)>();
    let bodies = bodies.iter(world).map(|(e, at, v)| (e, *at, *v));
    let bodies: Vec<_> = bodies.collect();
    let mut lifts = world.query_filtered::<(Entity, &SpringDamper), With<Lift>>();
    let lifts: Vec<_> = lifts.iter(world).map(|(e, lift)| (e, *lift)).collect();
    let first = game.play(AFTER);
    game.tick = BEFORE;
    let world = game.app.world_mut();
    for (entity, lift) in lifts {
        world.entity_mut(entity).insert(lift);
    }
    match back {
        Back::Bodies => bodies.into_iter().for_each(|(entity, at, velocity)| {
            world.entity_mut(entity).insert((at, velocity));
        }),
        Back::Rapier => engine.restore(world)?,
        Back::Both => {
            engine.restore(world)?;
            springs.restore(world)?;
        }
    }
    let second = game.play(AFTER);
    let farthest = |(a, b): (&Vec<Vec3>, &Vec<Vec3>)| {
        let each = a.iter().zip(b).map(|(a, b)| a.distance(*b));
        each.fold(0.0, f32::max)
    };
    Ok(first.iter().zip(&second).map(farthest).collect())
}

fn draw_futures(path: &Path) -> Drawn {
    let sheet = SVGBackend::new(path, SIZE).into_drawing_area();
    sheet.fill(&WHITE)?;
    let seconds = AFTER as f32 / f32::from(RATE);
    let mut chart = ChartBuilder::on(&sheet)
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..seconds, (NOTHING / 2.0..20.0).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(("sans-serif", 14).into_font().color(&INK))
        .x_desc("time after the game went back, s")
        .y_desc("largest distance from the first future, m")
        .y_label_formatter(&|y| format!("{y:.0e}"))
        .draw()?;
    for (back, title, paint) in [
        (Back::Bodies, "only Transform and Velocity", RED),
        (Back::Rapier, "RapierSnapshot", ORANGE),
        (
            Back::Both,
            "RapierSnapshot, CoiloverSnapshot: equal bits",
            BLUE,
        ),
    ] {
        let all = distances(back)?;
        let last = all.last().copied().unwrap_or_default();
        println!("{title}: {last:e} m after {seconds} s");
        let points = all.into_iter().enumerate();
        let points = points.map(|(i, d)| ((i + 1) as f32 / f32::from(RATE), d.max(NOTHING)));
        chart
            .draw_series(LineSeries::new(points, paint.stroke_width(2)))?
            .label(title)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], paint.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE)
        .label_font(("sans-serif", 14).into_font().color(&INK))
        .draw()?;
    sheet.present()?;
    Ok(())
}

/// Draws the frames that two peers run again in ten seconds.
fn draw_again(path: &Path) -> Drawn {
    const FRAMES: i32 = 600;
    let weather = Weather {
        delay: 3,
        jitter: 3,
        loss: 0.05,
    };
    let mut peers = Peers::connect(weather, RollbackPhysicsPlugin::default())?;
    peers.play(FRAMES)?;
    let sheet = SVGBackend::new(path, SIZE).into_drawing_area();
    sheet.fill(&WHITE)?;
    for (peer, panel) in sheet.split_evenly((2, 1)).iter().enumerate() {
        let again = &peers.again[peer];
        let most = again.iter().copied().max().unwrap_or(0) + 1;
        let mut chart = ChartBuilder::on(panel)
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(48)
            .build_cartesian_2d(0..FRAMES, 0..most)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(FAINT)
            .axis_style(INK)
            .y_labels(5)
            .label_style(("sans-serif", 13).into_font().color(&INK))
            .x_desc(format!("frame of peer {peer}"))
            .y_desc("run again")
            .draw()?;
        let bars = (0..FRAMES).zip(again).filter(|(_, many)| **many > 0);
        chart.draw_series(
            bars.map(|(x, y)| PathElement::new([(x, 0), (x, *y)], BLUE.stroke_width(2))),
        )?;
    }
    sheet.present()?;
    Ok(())
}
