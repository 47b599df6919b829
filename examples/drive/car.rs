//! The car: a chassis with a wheel at each corner. Each wheel is on an arm hinged to the chassis: a leading arm in
//! front, a trailing arm behind. The coilover stands on the hub. Both arms of an axle turn about the same line, so a
//! torsion spring between them acts as an anti-roll bar fixed to both: it twists when one wheel is higher than the
//! other.

use super::tyre::Tyre;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Paint, Shape};
use std::f32::consts::TAU;

/// Mass of the chassis, kg.
pub const CHASSIS: f32 = 1_200.0;
/// Mass of a wheel with its arm, kg.
pub const WHEEL: f32 = 30.0;
/// m/s²
pub const GRAVITY: f32 = 9.81;
/// Radius of a wheel, m.
pub const RADIUS: f32 = 0.33;
/// Height of the chassis' centre of mass above the road, m.
pub const HEIGHT: f32 = 0.55;
/// Half the wheelbase, m.
pub const HALF_BASE: f32 = 1.3;
/// Half the track width, m.
pub const HALF_TRACK: f32 = 0.78;
/// Length of an arm, m.
pub const ARM: f32 = 0.6;
/// Moments of inertia of the chassis about x, y and z, kg m²: those of a saloon of this size.
const INERTIA: Vec3 = Vec3::new(450.0, 1_600.0, 1_500.0);
/// Stiffness of a coilover, N/m: the chassis bounces at 1.7 Hz.
pub const STIFFNESS: f32 = 35e3;
/// Damping while a coilover shortens, N s/m: 0.34 of critical.
pub const BUMP: f32 = 2_200.0;
/// Damping while a coilover lengthens, N s/m: 0.59 of critical.
pub const REBOUND: f32 = 3_800.0;
/// Length of a coilover at ride height, m.
pub const LENGTH: f32 = 0.5;
/// Travel of a wheel from ride height up and down to its stops, m.
const TRAVEL: [f32; 2] = [0.10, 0.09];
/// Stiffness of the stops, N/m. After a drop of 2 m the chassis stops 5 cm above the road.
const STOP: f32 = 150e3;
/// Progression of the stops, 1/m.
const PROGRESSION: f32 = 10.0;
/// Damping of the stops, N s/m.
const STOP_DAMPING: f32 = 1_500.0;
/// Stiffness of the front and the rear anti-roll bar, N m/rad: a third of the roll stiffness of the coilovers.
pub const BARS: [f32; 2] = [2_800.0, 1_400.0];
/// Lateral distance of a coilover from the middle of the car, m.
const COILOVER: f32 = 0.56;

const CAR: CollisionGroups = CollisionGroups::new(Group::GROUP_2, Group::GROUP_1);

#[derive(Component)]
pub struct Chassis;

/// On a coilover: the wheel it stands on.
#[derive(Component)]
pub struct StandsOn(pub Entity);

/// On a visible part: the wheel it turns with.
#[derive(Component)]
pub struct Spinning(Entity);

/// Returns the positions of the wheels on the chassis: front left, front right, rear left, rear right.
pub fn corners() -> [Vec3; 4] {
    [(1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)]
        .map(|(x, z)| Vec3::new(x * HALF_BASE, RADIUS - HEIGHT, z * HALF_TRACK))
}

pub fn spawn(mut commands: Commands) {
    let rapier = stage::given("--rapier");
    let chassis = commands.spawn(chassis()).id();
    body_work(&mut commands, chassis);
    let wheels = corners().map(|corner| {
        let wheel = commands.spawn(wheel(chassis, corner)).id();
        wheel_looks(&mut commands, wheel, corner);
        if rapier {
            rapier_spring(&mut commands, chassis, wheel, corner);
        } else {
            our_spring(&mut commands, chassis, wheel, corner);
        }
        wheel
    });
    for (stiffness, pair) in BARS.into_iter().zip(wheels.chunks(2)) {
        if rapier {
            rapier_bar(&mut commands, pair, stiffness);
        } else {
            let bar = TorsionSpring::new(pair[0], pair[1], Vec3::Z);
            commands.spawn(bar.with_stiffness(stiffness).with_rest_angle(0.0));
        }
    }
}

