//! A jump from a bridge: 70 kg on ten metres of rope, which pulls and never pushes. The jump is a free fall until the
//! rope goes taut. After twenty bounces no energy is lost.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage, Track, Upright, larger, tracks};

const MASS: f32 = 70.0;
const STIFFNESS: f32 = 400.0;
const REST: f32 = 10.0;
const GRAVITY: f32 = 9.81;
/// Length of the rope at the start of the jump, m.
const START: f32 = 3.0;
/// Height of the rope's hook above the ground, m.
const BRIDGE: f32 = 20.5;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "bungee",
        setup: |app| {
            app.insert_resource(PictureAt(2.3))
                .add_systems(Begin, setup);
        },
        seconds: 90.0,
        again: 92.0,
        check,
        eye: Vec3::new(4.0, 9.5, 39.0),
        target: Vec3::new(0.0, 11.0, 0.0),
    })
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let bridge = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(0.0, BRIDGE, 0.0),
            Shape::Cuboid(Vec3::new(0.5, 0.2, 1.0), Paint::Iron),
            children![
                (
                    Transform::from_xyz(0.0, 0.4, -2.0),
                    Shape::Cuboid(Vec3::new(26.0, 0.6, 3.0), Paint::Iron),
                ),
                (
                    Transform::from_xyz(0.0, 1.6, -0.6),
                    Shape::Cuboid(Vec3::new(26.0, 0.12, 0.12), Paint::Ivory),
                ),
            ],
        ))
        .id();
    for x in [-9.0, 9.0] {
        commands.spawn((
            Transform::from_xyz(x, 0.5 * BRIDGE, -2.2),
            Shape::Cuboid(Vec3::new(1.6, BRIDGE, 2.0), Paint::Ivory),
        ));
    }
    for i in 0..27 {
        commands.spawn((
            Transform::from_xyz(i as f32 - 13.0, BRIDGE + 1.1, -0.6),
            Shape::Cuboid(Vec3::new(0.08, 1.0, 0.08), Paint::Ivory),
        ));
    }
    let jumper = commands
        .spawn((
            RigidBody::Dynamic,
            AdditionalMassProperties::Mass(MASS),
            Transform::from_xyz(0.0, BRIDGE - 0.1 - START - 0.9, 0.0),
            Shape::Capsule(0.35, 1.1, Paint::Blue),
            Upright(0.05),
            children![(
                Transform::from_xyz(0.0, -1.15, 0.0),
                Shape::Ball(0.28, Paint::Ivory),
            )],
        ))
        .id();
    commands.spawn((
        Spring::new(bridge, jumper)
            .with_stiffness(STIFFNESS)
            .with_rest_length(REST),
        SpringAction::Pull,
        Anchors::new(Vec3::NEG_Y * 0.1, Vec3::Y * 0.9),
        Coil::new(0.22, 0.055, 18.0),
        Track::default(),
    ));
}

fn check(world: &mut World) -> Vec<Finding> {
    let track = tracks(world)[0];
    let fall = (2.0 * (REST - START) / GRAVITY).sqrt();
    let mut off = 0.0_f32;
    for (t, seen) in track.0.iter().filter(|(t, _)| *t < fall) {
        off = off.max((seen.length - START - 0.5 * GRAVITY * t * t).abs());
    }
    // Height relative to the lowest point at which the jumper could hang, so that relative errors are meaningful.
    let sag = MASS * GRAVITY / STIFFNESS;
    let energy = |seen: &SpringReadout| {
        let height = REST + sag - seen.length;
        MASS * (GRAVITY * height + 0.5 * seen.rate * seen.rate) + seen.stored_energy
            - 0.5 * MASS * GRAVITY * sag
    };
    let first = MASS * GRAVITY * (REST - START + 0.5 * sag);
    let gone = track.0.iter().map(|(_, r)| (energy(r) / first - 1.0).abs());
    let gone = gone.fold(0.0, larger);
    let pushed = track.0.iter().map(|(_, r)| -r.force());
    let pushed = pushed.fold(0.0, larger);
    let bounces = track
        .0
        .windows(2)
        .filter(|w| w[0].1.rate > 0.0 && w[1].1.rate <= 0.0)
        .count();
    // k s²/2 = m g (rest − start + s)
    let lowest = REST + sag + (sag * sag + 2.0 * sag * (REST - START)).sqrt();
    let deepest = track.0.iter().map(|(_, r)| r.length).fold(0.0, larger);
    vec![
        Finding::small("off the parabola in the first fall", off, 1e-3, "m"),
        Finding::close("lowest", deepest, lowest, "m", 2e-3),
        Finding::between("bounces", bounces as f32, 20.0, 40.0, ""),
        Finding::small("share of the energy gone or gained", gone, 5e-3, ""),
        Finding::small("the slack rope pushes with", pushed, 1e-3, "N"),
    ]
}
