//! A body that hangs on a coilover, a spinning pair, and a four-post rig.
//!
//! Opens a window where there is a display. Otherwise renders frames to PNG where there is a Vulkan adapter.
//! Otherwise prints the read-outs. `--headless`, `--screenshot FILE` and `--frames FOLDER` choose one of these.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, Finding, Paint, Shape, Stage, Track, Upright, tracks};
use std::f32::consts::TAU;

const GRAVITY: f32 = 9.81;

/// Mass (kg), stiffness (N/m) and damping (N s/m) of the hanging body.
const MASS: f32 = 12.0;
const STIFFNESS: f32 = 900.0;
const DAMPING: f32 = 6.0;

/// Mass (kg), stiffness (N/m) and damping (N s/m) of the car body on four posts.
const CAR: f32 = 60.0;
const CAR_STIFFNESS: f32 = 2_400.0;
const CAR_DAMPING: f32 = 140.0;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "showcase",
        setup: |app| {
            app.add_systems(Begin, (stage::fresh::<Trace>, hang, spin, rig))
                .add_systems(FixedUpdate, move_posts.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, record.after(CoiloverSystems::Readout));
        },
        seconds: 10.0,
        again: 30.0,
        check,
        eye: Vec3::new(1.4, 2.5, 8.3),
        target: Vec3::new(0.25, 1.42, 0.0),
    })
}

/// Measurements.
#[derive(Resource, Default)]
struct Trace {
    /// Angular momentum of the spinning pair about its centre, first and last, kg m²/s.
    spin: Option<(Vec3, Vec3)>,
    /// Least and greatest energy of the pair, J.
    energy: Option<(f32, f32)>,
    /// Compression of the rig's coilovers while the posts rest, m.
    sag: Option<f32>,
}

#[derive(Component)]
struct Spinner(Vec3);

#[derive(Component)]
struct PairSpring;

#[derive(Component)]
struct Post(usize);

#[derive(Component)]
struct Corner;

fn hang(mut commands: Commands) {
    let beam = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_xyz(-2.4, 2.9, 0.0),
            Shape::Cuboid(Vec3::new(1.3, 0.14, 0.5), Paint::Iron),
        ))
        .id();
    // Released 0.25 m above the position at rest.
    let hanging = 1.1 + MASS * GRAVITY / STIFFNESS - 0.25;
    let weight = commands
        .spawn((
            RigidBody::Dynamic,
            Collider::cuboid(0.3, 0.22, 0.3),
            ColliderMassProperties::Mass(MASS),
            Transform::from_xyz(-2.4, 2.83 - hanging - 0.22, 0.0),
            Shape::Cuboid(Vec3::new(0.6, 0.44, 0.6), Paint::Blue),
            Upright(0.1),
        ))
        .id();
    commands.spawn(coilover(beam, weight)).insert((
        SpringDamper::new(beam, weight)
            .with_stiffness(STIFFNESS)
            .with_damping(DAMPING)
            .with_rest_length(1.1),
        Anchors::new(Vec3::NEG_Y * 0.07, Vec3::Y * 0.22),
        Track::default(),
        Telescope::default().with_fittings(),
    ));
}

fn spin(mut commands: Commands) {
    let mut brick = |at: Vec3, size: Vec3, velocity: Velocity, paint| {
        let mass = 900.0 * size.x * size.y * size.z;
        let square = size * size;
        let inertia = mass / 12.0
            * Vec3::new(
                square.y + square.z,
                square.x + square.z,
                square.x + square.y,
            );
        commands
            .spawn((
                RigidBody::Dynamic,
                AdditionalMassProperties::MassProperties(MassProperties {
                    mass,
                    principal_inertia: inertia,
                    ..default()
                }),
                GravityScale(0.0),
                velocity,
                Transform::from_translation(at),
                Shape::Cuboid(size, paint),
                Spinner(inertia),
            ))
            .id()
    };
    let turn = Vec3::new(0.2, 0.3, 1.4);
    let center = Vec3::new(-0.15, 1.75, 0.0);
    let arm = Vec3::X * 0.75;
    let mass = [0.4 * 0.3 * 0.2, 0.3 * 0.4 * 0.2];
    let share = mass[1] / (mass[0] + mass[1]);
    let ends = [-arm * 2.0 * share, arm * 2.0 * (1.0 - share)];
    let a = brick(
        center + ends[0],
        Vec3::new(0.4, 0.3, 0.2),
        Velocity {
            linear: turn.cross(ends[0]),
            angular: turn,
        },
        Paint::Ivory,
    );
    let b = brick(
        center + ends[1],
        Vec3::new(0.3, 0.4, 0.2),
        Velocity {
            linear: turn.cross(ends[1]),
            angular: turn,
        },
        Paint::Ivory,
    );
    commands.spawn((
        Spring::new(a, b)
            .with_stiffness(260.0)
            .with_rest_length(0.95),
        Anchors::new(Vec3::new(0.2, 0.08, 0.0), Vec3::new(-0.15, -0.12, 0.0)),
        Coil::new(0.09, 0.012, 9.0).with_color(Color::srgb(0.85, 0.62, 0.10)),
        PairSpring,
    ));
}

