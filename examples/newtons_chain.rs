//! Waves along three rows of beads on springs. Each row is driven at a higher frequency than the one above it. A
//! higher frequency means a shorter and a slower wave. The greatest speed is √(k/m) beads a second.
//!
//! At the far end of each row a damper absorbs the wave, so nothing is reflected.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, DT, Finding, Paint, Shape, Stage};
use std::f32::consts::TAU;

const BEADS: usize = 20;
const MASS: f32 = 0.5;
/// Distance between neighbouring beads, m.
const PITCH: f32 = 0.25;
/// √(k/m), rad/s.
const OMEGA: f32 = 18.0;
const STIFFNESS: f32 = MASS * OMEGA * OMEGA;
const AMPLITUDE: f32 = 0.075;
/// Period of each row's drive, in ticks, so that the check uses whole periods.
const PERIODS: [u32; 3] = [70, 21, 13];
const RADIUS: f32 = 0.06;
/// Time of the check, s.
const SECONDS: f32 = 12.0;
/// Duration at the end in which the beads are measured, s: the initial transients have left the rows by then.
const WATCHED: f32 = 4.0;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "newtons_chain",
        setup: |app| {
            app.add_systems(Begin, setup)
                .add_systems(FixedUpdate, shake.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, watch.after(CoiloverSystems::Readout));
        },
        seconds: SECONDS,
        again: f32::INFINITY,
        check,
        eye: Vec3::new(1.3, 2.1, 5.9),
        target: Vec3::new(0.25, 0.97, 0.0),
    })
}

/// The piston that drives a row.
#[derive(Component)]
struct Piston {
    row: usize,
    home: Vec3,
}

/// A bead: row, number, and amplitude at the row's frequency, as cosine and sine parts, m.
#[derive(Component)]
struct Bead {
    row: usize,
    number: usize,
    home: f32,
    swing: Vec2,
}

/// Returns the angular frequency of a row's drive, rad/s.
fn frequency(row: usize) -> f32 {
    TAU / (PERIODS[row] as f32 * DT)
}

/// Returns the phase difference between neighbouring beads at the row's frequency: ω = 2 √(k/m) sin(phase/2).
fn phase(row: usize) -> f32 {
    2.0 * (0.5 * frequency(row) / OMEGA).asin()
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let length = PITCH * (BEADS + 1) as f32;
    for row in 0..PERIODS.len() {
        let y = 1.75 - 0.6 * row as f32;
        let at = |i: usize| Vec3::new(PITCH * i as f32 - 0.5 * length, y, 0.0);
        commands.spawn((
            Transform::from_xyz(0.0, y, 0.0).with_rotation(Quat::from_rotation_z(TAU / 4.0)),
            Shape::Cylinder(0.012, length + 1.0, Paint::Iron),
        ));
        let piston = (
            Transform::from_translation(at(0)),
            Shape::Cuboid(Vec3::new(0.1, 0.26, 0.26), Paint::Blue),
            Piston { row, home: at(0) },
        );
        let mut before = commands.spawn(piston).id();
        let mut reach = 0.05;
        for number in 1..=BEADS {
            // The last bead has half the mass: with it, the damper acts as the rest of an endless row would.
            let share = if number == BEADS { 0.5 } else { 1.0 };
            let bead = commands
                .spawn((
                    RigidBody::Dynamic,
                    AdditionalMassProperties::Mass(MASS * share),
                    LockedAxes::ROTATION_LOCKED
                        | LockedAxes::TRANSLATION_LOCKED_Y
                        | LockedAxes::TRANSLATION_LOCKED_Z,
                    Transform::from_translation(at(number)),
                    Shape::Ball(RADIUS, Paint::Ivory),
                    Bead {
                        row,
                        number,
                        home: at(number).x,
                        swing: Vec2::ZERO,
                    },
                ))
                .id();
            commands.spawn((
                Spring::new(before, bead)
                    .with_stiffness(STIFFNESS)
                    .with_rest_length(PITCH - reach - RADIUS),
                Anchors::new(Vec3::X * reach, Vec3::NEG_X * RADIUS),
                Coil::new(0.08, 0.009, 4.0),
            ));
            (before, reach) = (bead, RADIUS);
        }
        let wall = commands
            .spawn((
                Transform::from_translation(at(BEADS) + Vec3::X * 0.62),
                Shape::Cuboid(Vec3::new(0.1, 0.26, 0.26), Paint::Iron),
            ))
            .id();
        // The characteristic impedance of the row: a wave continues into the damper without reflection.
        let impedance = (STIFFNESS * MASS).sqrt() * (0.5 * phase(row)).cos();
        commands.spawn((
            Damper::new(before, wall).with_damping(impedance),
            Anchors::new(Vec3::X * RADIUS, Vec3::NEG_X * 0.05),
            Telescope::new(0.05, 0.02).with_stroke(0.2),
        ));
    }
}

fn shake(time: Res<Time>, mut pistons: Query<(&Piston, &mut Transform)>) {
    let t = time.elapsed_secs();
    for (piston, mut transform) in &mut pistons {
        let strength = AMPLITUDE * (t / 1.5).min(1.0).powi(2);
        let push = strength * (frequency(piston.row) * t).sin();
        transform.translation = piston.home + Vec3::X * push;
    }
}

/// Measures the amplitude of each bead at its row's frequency, over as many whole periods as fit.
fn watch(time: Res<Time>, mut beads: Query<(&Transform, &mut Bead)>) {
    let t = time.elapsed_secs();
    for (transform, mut bead) in &mut beads {
        let period = PERIODS[bead.row] as f32 * DT;
        let watched = period * (WATCHED / period).floor();
        if (SECONDS - watched + 0.5 * DT..SECONDS + 0.5 * DT).contains(&t) {
            let away = transform.translation.x - bead.home;
            let angle = frequency(bead.row) * t;
            bead.swing += 2.0 * DT / watched * away * Vec2::new(angle.cos(), angle.sin());
        }
    }
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut query = world.query::<&Bead>();
    for row in 0..PERIODS.len() {
        let mut beads: Vec<&Bead> = query.iter(world).filter(|bead| bead.row == row).collect();
        beads.sort_by_key(|bead| bead.number);
        let turned: f32 = beads
            .windows(2)
            .map(|pair| pair[0].swing.angle_to(pair[1].swing).abs())
            .sum();
        let measured = turned / (BEADS - 1) as f32;
        let speed = |phase: f32| PITCH * frequency(row) / phase;
        out.push(Finding::close(
            &format!("{:.2} Hz, speed of the wave", frequency(row) / TAU),
            speed(measured),
            speed(phase(row)),
            "m/s",
            0.01,
        ));
        // No energy is lost along the row. The error at the highest frequency comes from the piston's path, which is
        // sampled per step.
        let last = beads[BEADS - 1].swing.length();
        let what = "  swing at the far end against the piston's";
        out.push(Finding::close(what, last, AMPLITUDE, "m", 0.05));
    }
    out
}
