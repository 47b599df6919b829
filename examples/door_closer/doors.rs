//! A wall with two doors.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Paint, Shape, Track, floor};
use std::f32::consts::TAU;

/// Of a door, kg and m.
pub const MASS: f32 = 24.0;
pub const SIZE: Vec3 = Vec3::new(0.95, 2.0, 0.05);
/// Of the hinges from the middle of the wall, m.
const HINGE: f32 = 1.6;
/// Of a handle from the hinge, m.
pub const HANDLE: f32 = 0.85;

/// What holds a door.
pub struct Closer {
    /// N m/rad
    pub stiffness: f32,
    /// Share of critical damping.
    pub ratio: f32,
    /// Angle at which the spring has no moment, rad.
    pub rest: f32,
    /// On which side of the wall's middle.
    pub side: f32,
}

/// The spring of the door closer is still wound up when the door is shut: it holds it there.
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
/// Share of its damping that the door closer has while it opens.
const EASY: f32 = 0.2;
/// Of the frame that the first door meets, N m/rad and N m s/rad: so that it does not bounce.
const STOP: f32 = 4e3;
const STOP_DAMPING: f32 = 250.0;

impl Closer {
    /// Of its vibration without damping, rad/s.
    pub fn omega(&self) -> f32 {
        (self.stiffness / inertia()).sqrt()
    }

    fn damping(&self) -> f32 {
        2.0 * self.ratio * (self.stiffness * inertia()).sqrt()
    }
}

/// Of a door about its hinge, kg m².
pub fn inertia() -> f32 {
    let middle = 0.5 * SIZE.x;
    MASS * ((SIZE.x * SIZE.x + SIZE.z * SIZE.z) / 12.0 + middle * middle)
}

/// Of a door in its own frame.
pub fn middle(side: f32) -> Vec3 {
    Vec3::new(-0.5 * SIZE.x * side, 0.5 * SIZE.y + 0.02, 0.0)
}

/// A door, on which side of the wall's middle it is.
#[derive(Component)]
pub struct Door(pub f32);

pub fn spawn(mut commands: Commands) {
    commands.spawn(floor());
    let wall = wall(&mut commands);
    for closer in [&CLOSER, &SWING] {
        let door = door(&mut commands, wall, closer.side);
        // An angle is positive where the door goes to the back on the left, and to the front on the right.
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
            // The frame on one side: a stop at an angle of 0. And easy to open: the damper acts on its way back.
            element.insert((
                SpringTravel::new(0.0, f32::INFINITY, STOP).with_stop_damping(STOP_DAMPING),
                DampingLaw::sided(closer.damping(), EASY * closer.damping()),
            ));
        }
    }
}

/// The wall is one body, whose parts are there to be seen.
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
        // Between the doors, beside them, and their frames.
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

/// Hinged at its outer edge; its origin is there.
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
        // The axle, which the spring is wound about.
        parts.spawn((
            Transform::from_xyz(0.0, 0.5 * SIZE.y + 0.2, 0.0),
            Shape::Cylinder(0.03, SIZE.y + 0.4, Paint::Iron),
        ));
        parts.spawn((
            Transform::from_translation(middle),
            Shape::Cuboid(SIZE - Vec3::new(0.02, 0.02, 0.0), color),
        ));
        for z in [-1.0, 1.0] {
            // Panels, and the handle.
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
