//! The bridge: planks tied by their corners to two ropes, and a rope for each hand above them.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Rope, Shape};

pub const GRAVITY: f32 = 9.81;
pub const PLANKS: usize = 20;
/// Distance between neighbouring planks, m.
pub const PITCH: f32 = 0.5;
/// Size of a plank, m.
pub const SIZE: Vec3 = Vec3::new(0.4, 0.04, 1.1);
/// Mass of a plank, kg.
pub const PLANK: f32 = 6.0;
/// Mass of a hand rope between two planks, kg.
pub const ROPE: f32 = 0.4;
/// Distance of the banks from the middle, m.
pub const EDGE: f32 = 0.5 * PITCH * PLANKS as f32 + 0.05;
/// Sag of the middle below the banks, m.
pub const SAG: f32 = 0.75;
/// Height of the hand ropes above the planks' ropes, m.
pub const RAIL: f32 = 0.95;
/// Lateral distance of the ropes from the middle of the bridge, m.
const SIDE: f32 = 0.5;
/// Stiffness of the planks' ropes from plank to plank, N/m.
const FOOT: f32 = 3e5;
/// Stiffness of the hand ropes from plank to plank, N/m.
const HAND: f32 = 1e5;
/// Stiffness of the hangers, N/m.
const HANGER: f32 = 2e4;
/// Depth of the gorge, m.
pub const DEPTH: f32 = 3.2;

/// Colliders that the walker can stand on.
pub const GROUND: CollisionGroups = CollisionGroups::new(Group::GROUP_1, Group::GROUP_1);

/// Marks a plank.
#[derive(Component)]
pub struct Plank;

/// On an element that is tied to a bank: the bank's side, -1 or 1.
#[derive(Component)]
pub struct AtBank(pub f32);

/// Marks an element over the middle of the bridge.
#[derive(Component)]
pub struct InTheMiddle;

/// Returns the height of the planks' ropes relative to the banks, m: a parabola.
fn height(x: f32) -> f32 {
    SAG * ((x / EDGE).powi(2) - 1.0)
}

/// Returns position and orientation of a plank.
fn place(i: usize) -> Transform {
    let x = PITCH * (i as f32 - 0.5 * (PLANKS - 1) as f32);
    let slope = 2.0 * SAG * x / (EDGE * EDGE);
    Transform::from_xyz(x, height(x), 0.0).with_rotation(Quat::from_rotation_z(slope.atan()))
}

/// Returns the horizontal tension of a rope with this mass in each section (kg), N.
fn tension(section: f32) -> f32 {
    section * GRAVITY / PITCH * EDGE * EDGE / (2.0 * SAG)
}

pub fn spawn(mut commands: Commands) {
    landscape(&mut commands);
    let bank = |commands: &mut Commands, side: f32| {
        let half = Vec3::new(3.0, 0.5 * DEPTH, 3.0);
        let mut bank = commands.spawn((
            RigidBody::Fixed,
            Collider::cuboid(half.x, half.y, half.z),
            GROUND,
            Transform::from_xyz(side * (EDGE + half.x), -half.y, 0.0),
            Shape::Cuboid(2.0 * half, Paint::Sand),
        ));
        // Posts and turf.
        bank.with_children(|parts| {
            for z in [-SIDE - 0.05, SIDE + 0.05] {
                parts.spawn((
                    Transform::from_xyz(-side * (half.x - 0.07), half.y + 0.45, z),
                    Shape::Cylinder(0.07, 1.3, Paint::Wood),
                ));
            }
            parts.spawn((
                Transform::from_xyz(0.0, half.y, 0.0),
                Shape::Cuboid(Vec3::new(2.0 * half.x, 0.03, 2.0 * half.z), Paint::Grass),
            ));
        });
        bank.id()
    };
    let banks = [-1.0, 1.0].map(|side| bank(&mut commands, side));
    let planks: Vec<Entity> = (0..PLANKS).map(|i| plank(&mut commands, i)).collect();
    for z in [-SIDE, SIDE] {
        foot_rope(&mut commands, banks, &planks, z);
        hand_rope(&mut commands, banks, &planks, z);
    }
}

fn landscape(commands: &mut Commands) {
    let at =
        |y: f32, size: Vec3, paint| (Transform::from_xyz(0.0, y, 0.0), Shape::Cuboid(size, paint));
    commands.spawn(at(-DEPTH - 0.1, Vec3::new(60.0, 0.2, 60.0), Paint::Grass));
    commands.spawn(at(-DEPTH, Vec3::new(5.0, 0.05, 60.0), Paint::Water));
}

