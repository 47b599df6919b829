//! A car on four coilovers, with wheels that are bodies on the ground. It drives over bumps, left and right in turn,
//! brakes, and comes to rest at the ride height of statics.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{
    Begin, DT, Finding, Paint, PictureAt, Shape, Stage, Track, Upright, larger, smaller, tracks,
};
use std::f32::consts::TAU;

const CHASSIS: f32 = 1_200.0;
const WHEEL: f32 = 20.0;
const RADIUS: f32 = 0.32;
const STIFFNESS: f32 = 30e3;
const DAMPING: f32 = 3e3;
/// Length of a coilover without load, m.
const REST: f32 = 0.76;
/// Height of the coilovers' upper ends above the middle of the chassis, m.
const TOWER: f32 = 0.24;
const GRAVITY: f32 = 9.81;
/// Speed of the car, m/s.
const SPEED: f32 = 3.0;
/// Position along x at the start, m.
const START: f32 = -5.4;
/// Time at which the car brakes, s.
const BRAKE: f32 = 2.1;
/// Torque of the engine on each wheel per rad/s of speed error, N m s.
const GRIP: f32 = 80.0;
/// Torque of the brakes on each wheel per rad/s, N m s.
const BRAKES: f32 = 250.0;
/// Height of the bumps above the ground, m.
const BUMP: f32 = 0.09;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "suspension",
        setup: |app| {
            app.insert_resource(PictureAt(1.36))
                .add_systems(Begin, (stage::fresh::<Ride>, road, car))
                .add_systems(FixedUpdate, brake.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, record.after(CoiloverSystems::Readout));
        },
        seconds: 8.0,
        again: 9.0,
        check,
        eye: Vec3::new(2.4, 1.75, 6.0),
        target: Vec3::new(-0.5, 0.5, 0.0),
    })
}

/// Measurements.
#[derive(Resource, Default)]
struct Ride {
    /// Largest angle between the car's up axis and the world's, rad.
    lean: f32,
    /// Greatest speed of chassis and wheels in the last tick, m/s.
    fastest: f32,
}

#[derive(Component)]
struct Chassis;

#[derive(Component)]
struct Wheel;

fn road(mut commands: Commands) {
    commands.spawn(stage::floor()).insert((
        Collider::cuboid(20.0, 0.05, 20.0),
        Friction::coefficient(1.0),
    ));
    // Nearly buried round bars. Each meets one wheel of each axle.
    for (i, x) in [-3.2, -2.2, -1.2, -0.2].into_iter().enumerate() {
        let z = if i % 2 == 0 { 0.85 } else { -0.85 };
        let (radius, half) = (0.4, 0.45);
        commands.spawn((
            Collider::cylinder(half, radius),
            Friction::coefficient(1.0),
            Transform::from_xyz(x, BUMP - radius, z)
                .with_rotation(Quat::from_rotation_x(TAU / 4.0)),
            Shape::Cylinder(radius, 2.0 * half, Paint::Ivory),
        ));
    }
}

