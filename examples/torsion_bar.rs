//! Two torsion springs with dampers: a balance wheel that oscillates on a spiral spring, as in a clock, and a wheel's
//! arm on a torsion bar that is twisted by the wheel load.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage, Track, tracks};
use std::f32::consts::TAU;

/// Moment of inertia of the balance wheel about its axis, kg m².
const INERTIA: f32 = 0.05;
/// Stiffness of the spiral spring, N m/rad.
const SPIRAL: f32 = 0.8;
/// Damping of the spiral spring, N m s/rad.
const SPIRAL_DAMPING: f32 = 0.012;
/// Twist of the spiral spring at the start, rad: nearly half a turn.
const TWIST: f32 = 3.0;

/// Length of the arm, m.
const ARM: f32 = 0.7;
/// Mass at the end of the arm, kg.
const LOAD: f32 = 40.0;
/// Stiffness of the torsion bar, N m/rad.
const BAR: f32 = 700.0;
/// Damping of the torsion bar, N m s/rad.
const BAR_DAMPING: f32 = 60.0;
const GRAVITY: f32 = 9.81;
/// Angle of the arm above the horizontal at which the bar has no moment, rad.
const SET: f32 = 0.45;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "torsion_bar",
        setup: |app| {
            app.insert_resource(PictureAt(0.62))
                .add_systems(Begin, (balance, bar).chain());
        },
        seconds: 12.0,
        again: 20.0,
        check,
        eye: Vec3::new(-1.3, 2.0, 4.1),
        target: Vec3::new(-0.08, 0.78, 0.0),
    })
}

fn balance(mut commands: Commands) {
    commands.spawn(stage::floor());
    let middle = Vec3::new(-0.95, 0.85, 0.0);
    let along_z = Quat::from_rotation_x(TAU / 4.0);
    let stand = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_translation(middle),
            Visibility::default(),
            children![
                (
                    Transform::from_xyz(0.0, -0.36, -0.16),
                    Shape::Cuboid(Vec3::new(0.14, 0.98, 0.1), Paint::Iron),
                ),
                (
                    Transform::from_xyz(0.0, 0.0, -0.03).with_rotation(along_z),
                    Shape::Cylinder(0.03, 0.3, Paint::Iron),
                ),
            ],
        ))
        .id();
    let wheel = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::MassProperties(MassProperties {
                mass: 4.0,
                principal_inertia: Vec3::new(0.03, 0.03, INERTIA),
                ..default()
            }),
            LockedAxes::TRANSLATION_LOCKED
                | LockedAxes::ROTATION_LOCKED_X
                | LockedAxes::ROTATION_LOCKED_Y,
            Transform::from_translation(middle),
            Visibility::default(),
            children![
                (
                    Transform::from_rotation(along_z),
                    Shape::Cylinder(0.36, 0.06, Paint::Blue),
                ),
                // A mark that shows the angle.
                (
                    Transform::from_xyz(0.3, 0.0, 0.035),
                    Shape::Cuboid(Vec3::new(0.1, 0.05, 0.03), Paint::Ivory),
                ),
            ],
        ))
        .id();
    commands.spawn((
        TorsionSpringDamper::new(stand, wheel, Vec3::Z)
            .with_stiffness(SPIRAL)
            .with_damping(SPIRAL_DAMPING)
            .with_rest_angle(TWIST),
        TorsionCoil::new(0.24, 4.0)
            .with_center(Vec3::Z * 0.08)
            .with_color(Color::srgb(0.85, 0.62, 0.10)),
        Track::default(),
    ));
}