fn plank(commands: &mut Commands, i: usize) -> Entity {
    let body = (
        RigidBody::Dynamic,
        Collider::cuboid(0.5 * SIZE.x, 0.5 * SIZE.y, 0.5 * SIZE.z),
        ColliderMassProperties::Mass(PLANK),
        GROUND,
        // Drag of the air and friction in the ropes.
        Damping {
            linear_damping: 1.0,
            angular_damping: 1.0,
        },
        Velocity::default(),
        ExternalForce::default(),
    );
    let look = Shape::Cuboid(SIZE, Paint::Wood);
    commands.spawn((body, place(i), look, Plank)).id()
}

/// Converts a point at the edge of a bank to the frame of the bank.
fn on_bank(side: f32, height: f32, z: f32) -> Vec3 {
    Vec3::new(-3.0 * side, 0.5 * DEPTH + height, z)
}

/// Spawns a rope from plank corner to plank corner, in equilibrium with the weight of the planks.
fn foot_rope(commands: &mut Commands, banks: [Entity; 2], planks: &[Entity], z: f32) {
    let force = tension(0.5 * PLANK);
    let corner = |side: f32| Vec3::new(0.5 * side * SIZE.x, 0.0, z);
    for i in 0..=PLANKS {
        let (a, from) = match i {
            0 => (banks[0], on_bank(-1.0, 0.0, z)),
            _ => (planks[i - 1], corner(1.0)),
        };
        let (b, to) = match i {
            PLANKS => (banks[1], on_bank(1.0, 0.0, z)),
            _ => (planks[i], corner(-1.0)),
        };
        let at = |i: usize, side: f32| place(i).transform_point(corner(side));
        let left = if i == 0 {
            Vec3::new(-EDGE, 0.0, z)
        } else {
            at(i - 1, 1.0)
        };
        let right = if i == PLANKS {
            Vec3::new(EDGE, 0.0, z)
        } else {
            at(i, -1.0)
        };
        let length = left.distance(right);
        let mut rope = commands.spawn((
            SpringDamper::new(a, b)
                .with_stiffness(FOOT)
                .with_damping(0.1 * (FOOT * PLANK).sqrt())
                .with_rest_length(length - force / FOOT),
            SpringAction::Pull,
            Anchors::new(from, to),
            Rope {
                radius: 0.022,
                length,
                paint: Paint::Hemp,
            },
        ));
        mark(&mut rope, i);
    }
}

/// Spawns a rope from point to point above the planks, tied to their edges.
fn hand_rope(commands: &mut Commands, banks: [Entity; 2], planks: &[Entity], z: f32) {
    let force = tension(ROPE);
    let at = |i: usize| place(i).translation + Vec3::new(0.0, RAIL, z);
    let points: Vec<Entity> = (0..PLANKS)
        .map(|i| {
            let body = (
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(ROPE),
                LockedAxes::ROTATION_LOCKED,
                Damping {
                    linear_damping: 1.0,
                    ..default()
                },
                Velocity::default(),
            );
            commands
                .spawn((body, Transform::from_translation(at(i))))
                .id()
        })
        .collect();
    for i in 0..=PLANKS {
        let (a, from, left) = match i {
            0 => (banks[0], on_bank(-1.0, RAIL, z), Vec3::new(-EDGE, RAIL, z)),
            _ => (points[i - 1], Vec3::ZERO, at(i - 1)),
        };
        let (b, to, right) = match i {
            PLANKS => (banks[1], on_bank(1.0, RAIL, z), Vec3::new(EDGE, RAIL, z)),
            _ => (points[i], Vec3::ZERO, at(i)),
        };
        let length = left.distance(right);
        let mut rope = commands.spawn((
            SpringDamper::new(a, b)
                .with_stiffness(HAND)
                .with_damping(0.1 * (HAND * ROPE).sqrt())
                .with_rest_length(length - force / HAND),
            SpringAction::Pull,
            Anchors::new(from, to),
            Rope {
                radius: 0.018,
                length,
                paint: Paint::Hemp,
            },
        ));
        mark(&mut rope, i);
    }
    for (point, plank) in points.into_iter().zip(planks) {
        commands.spawn((
            SpringDamper::new(point, *plank)
                .with_stiffness(HANGER)
                .with_damping(0.2 * (HANGER * ROPE).sqrt()),
            SpringAction::Pull,
            Anchors::new(Vec3::ZERO, Vec3::Z * z),
            Rope {
                radius: 0.009,
                length: RAIL,
                paint: Paint::Hemp,
            },
        ));
    }
}

fn mark(rope: &mut EntityCommands, i: usize) {
    match i {
        0 => rope.insert(AtBank(-1.0)),
        PLANKS => rope.insert(AtBank(1.0)),
        _ if i == PLANKS / 2 => rope.insert(InTheMiddle),
        _ => rope,
    };
}