fn chassis() -> impl Bundle {
    (
        RigidBody::Dynamic,
        Collider::cuboid(1.75, 0.17, 0.38),
        ColliderMassProperties::Mass(0.0),
        AdditionalMassProperties::MassProperties(MassProperties {
            mass: CHASSIS,
            principal_inertia: INERTIA,
            ..default()
        }),
        Friction::coefficient(0.3),
        CAR,
        Velocity::default(),
        ExternalForce::default(),
        // Kept awake, so that the driver's forces need not wake it.
        Sleeping::disabled(),
        Transform::from_xyz(0.0, HEIGHT, 0.0),
        Visibility::default(),
        Chassis,
    )
}

fn body_work(commands: &mut Commands, chassis: Entity) {
    let box_at = |x, y, z, size, paint| (Transform::from_xyz(x, y, z), Shape::Cuboid(size, paint));
    let v = Vec3::new;
    commands.entity(chassis).with_children(|parts| {
        // Tub, nose, cabin, spoiler.
        parts.spawn(box_at(-0.1, -0.01, 0.0, v(2.9, 0.32, 0.76), Paint::Blue));
        parts.spawn(box_at(1.55, -0.05, 0.0, v(0.5, 0.2, 0.6), Paint::Blue));
        parts.spawn(box_at(-0.35, 0.26, 0.0, v(1.0, 0.24, 0.66), Paint::Ivory));
        parts.spawn(box_at(-0.35, 0.4, 0.0, v(1.1, 0.05, 0.72), Paint::Blue));
        parts.spawn(box_at(-1.6, 0.36, 0.0, v(0.3, 0.035, 1.1), Paint::Iron));
        for z in [-0.3, 0.3] {
            parts.spawn(box_at(-1.6, 0.24, z, v(0.2, 0.24, 0.03), Paint::Iron));
        }
        for (i, x) in [HALF_BASE, -HALF_BASE].into_iter().enumerate() {
            // The cross member that the coilovers hang from, and the hinges with the bar.
            let y = RADIUS - HEIGHT + LENGTH;
            parts.spawn(box_at(x, y + 0.03, 0.0, v(0.16, 0.06, 1.26), Paint::Iron));
            parts.spawn(box_at(x, 0.2, 0.0, v(0.1, 0.2, 0.6), Paint::Iron));
            let along_z = Quat::from_rotation_x(TAU / 4.0);
            let pivot = v((HALF_BASE - ARM) * x.signum(), RADIUS - HEIGHT, 0.0);
            parts.spawn((
                Transform::from_translation(pivot).with_rotation(along_z),
                Shape::Cylinder(if i == 0 { 0.035 } else { 0.028 }, 1.3, Paint::Red),
            ));
        }
    });
}

/// A hub with its arm. Only the ball touches the road. The ball does not turn and has no friction: the forces along
/// the road come from [`Tyre`].
fn wheel(chassis: Entity, corner: Vec3) -> impl Bundle {
    let forward = corner.x.signum();
    let hinge = RevoluteJointBuilder::new(Vec3::Z)
        .local_anchor1(corner - Vec3::X * ARM * forward)
        .local_anchor2(-Vec3::X * ARM * forward)
        .build();
    (
        RigidBody::Dynamic,
        Collider::ball(RADIUS),
        ColliderMassProperties::Mass(WHEEL),
        Friction {
            coefficient: 0.0,
            combine_rule: CoefficientCombineRule::Max,
        },
        CAR,
        Velocity::default(),
        ExternalForce::default(),
        Sleeping::disabled(),
        Transform::from_translation(corner + Vec3::Y * HEIGHT),
        Visibility::default(),
        ImpulseJoint::new(chassis, TypedJoint::RevoluteJoint(hinge)),
        Tyre::new(corner),
    )
}

