//! Two bodies ride over the same bumps on equal wheels. The one behind has a spring and a damper as in any car. The
//! one in front has a weak damper, and an actuator that changes the spring's rest length every tick, as if a spring
//! and a damper held the body from the sky (skyhook).
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, PictureAt, Shape, Stage, Track, Upright, larger, tracks};
use std::f32::consts::TAU;

const MASS: f32 = 300.0;
const STIFFNESS: f32 = 12e3;
/// Damping of the passive suspension, N s/m.
const PASSIVE: f32 = 1_150.0;
/// Damping of the suspension with the actuator, N s/m.
const ACTIVE: f32 = 250.0;
/// Stiffness of the virtual spring between body and sky, N/m.
const HOLD: f32 = 36e3;
/// Damping of the virtual damper between body and sky, N s/m.
const SKY: f32 = 9_000.0;
/// Stroke of the actuator to either side, m.
const STROKE: f32 = 0.12;
const REST: f32 = 0.75;
const GRAVITY: f32 = 9.81;
/// Radius of a wheel, m.
const RADIUS: f32 = 0.32;
/// Radius of the bars in the road, m.
const BAR: f32 = 0.4;
/// Height of the bars above the road, m.
const BUMP: f32 = 0.09;
/// Positions of the bars along x, m.
const BARS: [f32; 4] = [-2.6, -1.4, -0.2, 1.0];
/// Speed of the wheels, m/s.
const SPEED: f32 = 2.0;
/// Position of the wheels along x at the start, m.
const START: f32 = -4.5;
/// Half the size of a body, m.
const HALF: Vec3 = Vec3::new(0.6, 0.17, 0.32);

fn main() -> AppExit {
    stage::run(&Stage {
        title: "active_suspension",
        setup: |app| {
            app.insert_resource(PictureAt(2.85))
                .add_systems(Begin, (road, cars).chain())
                .add_systems(FixedUpdate, (roll, act).before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, trace.after(CoiloverSystems::Readout));
        },
        seconds: 4.8,
        again: 4.8,
        check,
        eye: Vec3::new(3.4, 2.0, 5.7),
        target: Vec3::new(-0.1, 0.62, 0.0),
    })
}

/// A wheel, or a visible part of one.
#[derive(Component)]
struct Wheel;

/// A body, with its height in each tick, m.
#[derive(Component, Default)]
struct Body(Vec<f32>);

/// On an element whose rest length is controlled: work of the actuator, J.
#[derive(Component, Default)]
struct Skyhook(f32);

fn road(mut commands: Commands) {
    commands.spawn(stage::floor());
    for x in BARS {
        commands.spawn((
            Transform::from_xyz(x, BUMP - BAR, 0.0).with_rotation(Quat::from_rotation_x(TAU / 4.0)),
            Shape::Cylinder(BAR, 2.6, Paint::Ivory),
        ));
    }
}

/// Returns the height of a wheel's centre while it rolls over the bars, m.
fn height(x: f32) -> f32 {
    let on = |bar: &f32| {
        let reach = RADIUS + BAR;
        let aside = (x - bar).abs().min(reach);
        BUMP - BAR + (reach * reach - aside * aside).sqrt()
    };
    BARS.iter().map(on).fold(RADIUS, larger)
}

fn cars(mut commands: Commands) {
    for (z, active) in [(-0.75, false), (0.75, true)] {
        let at = Transform::from_xyz(START, RADIUS, z);
        let tyre = Shape::Cylinder(RADIUS, 0.2, Paint::Iron);
        let wheel = commands
            .spawn((RigidBody::KinematicPositionBased, at, tyre, Wheel))
            .id();
        // Not a child: when several ticks pass in one frame, Rapier's plugin sees bodies with children move only in
        // the last of them.
        commands.spawn((
            at,
            Shape::Cylinder(0.55 * RADIUS, 0.22, Paint::Ivory),
            Wheel,
        ));
        let spoke = Vec3::new(0.3, 0.23, 0.04);
        commands.spawn((at, Shape::Cuboid(spoke, Paint::Iron), Wheel));
        let body = commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(MASS),
                LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_Z,
                Velocity::linear(Vec3::X * SPEED),
                Transform::from_xyz(START, level(), z),
                Shape::Cuboid(2.0 * HALF, Paint::Blue),
                Body::default(),
                Upright(0.05),
            ))
            .id();
        let color = if active {
            Color::srgb(0.80, 0.09, 0.07)
        } else {
            Color::srgb(0.75, 0.75, 0.78)
        };
        let mut element = commands.spawn((
            SpringDamper::new(wheel, body)
                .with_stiffness(STIFFNESS)
                .with_damping(if active { ACTIVE } else { PASSIVE })
                .with_rest_length(REST),
            // Acts only vertically: nothing drives the wheel forward or holds it back.
            SpringAxis::World(Vec3::Y),
            // On the axle, beside the wheel. The wheel's Y is along the axle.
            Anchors::new(Vec3::Y * 0.22, Vec3::new(0.0, -HALF.y, 0.22)),
            Coil::new(0.085, 0.013, 7.0).with_color(color),
            Telescope::new(0.035, 0.014).with_stroke(0.36),
            Track::default(),
        ));
        if active {
            element.insert(Skyhook::default());
        }
    }
}

