//! The test engine.

use crate::backend::{BodyId, Engine, Push, Seen, Sight, StepPlan, Worlds, Wrench};
use crate::dynamics::body::{Body, Spin};
use crate::dynamics::delivery::{Delivery, Spinning};
use bevy::math::{DMat3, DQuat, DVec3, Mat3, Quat};
use bevy::prelude::*;

/// Duration of a step, s.
pub(super) const DT: f64 = 1.0 / 60.0;

/// A body: the component of its entity, and its state in the engine.
#[derive(Component, Clone, Copy)]
pub(super) struct Brick {
    pub index: u32,
    pub mass: f32,
    pub inertia: Vec3,
    pub at: Vec3,
    pub rotation: Quat,
    pub velocity: Vec3,
    pub spin: Vec3,
    pub wrench: Wrench,
}

pub(super) struct Own {
    pub bricks: Vec<Brick>,
    pub gravity: Vec3,
    pub substeps: usize,
}

/// Inverse inertia in the world frame.
fn inverse_inertia(rotation: Quat, inertia: Vec3) -> Mat3 {
    let frame = Mat3::from_quat(rotation);
    frame * Mat3::from_diagonal(inertia.recip()) * frame.transpose()
}

/// Turns a brick by its spin for `time` seconds; its angular momentum is constant.
fn turn_on(rotation: Quat, spin: Vec3, inertia: Vec3, time: f32) -> (Quat, Vec3) {
    let momentum = inverse_inertia(rotation, inertia).inverse() * spin;
    let turned = (Quat::from_scaled_axis(time * spin) * rotation).normalize();
    (turned, inverse_inertia(turned, inertia) * momentum)
}

/// How the engine integrates rotation: see `TurnRule`.
fn turn(spinning: &Spinning, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
    let (body, schedule) = (spinning.body, spinning.schedule);
    let mut state = (body.rotation.as_quat(), (spin + delivery.jump).as_vec3());
    for _ in 0..schedule.substeps {
        let faster = (schedule.substep * delivery.rate).as_vec3();
        let (rotation, spin) = state;
        let time = schedule.substep as f32;
        state = turn_on(rotation, spin + faster, body.inertia.as_vec3(), time);
    }
    (state.0.as_dquat(), state.1.as_dvec3())
}

impl Own {
    pub fn plan(&self) -> StepPlan {
        StepPlan {
            time: DT,
            calls: 1,
            substeps: self.substeps,
            fastest: 1e3,
            farthest_turn: f64::INFINITY,
            turn,
            length_unit: 1.0,
        }
    }

    pub fn step(&mut self) {
        let h = DT as f32 / self.substeps as f32;
        for b in &mut self.bricks {
            // The angular acceleration by the torque is computed once per step, as in most engines.
            let pull = inverse_inertia(b.rotation, b.inertia) * b.wrench.torque;
            for _ in 0..self.substeps {
                b.velocity += h * (self.gravity + b.wrench.force / b.mass);
                b.at += h * b.velocity;
                let spin = b.spin + h * pull;
                (b.rotation, b.spin) = turn_on(b.rotation, spin, b.inertia, h);
            }
        }
    }
}

impl Sight for Own {
    fn see(&self, body: BodyId) -> Option<Seen> {
        let b = self.bricks.get(body.index as usize)?;
        Some(Seen {
            origin: b.at,
            rotation: b.rotation,
            local_center: Vec3::ZERO,
            velocity: b.velocity,
            spin: b.spin,
            inverse_mass: b.mass.recip(),
            gravity: self.gravity.as_dvec3(),
            more_substeps: 0,
            is_movable: true,
            is_asleep: false,
            is_locked: false,
            can_touch: false,
            turns_fast: true,
            is_gyroscopic: true,
        })
    }

    fn is_asleep(&self, _: BodyId) -> bool {
        false
    }

    fn body(&self, body: BodyId, user: &Wrench, turns: bool) -> Option<Body> {
        let b = self.bricks.get(body.index as usize)?;
        let inverse_mass = DVec3::splat(f64::from(b.mass).recip());
        let rotation = b.rotation.as_dquat().normalize();
        let mut body = Body {
            position: b.at.as_dvec3(),
            velocity: b.velocity.as_dvec3(),
            rotation,
            spin: Spin::Ignored,
            inverse_mass,
            inertia: b.inertia.as_dvec3(),
            principal: DQuat::IDENTITY,
            rotation_locked: [false; 3],
            farthest_turn: f64::INFINITY,
            acceleration: self.gravity.as_dvec3() + inverse_mass * user.force.as_dvec3(),
            torque: user.torque.as_dvec3(),
            given: (DVec3::ZERO, DVec3::ZERO),
            torque_work: 0.0,
            turned: None,
        };
        if turns {
            let frame = DMat3::from_quat(rotation);
            let inertia = frame * DMat3::from_diagonal(body.inertia) * frame.transpose();
            let momentum = inertia * b.spin.as_dvec3();
            body.spin = Spin::Free { momentum };
        }
        Some(body)
    }

    fn way(&self, _: BodyId, _: DVec3, _: f64) -> Option<[DVec3; 2]> {
        None
    }

    fn turning(&self, _: BodyId, _: f64) -> Option<(DQuat, DVec3)> {
        None
    }

    fn size(&self, _: BodyId) -> f32 {
        1.0
    }
}

impl Engine for Own {
    fn give(&mut self, body: BodyId, push: &Push, user: &Wrench) {
        let b = &mut self.bricks[body.index as usize];
        b.velocity = push.velocity.unwrap_or(b.velocity);
        b.spin = push.spin.unwrap_or(b.spin);
        b.wrench = Wrench {
            force: push.share.force + user.force,
            torque: push.share.torque + user.torque,
        };
    }

    fn keep_awake(&mut self, _: BodyId) {}

    fn wake(&mut self, _: BodyId) {}
}

/// The only context of the tests.
pub(super) struct Only<'a>(pub &'a Own);

impl Worlds for Only<'_> {
    type Sight = Own;

    fn of(&self, _: Entity) -> Option<&Own> {
        Some(self.0)
    }
}
