//! The tension with which an element holds its load against gravity.

use super::body::is_movable;
use super::check::Fault;
use super::find::Finder;
use super::held::is_ours;
use super::tune::Lever;
use crate::dynamics::body::Body;
use crate::dynamics::linkage::{Constraint, Side};
use crate::element::{HeldEnd, HoldPose};
use bevy::math::{DMat3, DVec3};
use bevy_rapier3d::rapier::dynamics::{GenericJoint, JointAxesMask, RigidBodyHandle};
use nalgebra::{DMatrix, DVector};

/// Below this cosine between an element and gravity it is level, and no tension of it holds a weight.
const LEVEL: f64 = 0.1;
/// What joints leave of an element's mobility, as a share: below, they hold the load without it.
const HELD: f64 = 1e-4;
/// Share of the greatest diagonal entry that is added to all of them: joints may say the same twice.
const TWICE: f64 = 1e-9;

fn fault<T>(reason: &'static str) -> Result<T, Fault> {
    Err(Fault::new("HoldPose", reason))
}

impl Lever {
    /// The one end that can move along the line, if it is one: `known` says what else holds them.
    pub(super) fn load(&self, left: impl Fn(usize) -> f64) -> Option<usize> {
        let moves = |end: usize| self.line.holds[end].body.is_some() && left(end) > 0.0;
        match [moves(0), moves(1)] {
            [true, false] => Some(0),
            [false, true] => Some(1),
            _ => None,
        }
    }

    /// Inverse mass of an end alone, 1/kg.
    fn free(&self, end: usize) -> f64 {
        self.line.holds[end].inverse_mass_along(self.line.direction)
    }
}

/// What holds a load besides the element: rows of constraints on its body.
struct Held<'a> {
    body: &'a Body,
    inertia: DMat3,
    rows: Vec<Side>,
}

impl Held<'_> {
    /// How much one row moves along another, per impulse.
    fn coupling(&self, a: &Side, b: &Side) -> f64 {
        (self.body.inverse_mass * a.linear).dot(b.linear)
            + (self.inertia * a.angular).dot(b.angular)
    }

    fn push(&mut self, constraint: Constraint) {
        self.rows.extend(constraint.sides.into_iter().flatten());
    }

    fn joint(&mut self, joint: &GenericJoint, frame: bevy::math::DQuat, at: DVec3) {
        let masks = [
            [JointAxesMask::LIN_X, JointAxesMask::ANG_X],
            [JointAxesMask::LIN_Y, JointAxesMask::ANG_Y],
            [JointAxesMask::LIN_Z, JointAxesMask::ANG_Z],
        ];
        for (axis, [linear, angular]) in DVec3::AXES.into_iter().zip(masks) {
            let axis = frame * axis;
            if joint.locked_axes.contains(linear) {
                let body = self.body;
                self.push(Constraint::along(axis, at, [None, Some((0, body))]));
            }
            if joint.locked_axes.contains(angular) {
                self.push(Constraint::about(axis, [None, Some(0)]));
            }
        }
    }

    /// The tension, N, at which the load does not accelerate along the element, whose unit of tension pushes it like
    /// this; none where the joints hold it without.
    fn tension(&self, pull: &Side, weight: DVec3) -> Option<f64> {
        let weight = Side {
            body: 0,
            linear: weight,
            angular: DVec3::ZERO,
        };
        let count = self.rows.len();
        let mut matrix = DMatrix::from_fn(count, count, |i, j| {
            self.coupling(&self.rows[i], &self.rows[j])
        });
        let most = matrix.diagonal().iter().fold(0.0_f64, |m, x| m.max(*x));
        for i in 0..count {
            matrix[(i, i)] += TWICE * most + f64::MIN_POSITIVE;
        }
        let with_pull = DVector::from_fn(count, |i, _| self.coupling(&self.rows[i], pull));
        let with_weight = DVector::from_fn(count, |i, _| self.coupling(&self.rows[i], &weight));
        let reactions = matrix.cholesky()?.solve(&with_pull);
        let free = self.coupling(pull, pull);
        let left = free - reactions.dot(&with_pull);
        let fall = self.coupling(pull, &weight) - reactions.dot(&with_weight);
        (left > HELD * free).then(|| -fall / left)
    }
}

impl Finder<'_, '_> {
    /// The tension that this element alone has to have, N, for its load at one end not to accelerate along it; and
    /// whether joints take part in holding it.
    pub(super) fn tension_alone(
        &self,
        lever: &Lever,
        end: usize,
        mass: Option<f64>,
    ) -> Option<(f64, bool)> {
        let hold = &lever.line.holds[end];
        let index = hold.body?;
        let body = &lever.bodies[index];
        let mut held = Held {
            body,
            inertia: body.inverse_inertia(),
            rows: Vec::new(),
        };
        let handle = lever.handles[index];
        let other = lever.line.holds[1 - end].body.map(|b| lever.handles[b]);
        self.joints_of(lever, handle, other.filter(|_| hold.twist), &mut held);
        // Tension draws end A forward along the line, and end B back.
        let push = if end == 0 { 1.0 } else { -1.0 } * lever.line.direction;
        let pull = Side {
            body: 0,
            linear: if hold.twist { DVec3::ZERO } else { push },
            angular: if hold.twist {
                push
            } else {
                hold.arm.cross(push)
            },
        };
        let tension = held.tension(&pull, weight(body, mass))?;
        Some((tension, !held.rows.is_empty()))
    }

    /// Takes in the joints between a load and what cannot move, or a body that counts as such.
    fn joints_of(
        &self,
        lever: &Lever,
        handle: RigidBodyHandle,
        still: Option<RigidBodyHandle>,
        held: &mut Held,
    ) {
        let Ok((set, _, joints, _)) = self.sets.get(lever.context) else {
            return;
        };
        for (a, b, _, joint) in joints.impulse_joints.attached_enabled_joints(handle) {
            let other = if a == handle { b } else { a };
            let [Some(first), Some(second)] = [a, b].map(|handle| set.bodies.get(handle)) else {
                continue;
            };
            let moves = if a == handle { second } else { first };
            if is_ours(joint) || (is_movable(moves) && Some(other) != still) {
                continue;
            }
            let data = &joint.data;
            let frame = (*first.position() * data.local_frame1).rotation;
            let at = (*second.position() * data.local_frame2).translation;
            held.joint(data, frame.as_dquat().normalize(), at.as_dvec3());
        }
    }

    /// The tension that an element has to have to carry its share of its load, N.
    pub(super) fn tension_of_pose(&self, lever: &Lever, pose: HoldPose) -> Result<f64, Fault> {
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
            return fault("stands on an element that is level, so no tension of it holds a weight");
        }
        let sign = if end == 0 { -1.0 } else { 1.0 };
        Ok(sign * share * weight.length() / along)
    }
}

/// Of a body, or of as much mass in its place, N.
fn weight(body: &Body, mass: Option<f64>) -> DVec3 {
    let own = body.inverse_mass.max_element().recip();
    let mass = mass.unwrap_or(own);
    if mass.is_finite() {
        mass * body.acceleration
    } else {
        DVec3::ZERO
    }
}