fn bar(mut commands: Commands) {
    let pivot = Vec3::new(0.15, 0.75, 0.0);
    let along_z = Quat::from_rotation_x(TAU / 4.0);
    let frame = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_translation(pivot),
            Visibility::default(),
            children![
                // The clamp at the far end, and the bearing at the arm's end.
                (
                    Transform::from_xyz(0.0, -0.3, -1.2),
                    Shape::Cuboid(Vec3::new(0.26, 0.9, 0.12), Paint::Iron),
                ),
                (
                    Transform::from_xyz(0.0, -0.36, -0.12),
                    Shape::Cuboid(Vec3::new(0.16, 0.78, 0.08), Paint::Iron),
                ),
                (
                    Transform::from_xyz(0.0, 0.0, -0.6).with_rotation(along_z),
                    Shape::Cylinder(0.05, 1.3, Paint::Ivory),
                ),
            ],
        ))
        .id();
    let hinge = RevoluteJointBuilder::new(Vec3::Z).local_anchor1(Vec3::ZERO);
    let tilt = Quat::from_rotation_z(SET);
    let arm = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::MassProperties(MassProperties {
                local_center_of_mass: Vec3::X * ARM,
                mass: LOAD,
                principal_inertia: Vec3::splat(0.4),
                ..default()
            }),
            Transform::from_translation(pivot).with_rotation(tilt),
            Visibility::default(),
            ImpulseJoint::new(frame, TypedJoint::RevoluteJoint(hinge.build())),
            children![
                (
                    Transform::from_rotation(along_z),
                    Shape::Cylinder(0.075, 0.12, Paint::Blue),
                ),
                (
                    Transform::from_xyz(0.5 * ARM, 0.0, 0.0),
                    Shape::Cuboid(Vec3::new(ARM, 0.09, 0.06), Paint::Blue),
                ),
                (
                    Transform::from_xyz(ARM, 0.0, 0.14).with_rotation(along_z),
                    Shape::Cylinder(0.26, 0.16, Paint::Iron),
                ),
                (
                    Transform::from_xyz(ARM, 0.0, 0.14).with_rotation(along_z),
                    Shape::Cylinder(0.14, 0.18, Paint::Ivory),
                ),
            ],
        ))
        .id();
    // The angle is 0 where both bodies' frames are aligned.
    commands.spawn((
        TorsionSpringDamper::new(frame, arm, Vec3::Z)
            .with_stiffness(BAR)
            .with_damping(BAR_DAMPING)
            .with_rest_angle(SET),
        Track::default(),
    ));
}

/// Returns the angle of the arm at rest, rad: κ (set − θ) = m g r cos θ.
fn level() -> f32 {
    let mut angle = 0.0_f32;
    for _ in 0..50 {
        angle = SET - LOAD * GRAVITY * ARM * angle.cos() / BAR;
    }
    angle
}

fn check(world: &mut World) -> Vec<Finding> {
    let tracks = tracks(world);
    let decay = SPIRAL_DAMPING / (2.0 * INERTIA);
    let turn = (SPIRAL / INERTIA - decay * decay).sqrt();
    let error = tracks[0].error(|t| {
        TWIST - TWIST * (-decay * t).exp() * ((turn * t).cos() + decay / turn * (turn * t).sin())
    });
    let period = 1.0 / tracks[0].frequency(TWIST);
    // The largest angle of each period.
    let tops: Vec<f32> = tracks[0]
        .0
        .windows(3)
        .map(|w| [w[0].1.length, w[1].1.length, w[2].1.length])
        .filter(|w| w[1] > w[0] && w[1] >= w[2])
        .map(|w| w[1] - TWIST)
        .collect();
    let fades = match tops[..] {
        [first, .., last] => (last / first).powf(1.0 / (tops.len() - 1) as f32),
        _ => f32::NAN,
    };
    let rest = tracks[1].last();
    vec![
        Finding::close("period of the balance wheel", period, TAU / turn, "s", 2e-4),
        Finding::close(
            "what a period leaves",
            fades,
            (-decay * TAU / turn).exp(),
            "",
            1e-3,
        ),
        Finding::small("largest error of its angle", error, 1e-3, "rad"),
        Finding::close(
            "twist of the bar",
            SET - rest.length,
            SET - level(),
            "rad",
            1e-3,
        ),
        Finding::close(
            "its moment",
            -rest.spring_force,
            LOAD * GRAVITY * ARM * level().cos(),
            "N m",
            1e-3,
        ),
        Finding::small("the arm still turns at", rest.rate, 1e-3, "rad/s"),
    ]
}