fn car(mut commands: Commands) {
    let height = RADIUS + REST - TOWER - CHASSIS * GRAVITY / (4.0 * STIFFNESS);
    let hull = Vec3::new(3.4, 0.4, 0.9);
    let chassis = commands
        .spawn((
            RigidBody::Dynamic,
            Collider::cuboid(0.5 * hull.x, 0.5 * hull.y, 0.5 * hull.z),
            ColliderMassProperties::Mass(CHASSIS),
            Velocity::linear(Vec3::X * SPEED),
            Transform::from_xyz(START, height, 0.0),
            Shape::Cuboid(hull, Paint::Blue),
            Chassis,
            Upright(0.2),
            children![(
                Transform::from_xyz(-0.35, 0.35, 0.0),
                Shape::Cuboid(Vec3::new(1.3, 0.3, 0.8), Paint::Ivory),
            )],
        ))
        .id();
    for (x, z) in [(-1.25, -0.85), (1.25, -0.85), (-1.25, 0.85), (1.25, 0.85)] {
        // The wheel moves up and down along the chassis and turns about its axle.
        let guide = GenericJointBuilder::new(
            JointAxesMask::LIN_X
                | JointAxesMask::LIN_Z
                | JointAxesMask::ANG_X
                | JointAxesMask::ANG_Y,
        )
        .local_anchor1(Vec3::new(x, 0.0, z))
        .motor_model(JointAxis::AngZ, MotorModel::ForceBased)
        .motor_velocity(JointAxis::AngZ, -SPEED / RADIUS, GRIP);
        let upright = Quat::from_rotation_x(TAU / 4.0);
        let wheel = commands
            .spawn((
                RigidBody::Dynamic,
                // A ball rolls as a wheel does. The contacts of a cylinder let even a parked car creep sideways.
                Collider::ball(RADIUS),
                ColliderMassProperties::Mass(WHEEL),
                Friction::coefficient(1.0),
                Velocity {
                    linear: Vec3::X * SPEED,
                    angular: Vec3::NEG_Z * SPEED / RADIUS,
                },
                Transform::from_xyz(START + x, RADIUS, z),
                Visibility::default(),
                ImpulseJoint::new(chassis, TypedJoint::GenericJoint(guide.build())),
                Wheel,
                children![
                    (
                        Transform::from_rotation(upright),
                        Shape::Cylinder(RADIUS, 0.2, Paint::Iron),
                    ),
                    (
                        Transform::from_rotation(upright),
                        Shape::Cylinder(0.55 * RADIUS, 0.22, Paint::Ivory),
                    ),
                ],
            ))
            .id();
        // The coilover stands on the axle, inside the wheel, and reaches up to an arm of the chassis.
        let inside = 0.2 * z.signum();
        commands.entity(chassis).with_child((
            Transform::from_xyz(x, TOWER + 0.03, 0.55 * z.signum()),
            Shape::Cuboid(Vec3::new(0.24, 0.06, 0.5), Paint::Iron),
        ));
        commands.spawn(coilover(wheel, chassis)).insert((
            SpringDamper::new(wheel, chassis)
                .with_stiffness(STIFFNESS)
                .with_damping(DAMPING)
                .with_rest_length(REST),
            Anchors::new(Vec3::NEG_Z * inside, Vec3::new(x, TOWER, z - inside)),
            Coil::new(0.085, 0.013, 8.0),
            Telescope::new(0.035, 0.014).with_stroke(0.3),
            Track::default(),
        ));
    }
}

/// Brakes: the motors that drove the wheels now hold them against the chassis.
fn brake(time: Res<Time>, mut wheels: Query<&mut ImpulseJoint>) {
    if stage::tick(&time) == (BRAKE / DT) as u32 {
        for mut wheel in &mut wheels {
            let joint: &mut GenericJoint = wheel.data.as_mut();
            joint.set_motor_velocity(JointAxis::AngZ, 0.0, BRAKES);
        }
    }
}

fn record(
    mut ride: ResMut<Ride>,
    chassis: Query<&Transform, With<Chassis>>,
    moving: Query<&Velocity, Or<(With<Chassis>, With<Wheel>)>>,
) {
    for transform in &chassis {
        ride.lean = ride.lean.max(transform.up().angle_between(Vec3::Y));
    }
    ride.fastest = moving.iter().map(|v| v.linear.length()).fold(0.0, larger);
}

fn check(world: &mut World) -> Vec<Finding> {
    let mut cars = world.query_filtered::<&Transform, With<Chassis>>();
    let Some(at) = cars.iter(world).next().copied() else {
        return vec![Finding::small("cars lost", 1.0, 0.5, "")];
    };
    let ride = world.resource::<Ride>();
    let (lean, fastest) = (ride.lean.to_degrees(), ride.fastest);
    let mut out = vec![
        Finding::between("largest lean on the bumps", lean, 0.5, 8.0, "degrees"),
        Finding::small(
            "lean in the end",
            at.up().angle_between(Vec3::Y),
            1e-3,
            "rad",
        ),
        Finding::small("speed in the end", fastest, 1e-3, "m/s"),
        Finding::between("driven", at.translation.x - START, 6.0, 12.0, "m"),
    ];
    let sag = CHASSIS * GRAVITY / (4.0 * STIFFNESS);
    for track in tracks(world) {
        let lengths = track.0.iter().map(|(_, readout)| readout.length);
        let shortest = lengths.fold(f32::MAX, smaller);
        out.push(Finding::between(
            "shortest coilover",
            shortest,
            0.45,
            0.65,
            "m",
        ));
        out.push(Finding::close(
            "  sag at rest",
            REST - track.last().length,
            sag,
            "m",
            0.01,
        ));
    }
    let ride = REST - sag + RADIUS - TOWER;
    out.push(Finding::close(
        "ride height",
        at.translation.y,
        ride,
        "m",
        0.01,
    ));
    out
}
