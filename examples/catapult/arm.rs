//! The arm, the twisted ropes that drive it, and the winch that pulls it down.

use super::frame::Frame;
use super::{RELEASE, WIND};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Rope, Shape};

/// Position of the arm's hinge, m.
pub const HINGE: Vec3 = Vec3::new(0.0, 0.62, 0.0);
/// Distance of the cup from the hinge, m.
pub const LENGTH: f32 = 1.7;
/// Mass of the arm, kg.
pub const MASS: f32 = 6.0;
/// Moment of inertia of the arm about its hinge, kg m²: a beam with its centre of mass at half its length.
pub const INERTIA: f32 = MASS * LENGTH * LENGTH / 3.0;
/// Angle at which the arm meets the padded beam, rad from upright, positive forward.
pub const PAD: f32 = -0.45;
/// Angle to which the winch pulls the arm down, rad from upright, positive forward.
pub const DOWN: f32 = -1.5;
/// Torsional stiffness of the twisted ropes, N m/rad.
pub const STIFFNESS: f32 = 160.0;
/// Rest angle of the twisted ropes, rad.
pub const REST: f32 = 0.5;
/// Damping of the twisted ropes, N m s/rad.
pub const DAMPING: f32 = 0.5;
/// Stiffness of the pad, N m/rad.
const PAD_STIFFNESS: f32 = 2e4;
/// Damping of the pad, N m s/rad.
const PAD_DAMPING: f32 = 150.0;
/// Stiffness of the winch's rope, N/m.
const ROPE: f32 = 1e4;
/// Damping of the winch's rope, N s/m.
const ROPE_DAMPING: f32 = 5.0;
/// Position of the winch, m.
const WINCH: Vec3 = Vec3::new(-1.4, 0.22, 0.0);
/// Distance from the hinge to the end of the winch's rope on the arm, m.
const HOOK: f32 = 1.45;

#[derive(Component)]
pub struct Arm;

/// Marks the torsion element of the twisted ropes.
#[derive(Component)]
pub struct Skein;

/// Marks the element of the winch's rope.
#[derive(Component)]
pub struct Winch;

/// Returns the direction of the arm at an angle.
pub fn along(angle: f32) -> Vec3 {
    Vec3::new(angle.sin(), angle.cos(), 0.0)
}

/// Returns the distance from the winch to the hook at an angle of the arm, m.
fn reach(angle: f32) -> f32 {
    (HINGE + HOOK * along(angle)).distance(WINCH)
}

pub fn spawn(frame: Res<Frame>, mut commands: Commands) {
    let frame = frame.0;
    let joint = RevoluteJointBuilder::new(Vec3::NEG_Z).local_anchor1(HINGE);
    // The cup: a floor with a rim on all four sides.
    let (floor, rim) = (0.02, 0.1);
    let cup = |at: Vec3, half: Vec3| (at, Quat::IDENTITY, Collider::cuboid(half.x, half.y, half.z));
    let inner = super::shot::RADIUS + 0.005;
    let (below, above) = (LENGTH - inner - floor, LENGTH + inner + floor);
    let boxes = [
        (
            Vec3::new(-0.5 * floor, LENGTH, 0.0),
            Vec3::new(floor, inner + 2.0 * floor, inner + 2.0 * floor),
        ),
        (
            Vec3::new(0.5 * rim, below, 0.0),
            Vec3::new(0.5 * rim, floor, inner),
        ),
        (
            Vec3::new(0.5 * rim, above, 0.0),
            Vec3::new(0.5 * rim, floor, inner),
        ),
        (
            Vec3::new(0.5 * rim, LENGTH, -inner - floor),
            Vec3::new(0.5 * rim, inner, floor),
        ),
        (
            Vec3::new(0.5 * rim, LENGTH, inner + floor),
            Vec3::new(0.5 * rim, inner, floor),
        ),
    ];
    let mut arm = commands.spawn((
        RigidBody::Dynamic,
        Collider::compound(boxes.map(|(at, half)| cup(at, half)).to_vec()),
        ColliderMassProperties::Density(0.0),
        AdditionalMassProperties::MassProperties(MassProperties {
            local_center_of_mass: Vec3::Y * 0.5 * LENGTH,
            mass: MASS,
            principal_inertia: MASS * LENGTH * LENGTH / 12.0 * Vec3::new(1.0, 0.01, 1.0),
            ..default()
        }),
        Transform::from_translation(HINGE).with_rotation(Quat::from_rotation_z(-PAD)),
        Visibility::default(),
        Velocity::default(),
        ImpulseJoint::new(frame, TypedJoint::RevoluteJoint(joint.build())),
        Arm,
    ));
    arm.with_children(|parts| {
        parts.spawn((
            Transform::from_xyz(0.0, 0.5 * (LENGTH - inner) - 0.1, 0.0),
            Shape::Cuboid(Vec3::new(0.1, LENGTH - inner + 0.1, 0.1), Paint::Sand),
        ));
        for (at, half) in boxes {
            parts.spawn((
                Transform::from_translation(at),
                Shape::Cuboid(2.0 * half, Paint::Iron),
            ));
        }
    });
    let arm = arm.id();
    // The ropes are wound about the hinge on both sides of the arm.
    commands.spawn((
        TorsionSpringDamper::new(frame, arm, Vec3::NEG_Z)
            .with_stiffness(STIFFNESS)
            .with_damping(DAMPING)
            .with_rest_angle(REST),
        SpringTravel::new(f32::NEG_INFINITY, PAD, PAD_STIFFNESS).with_stop_damping(PAD_DAMPING),
        TorsionCoil::new(0.16, 6.0)
            .with_center(HINGE)
            .with_color(Color::srgb(0.72, 0.60, 0.38)),
        Skein,
    ));
    commands.spawn((
        SpringDamper::new(frame, arm)
            .with_stiffness(ROPE)
            .with_damping(ROPE_DAMPING)
            .with_rest_length(reach(PAD) + 0.05),
        SpringAction::Pull,
        Anchors::new(WINCH, Vec3::Y * HOOK),
        Rope {
            radius: 0.015,
            length: reach(PAD),
            paint: Paint::Hemp,
        },
        Winch,
    ));
}

/// The winch shortens its rope until the hook releases the arm.
pub fn wind(
    time: Res<Time>,
    mut ropes: Query<(Entity, &mut SpringDamper), With<Winch>>,
    mut commands: Commands,
) {
    let t = time.elapsed_secs();
    for (rope, mut element) in &mut ropes {
        if t > RELEASE {
            commands.entity(rope).despawn();
            continue;
        }
        let share = (t - WIND[0]) / (WIND[1] - WIND[0]);
        let share = EaseFunction::SmootherStep.sample_clamped(share);
        let length = reach(PAD) + 0.05 + share * (reach(DOWN) - reach(PAD) - 0.05);
        if element.rest_length != Some(length) {
            element.rest_length = Some(length);
        }
    }
}