fn roll(time: Res<Time>, mut wheels: Query<&mut Transform, With<Wheel>>) {
    let driven = SPEED * time.elapsed_secs();
    let turned = Quat::from_rotation_z(-driven / RADIUS) * Quat::from_rotation_x(TAU / 4.0);
    for mut wheel in &mut wheels {
        wheel.translation.x = START + driven;
        wheel.translation.y = height(START + driven);
        wheel.rotation = turned;
    }
}

/// Returns the height of a body at rest on the level, m.
fn level() -> f32 {
    RADIUS + REST - MASS * GRAVITY / STIFFNESS + HALF.y
}

/// Sets the rest length so that the spring's force is that of spring and damper between body and sky.
fn act(
    mut elements: Query<(&mut SpringDamper, &SpringReadout, &mut Skyhook)>,
    bodies: Query<(&Transform, &Velocity), With<Body>>,
) {
    for (mut element, readout, mut skyhook) in &mut elements {
        let Ok((at, velocity)) = bodies.get(element.body_b) else {
            continue;
        };
        let wanted = -SKY * velocity.linear.y - HOLD * (at.translation.y - level());
        let longer = wanted / STIFFNESS;
        let (was, now) = (
            element.rest_length.unwrap_or(REST),
            REST + longer.clamp(-STROKE, STROKE),
        );
        let energy = |rest: f32| 0.5 * STIFFNESS * (readout.length - rest).powi(2);
        if readout.length > 0.0 {
            skyhook.0 += energy(now) - energy(was);
        }
        element.rest_length = Some(now);
    }
}

/// Records the height of each body, and spawns a mark twenty times a second.
fn trace(time: Res<Time>, mut bodies: Query<(&Transform, &mut Body)>, mut commands: Commands) {
    let tick = stage::tick(&time);
    for (at, mut body) in &mut bodies {
        body.0.push(at.translation.y);
        if tick.is_multiple_of(3) {
            let above = at.translation + Vec3::Y * (HALF.y + 0.05);
            commands.spawn((
                Transform::from_translation(above),
                Shape::Ball(0.02, Paint::Ivory),
            ));
        }
    }
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut bodies = world.query::<(&Body, &Transform, &Velocity)>();
    let mut bodies: Vec<_> = bodies.iter(world).collect();
    // The passive one is behind.
    bodies.sort_by(|a, b| a.1.translation.z.total_cmp(&b.1.translation.z));
    let start = level();
    let mut ways = Vec::new();
    let mut energies = Vec::new();
    for (body, at, velocity) in &bodies {
        let away = body.0.iter().map(|y| (y - start).powi(2)).sum::<f32>();
        ways.push(1e3 * (away / body.0.len() as f32).sqrt());
        energies
            .push(MASS * (GRAVITY * (at.translation.y - start) + 0.5 * velocity.linear.y.powi(2)));
    }
    let mut out = vec![
        Finding::between("passive body: root mean square", ways[0], 15.0, 60.0, "mm"),
        Finding::between("active body", ways[1], 0.0, 0.3 * ways[0], "mm"),
    ];
    let mut skyhooks = world.query::<&Skyhook>();
    let actuator = skyhooks.iter(world).map(|s| s.0).sum::<f32>();
    let stored = 0.5 * (MASS * GRAVITY).powi(2) / STIFFNESS;
    for ((name, track), energy) in ["passive", "active"]
        .iter()
        .zip(tracks(world))
        .zip(energies)
    {
        let seen = track.last();
        out.push(Finding::between(
            &format!("{name}: work of wheel and actuator"),
            seen.work,
            1.0,
            1e4,
            "J",
        ));
        out.push(Finding::close(
            "  turned to heat, stored and in the body",
            seen.dissipated_energy + seen.stored_energy - stored + energy,
            seen.work,
            "J",
            0.01,
        ));
    }
    out.push(Finding::between(
        "the actuator's share of it: a damper's",
        actuator,
        -1e3,
        -10.0,
        "J",
    ));
    out
}
