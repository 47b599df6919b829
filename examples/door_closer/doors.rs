//! A wall with two doors.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape, Track, floor};
use std::f32::consts::TAU;

/// Mass of a door, kg.
pub const MASS: f32 = 24.0;
/// Size of a door, m.
pub const SIZE: Vec3 = Vec3::new(0.95, 2.0, 0.05);
/// Distance of the hinges from the middle of the wall, m.
const HINGE: f32 = 1.6;
/// Distance of a handle from the hinge, m.
pub const HANDLE: f32 = 0.85;

/// Spring and damper of a door.
pub struct Closer {
    /// Stiffness, N m/rad.
    pub stiffness: f32,
    /// Damping ratio.
    pub ratio: f32,
    /// Rest angle of the spring, rad.
    pub rest: f32,
    /// Side of the wall's middle: -1 is left, 1 is right.
    pub side: f32,
}

/// The spring of the door closer is still wound when the door is shut, so it holds the door shut.
pub const CLOSER: Closer = Closer {
    stiffness: 10.0,
    ratio: 1.0,
    rest: -0.12,
    side: -1.0,
};
pub const SWING: Closer = Closer {
    stiffness: 12.0,
    ratio: 0.2,
    rest: 0.0,
    side: 1.0,
};
/// Damping of the door closer while it opens, as a share of its damping while it shuts.
const EASY: f32 = 0.2;
/// Stiffness of the frame that the left door meets, N m/rad.
const STOP: f32 = 4e3;
/// Damping of that frame, N m s/rad: enough that the door does not bounce.
const STOP_DAMPING: f32 = 250.0;

impl Closer {
    /// Returns the undamped natural frequency, rad/s.
    pub fn omega(&self) -> f32 {
        (self.stiffness / inertia()).sqrt()
    }

    fn damping(&self) -> f32 {
        2.0 * self.ratio * (self.stiffness * inertia()).sqrt()
    }
}

/// Returns the moment of inertia of a door about its hinge, kg m².
pub fn inertia() -> f32 {
    let middle = 0.5 * SIZE.x;
    MASS * ((SIZE.x * SIZE.x + SIZE.z * SIZE.z) / 12.0 + middle * middle)
}

/// Returns the middle of a door in the door's frame, m.
pub fn middle(side: f32) -> Vec3 {
    Vec3::new(-0.5 * SIZE.x * side, 0.5 * SIZE.y + 0.02, 0.0)
}

/// A door, with its side of the wall's middle: -1 is left, 1 is right.
#[derive(Component)]
pub struct Door(pub f32);

pub fn spawn(mut commands: Commands) {
    commands.spawn(floor());
    let wall = wall(&mut commands);
    for closer in [&CLOSER, &SWING] {
        let door = door(&mut commands, wall, closer.side);
        // A positive angle moves the left door to the back and the right door to the front.
        let mut element = commands.spawn((
            TorsionSpringDamper::new(wall, door, Vec3::Y)
                .with_stiffness(closer.stiffness)
                .with_damping(closer.damping())
                .with_rest_angle(closer.rest),
            TorsionCoil::new(0.2, 5.0)
                .with_center(Vec3::new(HINGE * closer.side, SIZE.y + 0.3, 0.0))
                .with_color(Color::srgb(0.85, 0.62, 0.10)),
            Track::default(),
        ));
        if closer.side < 0.0 {
            // The frame is a stop at an angle of 0. The door opens easily: the damper acts mostly on the way back.
            element.insert((
                SpringTravel::new(0.0, f32::INFINITY, STOP).with_stop_damping(STOP_DAMPING),
                DampingLaw::sided(closer.damping(), EASY * closer.damping()),
            ));
        }
    }
}

/// Spawns the wall. It is one body; its parts are visual only.
fn wall(commands: &mut Commands) -> Entity {
    let mut wall = commands.spawn((
        RigidBody::Fixed,
        Transform::default(),
        Visibility::default(),
    ));
    wall.with_children(|parts| {
        let mut block = |at: Vec3, size: Vec3, paint| {
            parts.spawn((Transform::from_translation(at), Shape::Cuboid(size, paint)));
        };
        let (jamb, top) = (0.08, SIZE.y + 0.2);
        let inner = HINGE - SIZE.x - jamb;
        // The wall between and beside the doors, and the door frames.
        block(
            Vec3::new(0.0, 0.5 * top, 0.0),
            Vec3::new(2.0 * inner, top, 0.16),
            Paint::Ivory,
        );
        for side in [-1.0, 1.0] {
            let (from, to) = (HINGE + jamb, 3.3);
            let x = 0.5 * (from + to) * side;
            let size = Vec3::new(to - from, top, 0.16);
            block(Vec3::new(x, 0.5 * top, 0.0), size, Paint::Ivory);
            for x in [HINGE + 0.5 * jamb, HINGE - SIZE.x - 0.5 * jamb] {
                let size = Vec3::new(jamb, top, 0.2);
                block(Vec3::new(side * x, 0.5 * size.y, 0.0), size, Paint::Iron);
            }
            let x = side * (HINGE - 0.5 * SIZE.x);
            let size = Vec3::new(SIZE.x, 0.16, 0.2);
            block(Vec3::new(x, top - 0.08, 0.0), size, Paint::Iron);
        }
    });
    wall.id()
}

/// Spawns a door, hinged at its outer edge. The body's origin is at the hinge.
fn door(commands: &mut Commands, wall: Entity, side: f32) -> Entity {
    let hinge = Vec3::new(HINGE * side, 0.0, 0.0);
    let middle = middle(side);
    let [x, y, z] = (SIZE * SIZE).to_array();
    let joint = RevoluteJointBuilder::new(Vec3::Y).local_anchor1(hinge);
    let (color, bright) = if side < 0.0 {
        (Paint::Blue, Paint::Ivory)
    } else {
        (Paint::Red, Paint::Ivory)
    };
    let mut door = commands.spawn((
        RigidBody::Dynamic,
        AdditionalMassProperties::MassProperties(MassProperties {
            local_center_of_mass: middle,
            mass: MASS,
            principal_inertia: MASS / 12.0 * Vec3::new(y + z, x + z, x + y),
            ..default()
        }),
        Transform::from_translation(hinge),
        Visibility::default(),
        Velocity::default(),
        ExternalForce::default(),
        ImpulseJoint::new(wall, TypedJoint::RevoluteJoint(joint.build())),
        Door(side),
    ));
    door.with_children(|parts| {
        // The axle that the spring is wound about.
        parts.spawn((
            Transform::from_xyz(0.0, 0.5 * SIZE.y + 0.2, 0.0),
            Shape::Cylinder(0.03, SIZE.y + 0.4, Paint::Iron),
        ));
        parts.spawn((
            Transform::from_translation(middle),
            Shape::Cuboid(SIZE - Vec3::new(0.02, 0.02, 0.0), color),
        ));
        for z in [-1.0, 1.0] {
            // Panels and handle.
            for (y, height) in [(-0.48, 0.7), (0.42, 0.8)] {
                parts.spawn((
                    Transform::from_translation(middle + Vec3::new(0.0, y, 0.024 * z)),
                    Shape::Cuboid(Vec3::new(0.62, height, 0.02), bright),
                ));
            }
            parts.spawn((
                Transform::from_xyz(-HANDLE * side, 1.0, 0.07 * z)
                    .with_rotation(Quat::from_rotation_z(TAU / 4.0)),
                Shape::Capsule(0.018, 0.12, Paint::Iron),
            ));
        }
    });
    door.id()
}
