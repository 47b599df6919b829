//! A shock absorber on a test rig, with preload and three times as much damping in rebound as in bump. The board
//! behind it shows force over velocity, point by point. Beside it, a weight presses a second absorber onto its bump
//! stop.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none, and `--plot FILE` writes
//! force over velocity as a PNG.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use image::Rgb;
use stage::{
    Begin, DT, Finding, Paint, PictureAt, Plot, Shape, Stage, Track, Upright, smaller, tracks,
};
use std::f32::consts::{PI, TAU};

const STIFFNESS: f32 = 6_000.0;
const REST: f32 = 0.62;
const PRELOAD: f32 = -300.0;
/// Damping in bump, N s/m.
const BUMP: f32 = 800.0;
/// Damping in rebound, N s/m.
const REBOUND: f32 = 2_400.0;
/// Length at which the bump stop begins, m.
const SHORTEST: f32 = 0.42;
/// Length at which the rebound stop begins, m.
const LONGEST: f32 = 0.68;
/// Stiffness of the stops, N/m.
const STOP: f32 = 60e3;
/// Progression of the stops, 1/m.
const PROGRESSION: f32 = 20.0;
/// Length of the driven absorber at the start, its longest, m.
const START: f32 = 0.60;
/// Amplitude of the drive, m.
const AMPLITUDE: f32 = 0.05;
/// Frequency of the drive, Hz.
const FREQUENCY: f32 = 1.0;
/// Mass of the weight on the other absorber, kg.
const MASS: f32 = 250.0;
const GRAVITY: f32 = 9.81;
/// Height of the lower eyes above the ground, m.
const FOOT: f32 = 0.24;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "shock_absorber",
        setup: |app| {
            app.insert_resource(PictureAt(2.2))
                .add_systems(Begin, (driven, pressed, board).chain())
                .add_systems(FixedUpdate, drive.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, draw.after(CoiloverSystems::Readout));
        },
        seconds: 6.0,
        again: 14.0,
        check,
        eye: Vec3::new(0.4, 1.1, 3.0),
        target: Vec3::new(0.03, 0.58, 0.0),
    })
}

/// The part that the drive moves, with its height at the start, m.
#[derive(Component)]
struct Crosshead(f32);

/// Returns an absorber between an eye on `foot` and an eye below `body`.
fn absorber(foot: Entity, body: Entity, below: f32) -> impl Bundle {
    (
        SpringDamper::new(foot, body)
            .with_stiffness(STIFFNESS)
            .with_rest_length(REST),
        DampingLaw::sided(BUMP, REBOUND),
        Preload(PRELOAD),
        SpringTravel::new(SHORTEST, LONGEST, STOP).with_progression(PROGRESSION),
        Anchors::new(Vec3::Y * 0.14, Vec3::NEG_Y * below),
        Coil::new(0.06, 0.0075, 8.0),
        Telescope {
            tube_length: Some(0.3),
            ..Telescope::new(0.034, 0.012)
                .with_stroke(0.26)
                .with_fittings()
        },
        Track::default(),
    )
}

fn foot(x: f32) -> impl Bundle {
    (
        RigidBody::Fixed,
        Transform::from_xyz(x, FOOT - 0.14, 0.0),
        Shape::Cuboid(Vec3::new(0.3, 0.2, 0.3), Paint::Iron),
    )
}

fn driven(mut commands: Commands) {
    commands.spawn(stage::floor());
    let x = -0.75;
    let foot = commands.spawn(foot(x)).id();
    let height = FOOT + START + 0.1;
    let crosshead = commands
        .spawn((
            RigidBody::KinematicPositionBased,
            Transform::from_xyz(x, height, 0.0),
            Shape::Cuboid(Vec3::new(0.6, 0.1, 0.22), Paint::Blue),
            Crosshead(height),
        ))
        .id();
    for side in [-0.24, 0.24] {
        commands.spawn((
            Transform::from_xyz(x + side, 0.6, 0.0),
            Shape::Cylinder(0.025, 1.2, Paint::Ivory),
        ));
    }
    commands.spawn((
        Transform::from_xyz(x, 1.22, 0.0),
        Shape::Cuboid(Vec3::new(0.6, 0.08, 0.22), Paint::Iron),
    ));
    commands.spawn(absorber(foot, crosshead, 0.1));
}

fn pressed(mut commands: Commands) {
    let x = 0.85;
    let foot = commands.spawn(foot(x)).id();
    let weight = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            LockedAxes::ROTATION_LOCKED
                | LockedAxes::TRANSLATION_LOCKED_X
                | LockedAxes::TRANSLATION_LOCKED_Z,
            Transform::from_xyz(x, FOOT + REST + 0.2, 0.0),
            Shape::Cylinder(0.24, 0.2, Paint::Blue),
            Upright(0.01),
        ))
        .id();
    commands.spawn(absorber(foot, weight, 0.2));
}

/// Returns the position on the board for a velocity (m/s) and a force (N).
fn on_board(velocity: f32, force: f32) -> Vec3 {
    Vec3::new(0.05 + 1.1 * velocity, 0.72 + 3.6e-4 * force, -0.33)
}

fn board(mut commands: Commands) {
    commands.spawn((
        Transform::from_xyz(0.05, 0.62, -0.36),
        Shape::Cuboid(Vec3::new(0.86, 0.82, 0.03), Paint::Iron),
    ));
    let level = (Vec3::new(0.8, 0.005, 0.004), on_board(0.0, 0.0));
    let upright = (
        Vec3::new(0.005, 0.76, 0.004),
        Vec3::new(0.05, 0.62, level.1.z),
    );
    for (size, at) in [level, upright] {
        commands.spawn((
            Transform::from_translation(at - Vec3::Z * 0.013),
            Shape::Cuboid(size, Paint::Ivory),
        ));
    }
}