fn rig(mut commands: Commands) {
    let center = Vec3::new(2.5, 0.0, 0.0);
    commands.spawn(stage::floor());
    let car = commands
        .spawn((
            RigidBody::Dynamic,
            Collider::cuboid(0.8, 0.16, 0.5),
            ColliderMassProperties::Mass(CAR),
            Transform::from_translation(center + Vec3::Y * 1.23),
            Shape::Cuboid(Vec3::new(1.6, 0.32, 1.0), Paint::Blue),
            Upright(0.3),
        ))
        .id();
    // Four coilovers on ball joints carry a car but do not guide it. It slides up and down, pitches and rolls on a
    // column in the middle. The column also holds the heading: locking only the rotation about the vertical lets the
    // heading change with every cycle of pitch and roll.
    let guide = GenericJointBuilder::new(
        JointAxesMask::LIN_X | JointAxesMask::LIN_Z | JointAxesMask::ANG_Y,
    )
    .limits(JointAxis::AngX, [-0.25, 0.25])
    .limits(JointAxis::AngZ, [-0.25, 0.25]);
    let column = commands
        .spawn((
            RigidBody::Fixed,
            Transform::from_translation(center + Vec3::Y * 0.6),
            Shape::Cylinder(0.06, 1.2, Paint::Ivory),
        ))
        .id();
    commands.entity(car).insert(ImpulseJoint::new(
        column,
        TypedJoint::GenericJoint(guide.build()),
    ));
    for (i, (x, z)) in [(-0.7, -0.42), (0.7, -0.42), (-0.7, 0.42), (0.7, 0.42)]
        .into_iter()
        .enumerate()
    {
        let post = commands
            .spawn((
                RigidBody::KinematicPositionBased,
                Transform::from_translation(center + Vec3::new(x, 0.2, z)),
                Shape::Cylinder(0.16, 0.4, Paint::Iron),
                Post(i),
            ))
            .id();
        commands.spawn(coilover(post, car)).insert((
            SpringDamper::new(post, car)
                .with_stiffness(CAR_STIFFNESS)
                .with_damping(CAR_DAMPING)
                .with_rest_length(0.7),
            Anchors::new(Vec3::Y * 0.2, Vec3::new(x, -0.16, z)),
            Coil::new(0.1, 0.013, 7.0),
            Telescope {
                tube_radius: 0.05,
                rod_radius: 0.02,
                ..default()
            },
            Corner,
        ));
    }
}

/// The posts rest for five seconds, then shake the car.
fn move_posts(time: Res<Time>, mut posts: Query<(&Post, &mut Transform)>) {
    let t = time.elapsed_secs() - 5.0;
    if t < 0.0 {
        return;
    }
    for (post, mut transform) in &mut posts {
        let phase = [0.0, 1.4, 2.6, 4.0][post.0];
        let lift = 0.5 * (1.0 - (t * 2.0).min(1.0).cos()) * 2.0;
        transform.translation.y = 0.2 + 0.07 * lift * ((TAU * 0.9 * t + phase).sin() - phase.sin());
    }
}

fn record(
    time: Res<Time>,
    mut trace: ResMut<Trace>,
    corners: Query<(&SpringReadout, &SpringDamper), With<Corner>>,
    bodies: Query<(&Spinner, &AdditionalMassProperties, &Transform, &Velocity)>,
    pair: Query<&SpringReadout, With<PairSpring>>,
) {
    let t = time.elapsed_secs();
    if (4.9..5.0).contains(&t) {
        let short = corners
            .iter()
            .map(|(r, s)| s.rest_length.unwrap_or(0.0) - r.length);
        trace.sag = Some(short.sum::<f32>() / 4.0);
    }
    let (mut momentum, mut energy) = (Vec3::ZERO, 0.0);
    for (Spinner(inertia), mass, at, v) in &bodies {
        let AdditionalMassProperties::MassProperties(mass) = mass else {
            continue;
        };
        let own = at.rotation.inverse() * v.angular;
        momentum += at.translation.cross(mass.mass * v.linear) + at.rotation * (*inertia * own);
        energy += 0.5 * (mass.mass * v.linear.length_squared() + own.dot(*inertia * own));
    }
    energy += pair.iter().map(|r| r.stored_energy).sum::<f32>();
    let first = trace.spin.map_or(momentum, |(first, _)| first);
    trace.spin = Some((first, momentum));
    let (least, most) = trace.energy.unwrap_or((energy, energy));
    trace.energy = Some((least.min(energy), most.max(energy)));
}

fn check(world: &mut World) -> Vec<Finding> {
    let rest = 1.1 + MASS * GRAVITY / STIFFNESS;
    let decay = DAMPING / (2.0 * MASS);
    let theory = (STIFFNESS / MASS - decay * decay).sqrt() / TAU;
    let measured = tracks(world)[0].frequency(rest);
    let mut out = vec![Finding::close("hanging body", measured, theory, "Hz", 1e-3)];

    let trace = world.resource::<Trace>();
    if let (Some((first, last)), Some((least, most))) = (trace.spin, trace.energy) {
        let drift = (last - first).length() / first.length();
        let what = "spinning pair, angular momentum: drift";
        out.push(Finding::small(what, drift, 1e-3, "of it"));
        let span = (most - least) / most;
        out.push(Finding::small("its energy: range", span, 1e-2, "of it"));
    }
    let sag = trace.sag.unwrap_or(f32::NAN);
    let theory = CAR * GRAVITY / (4.0 * CAR_STIFFNESS);
    out.push(Finding::close("four-post rig, sag", sag, theory, "m", 1e-3));
    out
}
