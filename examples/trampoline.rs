//! A trampoline: a cloth of 16 × 16 points and 420 springs in a frame. Balls fall onto it. No ball falls through, no
//! ball rises above its start, and at the end the frame carries the weight of cloth and balls.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, DT, Finding, Paint, PictureAt, Shape, Stage, smaller};

/// Number of points along an edge. The outermost points are fixed to the frame.
const SIDE: usize = 16;
/// Distance between neighbouring points, m.
const PITCH: f32 = 0.2;
/// Mass of a point, kg.
const MASS: f32 = 0.05;
/// Stiffness of a spring, N/m.
const STIFFNESS: f32 = 300.0;
/// Damping of a spring, N s/m.
const DAMPING: f32 = 2.0;
/// Rest length of a spring, m. It is shorter than `PITCH`, so all springs are in tension.
const REST: f32 = 0.1;
/// Height of the cloth above the ground, m.
const HEIGHT: f32 = 1.1;
/// Radius (m), mass (kg), position (m) and fall height (m) of each ball.
const BALLS: [(f32, f32, Vec2, f32); 3] = [
    (0.36, 3.0, Vec2::new(-0.65, -0.2), 1.0),
    (0.28, 1.5, Vec2::new(0.5, -0.5), 1.3),
    (0.32, 2.0, Vec2::new(0.4, 0.55), 0.7),
];
/// Time at which the balls are released, s.
const DROP: f32 = 2.0;
const SECONDS: f32 = 9.0;
const GRAVITY: f32 = 9.81;

fn main() -> AppExit {
    stage::run(&Stage {
        title: "trampoline",
        setup: |app| {
            app.insert_resource(PictureAt(DROP + 0.78))
                .add_systems(Begin, (stage::fresh::<Seen>, setup))
                .add_systems(FixedUpdate, drop.before(PhysicsSet::SyncBackend))
                .add_systems(FixedUpdate, record.after(CoiloverSystems::Readout));
        },
        seconds: SECONDS,
        again: 12.0,
        check,
        eye: Vec3::new(0.9, 2.7, 6.0),
        target: Vec3::new(0.0, 1.2, 0.0),
    })
}

/// A point of the cloth that can move.
#[derive(Component)]
struct Knot;

/// A ball and the height it falls from.
#[derive(Component)]
struct Ball(f32);

/// Measurements.
#[derive(Resource, Default)]
struct Seen {
    /// Sag of the cloth's middle before the balls fall, m.
    sag: f32,
    /// Energy when the balls are released, and the largest since, J.
    energy: Option<(f32, f32)>,
    /// Greatest height of any ball above its start since then, m.
    rise: f32,
    /// Lowest height of a ball relative to the frame, m.
    lowest: f32,
    /// Vertical force of the springs at the frame, N: mean over the last second.
    carried: f32,
}

fn setup(mut commands: Commands) {
    commands.spawn(stage::floor());
    let middle = 0.5 * (SIDE - 1) as f32;
    let reach = PITCH * middle;
    for side in [-1.0, 1.0] {
        let long = 2.0 * reach + 0.16;
        commands.spawn((
            Transform::from_xyz(0.0, HEIGHT, side * (reach + 0.04)),
            Shape::Cuboid(Vec3::new(long, 0.08, 0.08), Paint::Blue),
        ));
        commands.spawn((
            Transform::from_xyz(side * (reach + 0.04), HEIGHT, 0.0),
            Shape::Cuboid(Vec3::new(0.08, 0.08, long), Paint::Blue),
        ));
        for other in [-1.0, 1.0] {
            commands.spawn((
                Transform::from_xyz(side * reach, 0.5 * HEIGHT, other * reach),
                Shape::Cylinder(0.04, HEIGHT, Paint::Iron),
            ));
        }
    }
    let at = |i: usize| {
        let (x, z) = ((i % SIDE) as f32 - middle, (i / SIDE) as f32 - middle);
        Vec3::new(PITCH * x, HEIGHT, PITCH * z)
    };
    let rim = |i: usize| {
        let (x, z) = (i % SIDE, i / SIDE);
        x == 0 || z == 0 || x == SIDE - 1 || z == SIDE - 1
    };
    let points: Vec<Entity> = (0..SIDE * SIDE)
        .map(|i| {
            // The cloth starts near its shape at rest.
            let bow = |x: f32| (std::f32::consts::FRAC_PI_2 * x / reach).cos();
            let low = sag() * bow(at(i).x) * bow(at(i).z);
            let point = Transform::from_translation(at(i) - low * Vec3::Y);
            if rim(i) {
                return commands.spawn(point).id();
            }
            let body = (
                RigidBody::Dynamic,
                Collider::ball(0.05),
                ColliderMassProperties::Mass(MASS),
                CollisionGroups::new(Group::GROUP_1, Group::GROUP_2),
                LockedAxes::ROTATION_LOCKED,
                // Drag of the air that the cloth moves.
                Damping {
                    linear_damping: 2.0,
                    ..default()
                },
                Velocity::default(),
                Shape::Ball(0.022, Paint::Iron),
            );
            commands.spawn((body, point, Knot)).id()
        })
        .collect();
    for i in 0..points.len() {
        let neighbours = [
            (i % SIDE + 1 < SIDE, i + 1),
            (i / SIDE + 1 < SIDE, i + SIDE),
        ];
        for (_, j) in neighbours.into_iter().filter(|n| n.0) {
            if !(rim(i) && rim(j)) {
                commands.spawn((
                    SpringDamper::new(points[i], points[j])
                        .with_stiffness(STIFFNESS)
                        .with_damping(DAMPING)
                        .with_rest_length(REST),
                    Coil::new(0.026, 0.006, 5.0),
                ));
            }
        }
    }
    for (radius, mass, at, fall) in BALLS {
        let height = HEIGHT + radius + fall;
        commands.spawn((
            RigidBody::Fixed,
            Collider::ball(radius),
            ColliderMassProperties::Mass(mass),
            CollisionGroups::new(Group::GROUP_2, Group::ALL),
            Velocity::default(),
            Transform::from_xyz(at.x, height, at.y),
            Shape::Ball(radius, Paint::Ivory),
            Ball(height),
        ));
    }
}

