//! Computes the tension with which an element holds its load against gravity, for `HoldPose` and for the rest length of
//! `SpringTuning::Sag`.

use crate::backend::rapier::body::is_movable;
use crate::backend::rapier::find::RapierFinder;
use crate::backend::rapier::held::{joints_of, locks};
use crate::backend::rapier::tune::Lever;
use crate::dynamics::body::Body;
use crate::dynamics::linkage::{Constraint, Linkage, Side};
use crate::element::{HeldEnd, HoldPose};
use crate::input::check::Fault;
use bevy::math::DVec3;
use bevy_rapier3d::rapier::dynamics::RigidBodyHandle;

/// Cosine of the angle between an element and the weight of its load below which the element counts as level: then its tension
/// cannot carry the weight. At this angle it is ten times the weight, and a spring that strong would throw the load sideways.
/// Pinned by `laws::unloaded`.
const LEVEL: f64 = 0.1;
/// Share of the load's inverse mass along the element that joints must leave. Below it, joints hold the load without
/// the element: on the arm of a lamp, an element so near to the hinge would need hundreds of times its weight. Pinned by
/// `laws::unloaded`.
const HELD: f64 = 1e-4;

fn fault<T>(reason: &'static str) -> Result<T, Fault> {
    Err(Fault::new("HoldPose", reason))
}

impl Lever {
    /// Index of the end that can move along the line, if exactly one can. `left` returns the inverse mass that joints and
    /// contacts leave at an end, 1/kg.
    pub(crate) fn load(&self, left: impl Fn(usize) -> f64) -> Option<usize> {
        let moves = |end: usize| self.line.holds[end].body.is_some() && left(end) > 0.0;
        match [moves(0), moves(1)] {
            [true, false] => Some(0),
            [false, true] => Some(1),
            _ => None,
        }
    }

    /// Inverse mass along the line of an end without joints and contacts, 1/kg.
    fn free(&self, end: usize) -> f64 {
        self.line.inverse_masses[end]
    }
}

impl RapierFinder<'_, '_> {
    /// Returns the tension (N) at which the load at `end` does not accelerate along the element if no other element acts, and
    /// whether joints help to hold the load. `None` if joints hold the load without the element.
    pub(crate) fn tension_alone(
        &self,
        lever: &Lever,
        end: usize,
        mass: Option<f64>,
    ) -> Option<(f64, bool)> {
        let hold = &lever.line.holds[end];
        let index = hold.body?;
        let body = &lever.bodies[index];
        let handle = lever.handles[index];
        let other = lever.line.holds[1 - end].body.map(|b| lever.handles[b]);
        let held = Linkage {
            bodies: vec![*body],
            constraints: self.locks_of(lever, body, handle, other.filter(|_| hold.twist)),
        };
        // The other end is treated as fixed.
        let mut line = lever.line;
        line.holds[1 - end].body = None;
        line.holds[end].body = Some(0);
        let apart = Constraint::of_line(&line);
        let falling = Constraint {
            sides: [
                None,
                Some(Side {
                    body: 0,
                    linear: weight(body, mass),
                    angular: DVec3::ZERO,
                }),
            ],
        };
        let [left, fall] = held.response(&apart, [&apart, &falling])?;
        // Tension pulls the ends together, so it is positive where the weight drives them apart.
        let carries = left > HELD * lever.free(end);
        carries.then(|| (fall / left, !held.constraints.is_empty()))
    }

    /// Constraints of the joints between the load and bodies that cannot move. The body `still` counts as one that cannot move.
    fn locks_of(
        &self,
        lever: &Lever,
        load: &Body,
        handle: RigidBodyHandle,
        still: Option<RigidBodyHandle>,
    ) -> Vec<Constraint> {
        let mut held = Vec::new();
        let Ok((set, _, joints, _)) = self.sets.get(lever.context) else {
            return held;
        };
        for (between, joint) in joints_of(joints, handle) {
            let other = between[usize::from(between[0] == handle)];
            let [Some(first), Some(second)] = between.map(|handle| set.bodies.get(handle)) else {
                continue;
            };
            let moves = if between[0] == handle { second } else { first };
            if is_movable(moves) && Some(other) != still {
                continue;
            }
            let frame = (*first.position() * joint.local_frame1).rotation;
            let at = (*second.position() * joint.local_frame2).translation;
            let rotation = frame.as_dquat().normalize();
            let on = [None, Some((0, load))];
            held.extend(locks(joint, rotation, at.as_dvec3(), on));
        }
        held
    }

    /// The tension with which an element carries its share of its load, N.
    pub(crate) fn tension_of_pose(&self, lever: &Lever, pose: HoldPose) -> Result<f64, Fault> {
        if !(pose.share > 0.0 && pose.share.is_finite()) {
            return Err(Fault::new("HoldPose::share", "is not above zero"));
        }
        if pose.mass.is_some_and(|m| !(m > 0.0 && m.is_finite())) {
            return Err(Fault::new("HoldPose::mass", "is not above zero"));
        }
        let moves = [0, 1].map(|end| lever.free(end) > 0.0);
        let end = match (pose.load, moves) {
            (HeldEnd::A, [true, _]) | (HeldEnd::Moving, [true, false]) => 0,
            (HeldEnd::B, [_, true]) | (HeldEnd::Moving, [false, true]) => 1,
            (HeldEnd::Moving, [true, true]) => {
                return fault(
                    "cannot tell which of two ends that move is the load; use HoldPose::of_a() or HoldPose::of_b()",
                );
            }
            _ => return fault("has a load that cannot move along the element"),
        };
        let hold = &lever.line.holds[end];
        let Some(body) = hold.body.map(|index| &lever.bodies[index]) else {
            return fault("has a load that cannot move along the element");
        };
        let mass = pose.mass.map(f64::from);
        let share = f64::from(pose.share);
        let alone = self.tension_alone(lever, end, mass);
        match alone {
            Some((tension, true)) => return Ok(share * tension),
            None => return fault("has a load that joints hold without the element"),
            Some((_, false)) if hold.twist => {
                return fault("finds no joint that its load turns on");
            }
            Some((_, false)) => {}
        }
        let weight = weight(body, mass);
        let Some(down) = weight.try_normalize() else {
            return Ok(0.0);
        };
        let along = lever.line.direction.dot(down);
        if along.abs() < LEVEL {
            return fault(
                "stands on an element that is level, so no tension of it holds a weight (levers on joints between bodies \
                 that move are not looked at: give Preload)",
            );
        }
        let sign = if end == 0 { -1.0 } else { 1.0 };
        Ok(sign * share * weight.length() / along)
    }
}

/// Weight of a body, N. If `mass` (kg) is given, it replaces the mass of the body.
fn weight(body: &Body, mass: Option<f64>) -> DVec3 {
    let own = body.inverse_mass.max_element().recip();
    let mass = mass.unwrap_or(own);
    if mass.is_finite() {
        mass * body.acceleration
    } else {
        DVec3::ZERO
    }
}
