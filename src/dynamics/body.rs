//! A rigid body as the integrator sees it: its state, free flight, impulses and inverse inertia.

use bevy::math::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// How a body can turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spin {
    /// Rotation has no effect: it is fully locked, or no element turns the body.
    Ignored,
    /// Free rotation. It is stored as angular momentum, which is exactly constant in free flight.
    Free {
        /// Angular momentum, kg m²/s, world frame.
        momentum: DVec3,
    },
    /// Rotation about some axes is locked or has no inertia. It is stored as angular velocity (rad/s, world frame), as in
    /// the engine.
    Locked { velocity: DVec3 },
}

/// A dynamic body: state, inertia, and what acts on it besides elements. SI units; world frame unless a field says
/// otherwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    /// Position of the centre of mass.
    pub position: DVec3,
    /// Velocity of the centre of mass.
    pub velocity: DVec3,
    /// Rotation from the body's frame to the world.
    pub rotation: DQuat,
    pub spin: Spin,
    /// Inverse mass along each world axis; zero on a locked axis.
    pub inverse_mass: DVec3,
    /// Principal moments of inertia.
    pub inertia: DVec3,
    /// Rotation from the frame of the principal axes to the body's frame.
    pub principal: DQuat,
    /// Whether rotation about each world axis is locked.
    pub rotation_locked: [bool; 3],
    /// Greatest rotation by the engine in a step, rad.
    pub farthest_turn: f64,
    /// Acceleration from everything but elements: gravity and the user's force.
    pub acceleration: DVec3,
    /// The user's torque.
    pub torque: DVec3,
    /// Impulse (N s) and angular impulse (N m s) from elements so far in this step.
    pub given: (DVec3, DVec3),
    /// Work of the user's torque so far in this step, J.
    pub torque_work: f64,
    /// Inverse inertia that [`Body::note_turn`] has stored.
    pub turned: Option<Turned>,
}

/// Inverse inertia in the world frame, and the rotation to which it belongs. It is stored because it is used many times
/// until the rotation changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned {
    rotation: DQuat,
    inverse_inertia: DMat3,
}

/// The rotation of a rotation vector (exponential map).
pub(crate) fn turn(by: DVec3) -> DQuat {
    DQuat::from_scaled_axis(by)
}

/// Of the two quaternions of a rotation, returns the one that turns by at most half a turn.
pub(crate) fn shortest(rotation: DQuat) -> DQuat {
    if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    }
}

/// Whether an inverse mass is the same along all axes.
pub(super) fn is_same_along_all_axes(inverse_mass: DVec3) -> bool {
    inverse_mass.x == inverse_mass.y && inverse_mass.y == inverse_mass.z
}

/// Rotation vector of a rotation. Of all that differ by whole turns, returns the one nearest to `expected`.
pub(crate) fn unwound(rotation: DQuat, expected: DVec3) -> DVec3 {
    let by = shortest(rotation).to_scaled_axis();
    let axis = by.try_normalize().unwrap_or_default();
    by + ((expected - by).dot(axis) / TAU).round() * TAU * axis
}

/// Whether a body can move or turn by `by` in `time` seconds and end with `velocity`, at a constant rate of change and
/// never faster than `fastest`.
#[inline]
pub(crate) fn is_within(by: DVec3, velocity: DVec3, fastest: f64, time: f64) -> bool {
    let first = 2.0 / time * by - velocity;
    first.length_squared().max(velocity.length_squared()) <= fastest * fastest
}

/// Limits the displacement in a step and the velocity at its end to what a body can reach if it moves by at most
/// `farthest`. Returns `None` if they need no limit.
fn held_back(by: DVec3, velocity: DVec3, farthest: f64, time: f64) -> Option<(DVec3, DVec3)> {
    let fastest = farthest / time;
    if is_within(by, velocity, fastest, time) {
        return None;
    }
    let last = velocity.clamp_length_max(fastest);
    let first = (2.0 / time * by - last).clamp_length_max(fastest);
    Some((0.5 * time * (first + last), last))
}

impl Body {
    /// Inverse inertia in the world frame at the present rotation, 1/(kg m²); zero about locked axes.
    pub(crate) fn inverse_inertia(&self) -> DMat3 {
        self.with_inverse_inertia(DMat3::ZERO, |inverse| *inverse)
    }

    /// Angular acceleration by a torque, or change of the angular velocity by an angular impulse. World frame.
    #[inline]
    pub(crate) fn turned_by(&self, torque: DVec3) -> DVec3 {
        self.with_inverse_inertia(DVec3::ZERO, |inverse| *inverse * torque)
    }

