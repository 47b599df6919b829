//! A body may sleep only where it would really stay.
//!
//! Rapier puts a body to sleep after half a second below a speed that a slow spring never exceeds, and
//! a body at its turning point is slow too. So bodies of a component that is not at rest have their
//! timers set back, and one that is disturbed is woken as a whole.

use super::body::is_movable;
use super::component::Step;
use super::forces::SpringLoad;
use super::group::Group;
use super::scene::Scene;
use super::solve::Loads;
use crate::dynamics::body::Body;
use crate::dynamics::step::Component;
use bevy_rapier3d::prelude::RapierRigidBodySet;
use bevy_rapier3d::rapier::dynamics::RigidBody as RapierBody;

/// Speed (m/s, rad/s; times the engine's length unit) that counts as rest, for the present velocity
/// and for the velocity that the present acceleration would lead to within the element's period.
const REST: f32 = 2e-4;

/// Rounding of a position that is not motion, in units of its last place: a stiff spring answers each
/// of them with a speed of ω times that.
const ROUNDING: f32 = 4.0;

/// Slowest natural frequency (rad/s) that is waited for.
const SLOWEST: f32 = 0.05;

/// Judges by measured acceleration, so that contacts and joints count. `omega` is the natural
/// frequency of the stiffest element on the body.
fn is_restless(
    load: &SpringLoad,
    body: &RapierBody,
    omega: f32,
    time: f32,
    length_unit: f32,
) -> bool {
    let (linear, angular) = (body.linvel(), body.angvel());
    let Some((linear_before, angular_before)) = load.before else {
        return true;
    };
    let reach = 1.0 / (time * omega.max(SLOWEST));
    let place = body.position().translation.abs().max_element();
    let noise = ROUNDING * f32::EPSILON * omega;
    let still = |now: f32, change: f32, limit: f32| {
        now * now + (change * reach) * (change * reach) < limit * limit
    };
    !(still(
        linear.length(),
        (linear - linear_before).length(),
        REST * length_unit + noise * place,
    ) && still(
        angular.length(),
        (angular - angular_before).length(),
        REST + noise,
    ))
}

/// Whether a step would set a sleeping body moving: an acceleration that within a second is not rest.
fn is_set_moving(start: &Body, end: &Body, time: f64, length_unit: f32) -> bool {
    let rest = f64::from(REST) * time;
    (end.velocity - start.velocity).length() > rest * f64::from(length_unit)
        || (end.angular_velocity() - start.angular_velocity()).length() > rest
}

/// Sets the engine's sleep timer back.
fn keep_awake(body: &mut RapierBody) {
    body.activation_mut().time_since_can_sleep = 0.0;
}

impl Step<'_> {
    /// A sleeping body is no wall: where the step would set it moving, it and the others wake.
    pub(super) fn wake_the_moved(
        &self,
        scene: &Scene,
        group: Group,
        start: &[Body],
        end: &[Body],
        set: &mut RapierRigidBodySet,
    ) {
        let bodies = || group.bodies.iter().map(|b| scene.bodies[*b].handle);
        let moved = bodies()
            .zip(start.iter().zip(end))
            .any(|(handle, (start, end))| {
                set.bodies.get(handle).is_some_and(RapierBody::is_sleeping)
                    && is_set_moving(start, end, self.plan.time, self.engine.length_unit)
            });
        if moved {
            for handle in bodies() {
                if let Some(body) = set.bodies.get_mut(handle) {
                    body.wake_up(true);
                }
            }
        }
    }

    /// Wakes, keeps awake or lets sleep; says whether there is anything to do.
    pub(super) fn is_awake(
        &self,
        scene: &Scene,
        group: Group,
        component: &Component,
        set: &mut RapierRigidBodySet,
        loads: &mut Loads,
        mut disturbed: bool,
    ) -> bool {
        let mut all_asleep = true;
        let mut restless = false;
        let omega = component
            .elements
            .iter()
            .filter_map(|e| Some(e.stiffness * e.line(&component.bodies)?.inverse_mass))
            .fold(0.0, f64::max)
            .sqrt() as f32;
        // A damper alone has no period; a second stands in for it.
        let omega = if omega == 0.0 { 1.0 } else { omega };
        for b in group.bodies {
            let row = scene.bodies[*b];
            let (Some(body), Ok((_, mut load, ..))) =
                (set.bodies.get(row.handle), loads.get_mut(row.entity))
            else {
                continue;
            };
            disturbed |= load.disturbed || load.signature != row.signature;
            load.disturbed = false;
            load.signature = row.signature;
            if !body.is_sleeping() && is_movable(body) {
                all_asleep = false;
                restless |= is_restless(
                    &load,
                    body,
                    omega,
                    self.plan.time as f32,
                    self.engine.length_unit,
                );
            }
        }
        if all_asleep && !disturbed {
            return false;
        }
        if disturbed || restless {
            for b in group.bodies {
                if let Some(body) = set.bodies.get_mut(scene.bodies[*b].handle) {
                    if body.is_sleeping() {
                        body.wake_up(true);
                    }
                    keep_awake(body);
                }
            }
        }
        true
    }
}
