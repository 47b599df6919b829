//! A body that elements move but do not turn: read as the point that its centre of mass is, and given what
//! takes it on.

use super::body::{Push, straight};
use super::rows::BodyRow;
use super::sleep::keep_awake;
use super::step::Step;
pub(super) use crate::dynamics::points::{Flight, FreePoint};
use bevy::math::Vec3;
use bevy_rapier3d::rapier::dynamics::{
    LockedAxes, RigidBody as RapierBody, RigidBodyHandle, RigidBodySet,
};
use std::sync::atomic::Ordering;

/// How a lone element goes through the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Route {
    /// Read; to be solved with others of its batch.
    Batched,
    /// It has no body any more that it could move.
    Gone,
    /// Asleep; and if so, only these, its bodies, can wake it.
    Asleep(Option<[RigidBodyHandle; 2]>),
    /// By the general solver in this step.
    GeneralOnce,
    /// By the general solver for as long as can be seen.
    General,
}

const LOCKED: LockedAxes = LockedAxes::TRANSLATION_LOCKED;

impl FreePoint {
    /// The centre of mass of an ordinary movable body.
    #[inline(always)]
    pub(super) fn of(row: &BodyRow, body: &RapierBody, step: &Step) -> Result<Self, Route> {
        let properties = &body.mass_properties().local_mprops;
        if body.locked_axes().intersects(LOCKED) {
            return Err(Route::General);
        }
        let mut position = body.position().translation.as_dvec3();
        if properties.local_com != Vec3::ZERO {
            let rotation = body.position().rotation.as_dquat().normalize();
            position += rotation * properties.local_com.as_dvec3();
        }
        let inverse_mass = f64::from(properties.inv_mass);
        Ok(Self {
            position,
            velocity: body.linvel().as_dvec3(),
            acceleration: step.engine.gravity.as_dvec3() * f64::from(body.gravity_scale())
                + inverse_mass * row.user.force.as_dvec3(),
            inverse_mass,
        })
    }
}

impl Step {
    /// Gives the engine what takes a body where its elements do. `restless`: it has to be kept awake.
    #[inline(always)]
    pub(super) fn deliver_point(
        &self,
        row: &mut BodyRow,
        point: &FreePoint,
        flight: &Flight,
        restless: bool,
        set: &mut RigidBodySet,
    ) {
        let Some(body) = set.get_mut(row.handle) else {
            return;
        };
        if restless {
            keep_awake(body);
        }
        self.delivered.store(true, Ordering::Relaxed);
        let terms = self.terms(body);
        let (linvel, rate) = straight(
            point.velocity,
            flight.moved,
            flight.velocity,
            &terms,
            &self.engine,
        );
        let force = ((rate - point.acceleration) / point.inverse_mass).as_vec3();
        let push = Push {
            linvel: Some(linvel),
            angvel: None,
            share: [force, Vec3::ZERO],
            raised_iterations: terms.raised_iterations,
        };
        row.give(&push, body);
    }
}