    /// Returns what `take` makes of the inverse inertia, or `nothing` if no element turns the body.
    #[inline(always)]
    fn with_inverse_inertia<T>(&self, nothing: T, take: impl Fn(&DMat3) -> T) -> T {
        if self.spin == Spin::Ignored {
            return nothing;
        }
        match &self.turned {
            Some(t) if t.rotation == self.rotation => take(&t.inverse_inertia),
            _ => take(&self.turn_inertia()),
        }
    }

    /// Computes the inverse inertia at the present rotation and stores it.
    pub(crate) fn note_turn(&mut self) {
        if self.spin != Spin::Ignored {
            self.turned = Some(Turned {
                rotation: self.rotation,
                inverse_inertia: self.turn_inertia(),
            });
        }
    }

    fn turn_inertia(&self) -> DMat3 {
        // Elements do not turn a body that has no inertia about some axis.
        if self.inertia.min_element() <= 0.0 {
            return DMat3::ZERO;
        }
        let inverse = self.inertia.recip();
        let mut world = if inverse.x == inverse.y && inverse.y == inverse.z {
            DMat3::from_diagonal(inverse)
        } else {
            let frame = DMat3::from_quat(self.rotation * self.principal);
            frame * DMat3::from_diagonal(inverse) * frame.transpose()
        };
        for (axis, _) in self.rotation_locked.iter().enumerate().filter(|(_, l)| **l) {
            for other in 0..3 {
                world.col_mut(axis)[other] = 0.0;
                world.col_mut(other)[axis] = 0.0;
            }
        }
        world
    }

    pub(crate) fn angular_velocity(&self) -> DVec3 {
        match self.spin {
            Spin::Ignored => DVec3::ZERO,
            Spin::Free { momentum } => self.turned_by(momentum),
            Spin::Locked { velocity } => velocity,
        }
    }

    /// Sets the angular velocity (rad/s, world frame) at the present rotation.
    pub(crate) fn set_angular_velocity(&mut self, velocity: DVec3) {
        self.spin = match self.spin {
            Spin::Ignored => Spin::Ignored,
            Spin::Locked { .. } => Spin::Locked { velocity },
            Spin::Free { .. } => {
                let frame = self.rotation * self.principal;
                Spin::Free {
                    momentum: frame * (self.inertia * (frame.inverse() * velocity)),
                }
            }
        };
    }

    /// Gyroscopic acceleration of free flight at an angular velocity, rad/s²; zero unless rotation is free.
    pub(crate) fn precession(&self, velocity: DVec3) -> DVec3 {
        if !matches!(self.spin, Spin::Free { .. }) {
            return DVec3::ZERO;
        }
        let frame = self.rotation * self.principal;
        let spin = frame.inverse() * velocity;
        frame * ((self.inertia * spin).cross(spin) / self.inertia)
    }

    /// Free flight for `time` seconds: uniform motion, and rotation with constant angular momentum (with locked axes:
    /// constant angular velocity).
    pub(crate) fn drift(&mut self, time: f64) {
        self.position += time * self.velocity;
        let power = self.user_power();
        match self.spin {
            Spin::Ignored => {}
            Spin::Locked { velocity } => {
                self.rotation = (turn(time * velocity) * self.rotation).normalize();
            }
            Spin::Free { momentum } => self.tumble(time, momentum),
        }
        self.note_turn();
        self.torque_work += 0.5 * time * (power + self.user_power());
    }

    /// Power of the user's torque, W.
    fn user_power(&self) -> f64 {
        if self.torque == DVec3::ZERO {
            0.0
        } else {
            self.torque.dot(self.angular_velocity())
        }
    }

    /// Rotation of a free rigid body: that of a symmetric top between two halves of the remaining part. It is exact for
    /// symmetric tops, and otherwise time-symmetric and of second order. It conserves the angular momentum of any body,
    /// however thin. (Splitting of the kinetic energy after R. McLachlan, 1993.)
    fn tumble(&mut self, time: f64, momentum: DVec3) {
        if momentum == DVec3::ZERO {
            return;
        }
        let inertia = self.inertia;
        let mut frame = self.rotation * self.principal;
        // The axis of the top is the one whose other two inverse moments of inertia are most alike.
        let apart = |a: f64, b: f64| (1.0 / a - 1.0 / b).abs();
        let spread = [
            apart(inertia.y, inertia.z),
            apart(inertia.z, inertia.x),
            apart(inertia.x, inertia.y),
        ];
        let own = (0..3)
            .min_by(|a, b| spread[*a].total_cmp(&spread[*b]))
            .unwrap_or(0);
        let (left, other) = ((own + 1) % 3, (own + 2) % 3);
        let about = |frame: &DQuat, axis: usize, rate: f64, time: f64| {
            let direction = DVec3::AXES[axis];
            let speed = (frame.inverse() * momentum)[axis] * rate;
            DQuat::from_axis_angle(direction, time * speed)
        };
        let rest = 1.0 / inertia[left] - 1.0 / inertia[other];
        if rest != 0.0 {
            frame *= about(&frame, left, rest, 0.5 * time);
        }
        let top = 1.0 / inertia[own] - 1.0 / inertia[other];
        if top != 0.0 {
            frame *= about(&frame, own, top, time);
        }
        frame = turn(time / inertia[other] * momentum) * frame;
        if rest != 0.0 {
            frame *= about(&frame, left, rest, 0.5 * time);
        }
        self.rotation = (frame * self.principal.inverse()).normalize();
    }