fn wheel_looks(commands: &mut Commands, wheel: Entity, corner: Vec3) {
    let (forward, side) = (corner.x.signum(), corner.z.signum());
    let along_z = Quat::from_rotation_x(TAU / 4.0);
    commands.entity(wheel).with_children(|parts| {
        parts.spawn((
            Transform::from_xyz(-0.5 * ARM * forward, 0.0, -0.3 * side),
            Shape::Cuboid(Vec3::new(ARM, 0.07, 0.05), Paint::Iron),
        ));
        // The axle that the coilover stands on.
        parts.spawn((
            Transform::from_xyz(0.0, 0.0, -0.18 * side).with_rotation(along_z),
            Shape::Cylinder(0.045, 0.3, Paint::Iron),
        ));
        let mut turning =
            parts.spawn((Transform::default(), Visibility::default(), Spinning(wheel)));
        turning.with_children(|parts| {
            parts.spawn((
                Transform::from_rotation(along_z),
                Shape::Cylinder(RADIUS, 0.22, Paint::Iron),
            ));
            parts.spawn((
                Transform::from_rotation(along_z),
                Shape::Cylinder(0.62 * RADIUS, 0.225, Paint::Ivory),
            ));
            // Spokes make the rotation visible.
            for i in 0..3 {
                parts.spawn((
                    Transform::from_rotation(Quat::from_rotation_z(TAU / 6.0 * i as f32)),
                    Shape::Cuboid(Vec3::new(1.1 * RADIUS, 0.05, 0.235), Paint::Iron),
                ));
            }
        });
    });
}

/// Returns the anchors of a coilover: on the chassis, and on the wheel.
pub fn ends(corner: Vec3) -> [Vec3; 2] {
    let inside = Vec3::Z * (COILOVER - HALF_TRACK) * corner.z.signum();
    [corner + inside + Vec3::Y * LENGTH, inside]
}

fn our_spring(commands: &mut Commands, chassis: Entity, wheel: Entity, corner: Vec3) {
    let [a, b] = ends(corner);
    commands.spawn((
        Coilover::new(chassis, wheel)
            .with_stiffness(STIFFNESS)
            .with_anchors(a, b)
            .with_coil(Coil::new(0.075, 0.012, 7.0))
            .with_telescope(Telescope::new(0.034, 0.014).with_stroke(0.25)),
        DampingLaw::Sided {
            bump: BUMP,
            rebound: REBOUND,
        },
        SpringTravel::new(LENGTH - TRAVEL[0], LENGTH + TRAVEL[1], STOP)
            .with_progression(PROGRESSION)
            .with_stop_damping(STOP_DAMPING),
        HoldPose::of_a().with_share(0.25),
        StandsOn(wheel),
    ));
}

/// Rapier's spring joint has one damping for both directions, no stops, and no preload but its rest length.
fn rapier_spring(commands: &mut Commands, chassis: Entity, wheel: Entity, corner: Vec3) {
    let [a, b] = ends(corner);
    let sag = 0.25 * CHASSIS * GRAVITY / STIFFNESS;
    let joint = SpringJointBuilder::new(LENGTH + sag, STIFFNESS, 0.5 * (BUMP + REBOUND))
        .local_anchor1(a)
        .local_anchor2(b);
    commands.spawn((ImpulseJoint::new(chassis, joint), ChildOf(wheel)));
}

/// A joint that locks no axis. Its motor is the spring.
fn rapier_bar(commands: &mut Commands, pair: &[Entity], stiffness: f32) {
    let joint = GenericJointBuilder::new(JointAxesMask::empty())
        .motor_model(JointAxis::AngZ, MotorModel::ForceBased)
        .motor_position(JointAxis::AngZ, 0.0, stiffness, 0.0)
        .build();
    let joint = ImpulseJoint::new(pair[0], TypedJoint::GenericJoint(joint));
    commands.spawn((joint, ChildOf(pair[1])));
}

pub fn turn_wheels(tyres: Query<&Tyre>, mut shown: Query<(&mut Transform, &Spinning)>) {
    for (mut at, spinning) in &mut shown {
        if let Ok(tyre) = tyres.get(spinning.0) {
            at.rotation = Quat::from_rotation_y(tyre.steer) * Quat::from_rotation_z(-tyre.angle);
        }
    }
}