fn drop(time: Res<Time>, mut balls: Query<&mut RigidBody, With<Ball>>) {
    if time.elapsed_secs() > DROP {
        for mut body in &mut balls {
            body.set_if_neq(RigidBody::Dynamic);
        }
    }
}

fn record(
    time: Res<Time>,
    mut seen: ResMut<Seen>,
    knots: Query<(&Transform, &Velocity), With<Knot>>,
    balls: Query<(&Transform, &Velocity, &ColliderMassProperties, &Ball)>,
    springs: Query<(&SpringDamper, &SpringReadout)>,
    places: Query<&GlobalTransform>,
) {
    let t = time.elapsed_secs();
    if t < DROP {
        let lowest = knots.iter().map(|(at, _)| at.translation.y);
        let sag = HEIGHT - lowest.fold(HEIGHT, smaller);
        // Mean over the last second before the release.
        if t > DROP - 1.0 - 0.5 * DT {
            seen.sag += DT * sag;
        }
        return;
    }
    let energy = |mass: f32, at: &Transform, v: &Velocity| {
        mass * (GRAVITY * at.translation.y + 0.5 * v.linear.length_squared())
    };
    let mut sum: f32 = knots.iter().map(|(at, v)| energy(MASS, at, v)).sum();
    for (at, v, mass, ball) in &balls {
        if let ColliderMassProperties::Mass(mass) = mass {
            sum += energy(*mass, at, v);
        }
        seen.rise = seen.rise.max(at.translation.y - ball.0);
        seen.lowest = seen.lowest.min(at.translation.y - HEIGHT);
    }
    sum += springs.iter().map(|(_, r)| r.stored_energy).sum::<f32>();
    let (first, most) = seen.energy.unwrap_or((sum, sum));
    seen.energy = Some((first, most.max(sum)));
    if t > SECONDS - 1.0 + 0.5 * DT {
        for (spring, readout) in &springs {
            let held = [
                (spring.body_a, spring.body_b),
                (spring.body_b, spring.body_a),
            ];
            for (rim, knot) in held {
                if let (false, Ok(from), Ok(to)) =
                    (knots.contains(rim), places.get(rim), places.get(knot))
                {
                    let down = (from.translation() - to.translation()).y / readout.length;
                    seen.carried += DT * readout.force() * down;
                }
            }
        }
    }
}

/// Returns the sag of the middle of a square membrane under its own weight, m, for small sag.
fn sag() -> f32 {
    let tension = STIFFNESS * (PITCH - REST) / PITCH;
    let weight = MASS * GRAVITY / (PITCH * PITCH);
    let length = PITCH * (SIDE - 1) as f32;
    0.0737 * weight * length * length / tension
}

fn check(world: &mut World) -> Vec<Finding> {
    let seen = world.resource::<Seen>();
    let (first, most) = seen.energy.unwrap_or((f32::NAN, f32::NAN));
    let fallen: f32 = BALLS
        .iter()
        .map(|(_, mass, _, fall)| mass * GRAVITY * fall)
        .sum();
    let knots = (SIDE - 2) * (SIDE - 2);
    let weight = BALLS.iter().map(|ball| ball.1).sum::<f32>() + MASS * knots as f32;
    vec![
        Finding::close("sag of the cloth alone", seen.sag, sag(), "m", 0.03),
        Finding::small(
            "energy above the first",
            (most - first) / fallen,
            0.05,
            "of the falls'",
        ),
        Finding::small("rise of a ball above its first place", seen.rise, 1e-3, "m"),
        Finding::between("lowest ball, from the frame", seen.lowest, -0.5, -0.05, "m"),
        Finding::close(
            "carried by the frame",
            seen.carried,
            weight * GRAVITY,
            "N",
            0.02,
        ),
    ]
}