    /// Whether the inverse mass is the same along all axes.
    pub(crate) fn moves_alike(&self) -> bool {
        is_same_along_all_axes(self.inverse_mass)
    }

    /// The force that gives the body an acceleration, N.
    pub(crate) fn force_for(&self, acceleration: DVec3) -> DVec3 {
        super::delivery::force_for(acceleration, self.inverse_mass)
    }

    /// Applies an element's impulse (N s) at `arm` from the centre of mass.
    pub(crate) fn apply(&mut self, impulse: DVec3, arm: DVec3) {
        self.given.0 += impulse;
        self.velocity += self.inverse_mass * impulse;
        if arm == DVec3::ZERO {
            return;
        }
        let angular = arm.cross(impulse);
        self.given.1 += angular;
        self.apply_angular(angular);
    }

    /// Applies an element's angular impulse (N m s).
    pub(crate) fn apply_twist(&mut self, impulse: DVec3) {
        self.given.1 += impulse;
        self.apply_angular(impulse);
    }

    /// Applies an angular impulse (N m s) without counting it as an element's.
    fn apply_angular(&mut self, impulse: DVec3) {
        match self.spin {
            Spin::Ignored => {}
            Spin::Free { momentum } => {
                self.spin = Spin::Free {
                    momentum: momentum + impulse,
                };
            }
            Spin::Locked { velocity } => {
                self.spin = Spin::Locked {
                    velocity: velocity + self.turned_by(impulse),
                };
            }
        }
    }

    /// Applies gravity and the user's force and torque for `time` seconds.
    pub(crate) fn apply_external(&mut self, time: f64) {
        self.velocity += time * self.acceleration;
        self.apply_angular(time * self.torque);
    }

    /// Sets linear and angular velocity to `share` of those of `other`.
    pub(crate) fn slow_to(&mut self, other: &Self, share: f64) {
        self.velocity = share * other.velocity;
        self.spin = match other.spin {
            Spin::Ignored => Spin::Ignored,
            Spin::Free { momentum } => Spin::Free {
                momentum: share * momentum,
            },
            Spin::Locked { velocity } => Spin::Locked {
                velocity: share * velocity,
            },
        };
    }

    /// Computes the impulses that elements must have given the body since the state `start`, and stores them in `given`.
    pub(crate) fn receive(&mut self, start: &Self, time: f64) {
        let turned = match (self.spin, start.spin) {
            (Spin::Free { momentum: now }, Spin::Free { momentum: then }) => now - then,
            // Only about free axes, because nothing turns the body about locked ones.
            (Spin::Locked { velocity: now }, Spin::Locked { velocity: then }) => {
                super::delivery::torque_for(now - then, start.inverse_inertia())
            }
            _ => DVec3::ZERO,
        };
        self.given = (
            self.force_for(self.velocity - start.velocity - time * self.acceleration),
            turned - time * self.torque,
        );
    }

    /// Limits motion and rotation since the state `start` to what the engine allows. Returns whether either was more.
    pub(crate) fn hold_back(&mut self, start: &Self, farthest_move: f64, time: f64) -> bool {
        let moved = held_back(
            self.position - start.position,
            self.velocity,
            farthest_move,
            time,
        );
        if let Some((by, velocity)) = moved {
            self.position = start.position + by;
            self.velocity = velocity;
        }
        if self.spin == Spin::Ignored || self.farthest_turn == f64::INFINITY {
            return moved.is_some();
        }
        let spin = 0.5 * (start.angular_velocity() + self.angular_velocity());
        let by = unwound(self.rotation * start.rotation.inverse(), time * spin);
        let turned = held_back(by, self.angular_velocity(), self.farthest_turn, time);
        if let Some((held, velocity)) = turned {
            if held != by {
                self.rotation = (turn(held) * start.rotation).normalize();
                self.torque_work = self.torque.dot(held);
                self.note_turn();
            }
            self.set_angular_velocity(velocity);
        }
        moved.is_some() || turned.is_some()
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.velocity.is_finite()
            && self.rotation.is_finite()
            && self.angular_velocity().is_finite()
    }
}