/// Returns the height of the drive relative to its start, m.
fn path(t: f32) -> f32 {
    AMPLITUDE * ((TAU * FREQUENCY * t).cos() - 1.0)
}

fn drive(time: Res<Time>, mut crossheads: Query<(&mut Transform, &Crosshead)>) {
    for (mut at, crosshead) in &mut crossheads {
        at.translation.y = crosshead.0 + path(time.elapsed_secs());
    }
}

/// Draws one cycle of points on the board: the damper's force in ivory, the total force in blue.
fn draw(elements: Query<&Track>, mut commands: Commands) {
    let Some(track) = elements.iter().min_by_key(|track| track.number()) else {
        return;
    };
    let cycle = 1.0 / FREQUENCY;
    if let Some((t, seen)) = track.0.last()
        && (cycle..2.0 * cycle).contains(t)
    {
        for (force, paint) in [
            (seen.damper_force, Paint::Ivory),
            (seen.force(), Paint::Blue),
        ] {
            let at = Transform::from_translation(on_board(seen.rate, force));
            commands.spawn((at, Shape::Ball(0.009, paint)));
        }
    }
}

fn damping(rate: f32) -> f32 {
    rate * if rate < 0.0 { BUMP } else { REBOUND }
}

/// Returns the force of a stop at this depth, N.
fn stop(depth: f32) -> f32 {
    STOP * depth * (1.0 + PROGRESSION * depth)
}

/// Returns the greatest depth of the weight in the stop after its release, m, integrated in fine steps.
fn plunge() -> f32 {
    let (mut length, mut rate, h) = (f64::from(REST), 0.0_f64, 1e-5);
    while rate <= 0.0 {
        let depth = (SHORTEST - length as f32).max(0.0);
        let push =
            STIFFNESS * (REST - length as f32) - PRELOAD - damping(rate as f32) + stop(depth);
        rate += h * f64::from(push / MASS - GRAVITY);
        length += h * rate;
    }
    SHORTEST - length as f32
}

fn check(world: &mut World) -> Vec<Finding> {
    let tracks = tracks(world);
    // The first cycle is for settling in.
    let cycle = (1.0 / (FREQUENCY * DT)).round() as usize;
    let seen = &tracks[0].0[cycle..];
    let mut off = [0.0_f32; 2];
    for (_, r) in seen {
        let spring = STIFFNESS * (r.length - REST) + PRELOAD;
        off[0] = off[0].max((r.spring_force - spring).abs());
        off[1] = off[1].max((r.damper_force - damping(r.rate)).abs());
    }
    let cycles = (seen.len() - 1) / cycle;
    // The work is the area of the loop. The drive moves at a constant speed within each tick.
    let strokes = seen[..=cycles * cycle].windows(2);
    let work = strokes.map(|w| {
        let (before, after) = (w[0].1, w[1].1);
        let spring = 0.5 * (before.spring_force + after.spring_force);
        (spring + after.damper_force) * (after.length - before.length)
    });
    let work: f32 = work.sum();
    // ∮ c ẋ dx over half a cycle is c π A² ω/2.
    let integral = 0.5 * (BUMP + REBOUND) * PI * AMPLITUDE * AMPLITUDE * TAU * FREQUENCY;

    // k (rest − L) − preload + stop = m g with L = shortest − depth, by Newton's iteration.
    let mut depth = 0.0_f32;
    for _ in 0..50 {
        let spring = STIFFNESS * (REST - SHORTEST + depth) - PRELOAD;
        let slope = STIFFNESS + STOP * (1.0 + 2.0 * PROGRESSION * depth);
        depth -= (spring + stop(depth) - MASS * GRAVITY) / slope;
    }
    let rest = tracks[1].last();
    let lengths = tracks[1].0.iter().map(|(_, r)| r.length);
    let deepest = SHORTEST - lengths.fold(f32::MAX, smaller);
    if let Some(file) = stage::plot_path() {
        match plot(seen).save(&file) {
            Ok(()) => println!("  force over velocity is in {}", file.display()),
            Err(wrong) => eprintln!("{}: {wrong}", file.display()),
        }
    }
    vec![
        Finding::small("spring and preload beside their law", off[0], 1e-1, "N"),
        Finding::small("damper beside its law", off[1], 1e-1, "N"),
        Finding::close("work a cycle", work / cycles as f32, integral, "J", 0.01),
        Finding::close(
            "deepest on the stop",
            1e3 * deepest,
            1e3 * plunge(),
            "mm",
            0.02,
        ),
        Finding::close(
            "  at rest",
            1e3 * (SHORTEST - rest.length),
            1e3 * depth,
            "mm",
            5e-3,
        ),
        Finding::close("  bears", -rest.force(), MASS * GRAVITY, "N", 1e-3),
    ]
}

fn plot(seen: &[(f32, SpringReadout)]) -> Plot {
    let mut plot = Plot::new([-0.4, 0.4, 0.1], [-1500.0, 1000.0, 500.0], ["m/s", "N"]);
    let law: Vec<_> = (-40..=40).map(|i| 0.01 * i as f32).collect();
    let law: Vec<_> = law.into_iter().map(|v| (v, damping(v))).collect();
    plot.curve(&law, Rgb([200, 60, 50]));
    let measured = |of: fn(&SpringReadout) -> f32| -> Vec<_> {
        seen.iter().map(|(_, r)| (r.rate, of(r))).collect()
    };
    plot.marks(&measured(|r| r.force()), Rgb([60, 110, 160]));
    plot.marks(&measured(|r| r.damper_force), Rgb([40, 42, 46]));
    plot
}
