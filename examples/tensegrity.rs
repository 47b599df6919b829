//! A tensegrity ball: six rigid struts that do not touch each other, held apart by twenty-four springs in tension. It
//! falls, bounces, rolls, and returns to the shape of a second ball that was set down gently.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage, larger};

/// Length of a strut, m.
const STRUT: f32 = 1.6;
/// Half the thickness of a strut, m. Struts are square: round ones would roll on their ends for ever, because Rapier
/// has no rolling resistance.
const HALF: f32 = 0.035;
/// Mass of a strut, kg.
const MASS: f32 = 1.0;
/// Stiffness of a spring, N/m.
const STIFFNESS: f32 = 1_500.0;
/// Damping of a spring, N s/m.
const DAMPING: f32 = 6.0;
/// Rest length of a spring, as a share of its length in the weightless ball.
const REST: f32 = 0.75;
/// Fall height of the dropped ball, m.
const FALL: f32 = 1.5;
const GRAVITY: f32 = 9.81;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "tensegrity",
        setup: |app| {
            app.insert_resource(PictureAt(0.4))
                .add_systems(Begin, (stage::fresh::<Energy>, setup))
                .add_systems(FixedUpdate, record.after(CoiloverSystems::Readout));
        },
        seconds: 9.0,
        again: 11.0,
        check,
        eye: Vec3::new(1.6, 1.9, 6.0),
        target: Vec3::new(0.1, 1.15, 0.0),
    })
}

/// The ball that a strut or a spring belongs to.
#[derive(Component, Clone, Copy, PartialEq)]
enum Ball {
    Dropped,
    SetDown,
}

/// Energy of the dropped ball at the start, the largest since, and the last, J.
#[derive(Resource, Default)]
struct Energy {
    first: Option<f32>,
    most: f32,
    last: f32,
}

fn setup(mut commands: Commands) {
    commands
        .spawn(stage::floor())
        .insert(Collider::cuboid(20.0, 0.05, 20.0));
    // This ball stands on one of its eight triangles of springs.
    let stand = Quat::from_rotation_arc(Vec3::ONE.normalize(), Vec3::Y);
    let height = 0.75 * STRUT / 3.0_f32.sqrt() + HALF;
    ball(
        &mut commands,
        Ball::SetDown,
        Vec3::new(1.2, height, 0.0),
        stand,
    );
    let tilt = Quat::from_euler(EulerRot::XYZ, 0.3, 0.5, -0.4);
    ball(
        &mut commands,
        Ball::Dropped,
        Vec3::new(-1.0, height + FALL, 0.0),
        tilt * stand,
    );
}

/// Spawns a ball with two struts along each axis, half their length apart. All springs have the same length. Only the
/// struts are in compression.
fn ball(commands: &mut Commands, which: Ball, center: Vec3, turn: Quat) {
    let mut ends = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        // Struts along x are offset along y, those along y along z, and those along z along x.
        let side = 0.25 * STRUT * Vec3::new(axis.z, axis.x, axis.y);
        for side in [side, -side] {
            let rotation = turn * Quat::from_rotation_arc(Vec3::Y, axis);
            let strut = commands
                .spawn((
                    RigidBody::Dynamic,
                    Collider::cuboid(HALF, 0.5 * STRUT + HALF, HALF),
                    ColliderMassProperties::Mass(MASS),
                    ReadMassProperties::default(),
                    Velocity::default(),
                    Transform::from_translation(center + turn * side).with_rotation(rotation),
                    Shape::Cuboid(2.0 * Vec3::new(HALF, 0.5 * STRUT + HALF, HALF), Paint::Blue),
                    which,
                ))
                .id();
            for sign in [-0.5, 0.5] {
                let along = sign * STRUT;
                ends.push((strut, Vec3::Y * along, side + axis * along));
            }
        }
    }
    let length = STRUT * 0.375_f32.sqrt();
    for (i, (a, on_a, from)) in ends.iter().enumerate() {
        for (b, on_b, to) in &ends[i + 1..] {
            if a != b && (from.distance(*to) - length).abs() < 1e-3 {
                commands.spawn((
                    SpringDamper::new(*a, *b)
                        .with_stiffness(STIFFNESS)
                        .with_damping(DAMPING)
                        .with_rest_length(REST * length),
                    Anchors::new(*on_a, *on_b),
                    Coil::new(0.032, 0.007, 22.0),
                    which,
                ));
            }
        }
    }
}

fn record(
    mut energy: ResMut<Energy>,
    struts: Query<(&Ball, &ReadMassProperties, &Transform, &Velocity)>,
    springs: Query<(&Ball, &SpringReadout)>,
) {
    let mut sum = 0.0;
    for (ball, mass, at, v) in &struts {
        if *ball == Ball::Dropped {
            let inertia = mass.get().principal_inertia;
            let frame = at.rotation * mass.get().principal_inertia_local_frame;
            let own = frame.inverse() * v.angular;
            sum += MASS * GRAVITY * at.translation.y
                + 0.5 * (MASS * v.linear.length_squared() + own.dot(inertia * own));
        }
    }
    let stored = springs.iter().filter(|(ball, _)| **ball == Ball::Dropped);
    sum += stored
        .map(|(_, readout)| readout.stored_energy)
        .sum::<f32>();
    energy.first.get_or_insert(sum);
    energy.most = energy.most.max(sum);
    energy.last = sum;
}

/// Returns the spring lengths of a ball, shortest first.
fn lengths(world: &mut World, which: Ball) -> Vec<f32> {
    let mut query = world.query::<(&Ball, &SpringReadout)>();
    let own = query.iter(world).filter(|(ball, _)| **ball == which);
    let mut out: Vec<f32> = own.map(|(_, readout)| readout.length).collect();
    out.sort_by(f32::total_cmp);
    out
}

fn check(world: &mut World) -> Vec<Finding> {
    let (dropped, set_down) = (lengths(world, Ball::Dropped), lengths(world, Ball::SetDown));
    let differences = dropped
        .iter()
        .zip(&set_down)
        .map(|(a, b)| (a / b - 1.0).abs());
    let worst = differences.fold(0.0, larger);
    let mean = dropped.iter().sum::<f32>() / dropped.len() as f32;
    let mut speeds = world.query_filtered::<&Velocity, With<Ball>>();
    let fastest = speeds.iter(world).map(|v| v.linear.length());
    let fastest = fastest.fold(0.0, larger);
    let energy = world.resource::<Energy>();
    let first = energy.first.unwrap_or(f32::NAN);
    let drop = 6.0 * MASS * GRAVITY * FALL;
    vec![
        // The largest energy is that of the landing step.
        Finding::small(
            "energy above the first",
            (energy.most - first) / first,
            0.05,
            "of it",
        ),
        Finding::close("energy lost", first - energy.last, drop, "J", 0.1),
        Finding::small("speed in the end", fastest, 0.05, "m/s"),
        Finding::close(
            "mean length of the springs",
            mean,
            STRUT * 0.375_f32.sqrt(),
            "m",
            0.01,
        ),
        Finding::small("lengths, dropped against set down", worst, 0.02, "of them"),
    ]
}
