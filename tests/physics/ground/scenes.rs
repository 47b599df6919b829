//! Scenes that several tests share.

use super::stand::*;
use crate::harness::*;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// A load above a foot or a wheel, guided vertically, with a spring between them.
#[derive(Clone)]
pub struct Footed {
    /// Point of the ground below the foot, m.
    pub at: Vec3,
    /// Mass above the spring, kg.
    pub load: f32,
    pub foot: f32,
    pub collider: Collider,
    /// Distance from the foot's centre down to its sole, m.
    pub reach: f32,
    pub law: [f32; 2],
    pub rest: f32,
    /// Height of the sole above the ground at the start, m.
    pub drop: f32,
    /// Speed along x of a rolling wheel, m/s. `None` for a foot that does not turn.
    pub speed: Option<f32>,
}

/// Entities of a [`Footed`].
#[derive(Clone, Copy)]
pub struct Placed {
    pub above: Entity,
    pub below: Entity,
    pub element: Entity,
}

impl Footed {
    /// 300 kg over a wheel of 20 kg, on the road.
    pub fn quarter_car() -> Self {
        Self {
            at: Vec3::ZERO,
            load: 300.0,
            foot: 20.0,
            collider: Collider::ball(0.33),
            reach: 0.33,
            law: [30e3, 2e3],
            rest: 0.5,
            drop: 0.0,
            speed: Some(0.0),
        }
    }

    /// 300 kg over a stiff box foot of 10 kg, half a metre above the ground.
    pub fn foot() -> Self {
        let (mass, omega) = (10.0 * 300.0 / 310.0, 60.0);
        Self {
            foot: 10.0,
            collider: Collider::cuboid(0.1, 0.1, 0.1),
            reach: 0.1,
            law: [mass * omega * omega, 2.0 * 0.3 * mass * omega],
            rest: 0.6,
            drop: 0.5,
            speed: None,
            ..Self::quarter_car()
        }
    }

    pub fn put(&self, scene: &mut Stand) -> Placed {
        let speed = self.speed.unwrap_or(0.0);
        let sole = self.at + Vec3::Y * (self.drop + self.reach);
        let above = scene.body(
            Transform::from_translation(sole + Vec3::Y * self.rest),
            (
                AdditionalMassProperties::Mass(self.load),
                LockedAxes::ROTATION_LOCKED | LockedAxes::TRANSLATION_LOCKED_Z,
                Velocity::linear(Vec3::X * speed),
            ),
        );
        let guide = GenericJointBuilder::new(JointAxesMask::LIN_X | JointAxesMask::LIN_Z);
        let below = scene.body(
            Transform::from_translation(sole),
            (
                self.collider.clone(),
                ColliderMassProperties::Mass(self.foot),
                Friction::new(1.0),
                ImpulseJoint::new(above, TypedJoint::GenericJoint(guide.build())),
                Velocity {
                    linear: Vec3::X * speed,
                    angular: Vec3::NEG_Z * speed / self.reach,
                },
            ),
        );
        if self.speed.is_none() {
            let world = scene.lab.app.world_mut();
            world.entity_mut(below).insert(LockedAxes::ROTATION_LOCKED);
        }
        let element = scene.coil([above, below], [Vec3::ZERO; 2], self.law, Some(self.rest));
        Placed {
            above,
            below,
            element,
        }
    }

    /// Compression of the spring under the load at rest, m.
    pub fn sag(&self) -> f64 {
        f64::from(self.load) * GRAVITY / f64::from(self.law[0])
    }

    /// Energy at rest on the ground, J.
    pub fn floor(&self) -> f64 {
        let (sag, sole) = (self.sag(), f64::from(self.at.y) + f64::from(self.reach));
        let weights = f64::from(self.foot) * sole
            + f64::from(self.load) * (sole + f64::from(self.rest) - sag);
        GRAVITY * weights + 0.5 * f64::from(self.law[0]) * sag * sag
    }

    /// Compression of the scene's first spring now, m.
    pub fn sag_now(&self, scene: &Stand) -> f64 {
        f64::from(self.rest) - scene.length(&scene.coils[0])
    }
}

/// Spawns a wall and a box of 5 kg on the ground. A spring from a hand inside the wall, at `height`, pulls the box
/// against the wall. Returns the box.
pub fn box_at_wall(scene: &mut Stand, k: f32, height: f32) -> Entity {
    scene.lab.spawn((
        RigidBody::Fixed,
        Collider::cuboid(0.1, 1.0, 1.0),
        Transform::from_xyz(1.0, 1.0, 0.0),
    ));
    let load = scene.body(
        Transform::from_xyz(0.6, 0.25, 0.0),
        (
            Collider::cuboid(0.25, 0.25, 0.25),
            ColliderMassProperties::Mass(5.0),
        ),
    );
    let hand = scene.lab.spawn((
        RigidBody::KinematicPositionBased,
        Transform::from_xyz(1.0, height, 0.0),
    ));
    let c = 0.2 * (k * 5.0).sqrt();
    scene.coil([hand, load], [Vec3::ZERO; 2], [k, c], Some(0.0));
    load
}

/// Number of impulse joints in Rapier's only context.
pub fn joints(scene: &mut Stand) -> usize {
    let world = scene.lab.app.world_mut();
    let mut sets = world.query::<&RapierContextJoints>();
    let joints = sets.single(world).expect("one context");
    joints.impulse_joints.len()
}
