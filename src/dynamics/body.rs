//! A rigid body as the integrator sees it: free flight, impulses, inverse inertia.

use bevy::math::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// How a body can turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Spin {
    /// Rotation plays no part: fully locked, or every element holds the body at its centre.
    Ignored,
    /// Free rotation, carried as angular momentum, which free flight keeps exactly.
    Free {
        /// kg m²/s, world frame.
        momentum: DVec3,
    },
    /// Some rotation axes locked: carried as angular velocity (rad/s, world frame), as the engine does.
    Locked { velocity: DVec3 },
}

/// One dynamic body: state, inertia, and what acts on it besides elements. World frame, SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    /// Centre of mass.
    pub position: DVec3,
    /// Of the centre of mass.
    pub velocity: DVec3,
    /// From the body's frame to the world.
    pub rotation: DQuat,
    pub spin: Spin,
    /// Per world axis; zero on a locked axis.
    pub inverse_mass: DVec3,
    /// Principal moments of inertia, and the frame they belong to within the body.
    pub inertia: DVec3,
    pub principal: DQuat,
    /// World axes about which the body cannot turn.
    pub rotation_locked: [bool; 3],
    /// How far the engine turns it in a step, rad.
    pub farthest_turn: f64,
    /// Acceleration by everything but elements: gravity and the user's force.
    pub acceleration: DVec3,
    /// The user's torque.
    pub torque: DVec3,
    /// What elements have given it so far in this step: impulse (N s) and angular impulse (N m s).
    pub given: (DVec3, DVec3),
    /// Work of the user's torque so far in this step, J.
    pub torque_work: f64,
    /// What [`Body::note_turn`] has found.
    pub turned: Option<Turned>,
}

/// Inverse inertia in the world frame, and for which rotation: it is asked for many times between one rotation and the
/// next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turned {
    rotation: DQuat,
    inverse_inertia: DMat3,
}

/// exp of a rotation vector.
pub(crate) fn turn(by: DVec3) -> DQuat {
    DQuat::from_scaled_axis(by)
}

/// The one of both equal rotations that turns less than half a turn.
pub(crate) fn shortest(rotation: DQuat) -> DQuat {
    if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    }
}

/// The rotation vector of a rotation: of all that come to the same, the nearest to the one that is expected.
pub(crate) fn unwound(rotation: DQuat, expected: DVec3) -> DVec3 {
    let by = shortest(rotation).to_scaled_axis();
    let axis = by.try_normalize().unwrap_or_default();
    by + ((expected - by).dot(axis) / TAU).round() * TAU * axis
}

/// Whether the engine flies or turns a body so far, to such a velocity, at a steady rate and never faster.
#[inline]
pub(crate) fn is_within(by: DVec3, velocity: DVec3, fastest: f64, time: f64) -> bool {
    let first = 2.0 / time * by - velocity;
    first.length_squared().max(velocity.length_squared()) <= fastest * fastest
}

/// Displacement and velocity at the end of a step as near as it gets to these, if it does not get there.
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
    /// Inverse inertia in the world frame at the present rotation; zero where locked.
    pub(crate) fn inverse_inertia(&self) -> DMat3 {
        // A body without inertia about some axis is not turned by elements at all.
        if self.spin == Spin::Ignored {
            return DMat3::ZERO;
        }
        match &self.turned {
            Some(t) if t.rotation == self.rotation => t.inverse_inertia,
            _ => self.turn_inertia(),
        }
    }

    /// Works out the inverse inertia at the present rotation, for all who will ask.
    pub(crate) fn note_turn(&mut self) {
        if self.spin != Spin::Ignored {
            self.turned = Some(Turned {
                rotation: self.rotation,
                inverse_inertia: self.turn_inertia(),
            });
        }
    }

    fn turn_inertia(&self) -> DMat3 {
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
            Spin::Free { momentum } => self.inverse_inertia() * momentum,
            Spin::Locked { velocity } => velocity,
        }
    }

    /// The spin that has this angular velocity at the present rotation.
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

    /// Angular acceleration of free flight with such an angular velocity, of a body that can turn about all axes.
    pub(crate) fn precession(&self, velocity: DVec3) -> DVec3 {
        if !matches!(self.spin, Spin::Free { .. }) {
            return DVec3::ZERO;
        }
        let frame = self.rotation * self.principal;
        let spin = frame.inverse() * velocity;
        frame * ((self.inertia * spin).cross(spin) / self.inertia)
    }

    /// Angular acceleration by the user's torque, and the gyroscopic one of free flight.
    pub(crate) fn angular_acceleration(&self, inverse_inertia: DMat3) -> (DVec3, DVec3) {
        let pushed = inverse_inertia * self.torque;
        match self.spin {
            Spin::Free { momentum } => (
                pushed,
                inverse_inertia * momentum.cross(inverse_inertia * momentum),
            ),
            Spin::Ignored | Spin::Locked { .. } => (pushed, DVec3::ZERO),
        }
    }

    /// Free flight: straight, and turning with constant angular momentum.
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

    /// A free rigid body as a symmetric top between two halves of what is left: exact for tops, second
    /// order and its own mirror image in time for the rest, momentum kept by all, however thin the body.
    /// (Splitting of the kinetic energy after R. McLachlan, 1993.)
    fn tumble(&mut self, time: f64, momentum: DVec3) {
        if momentum == DVec3::ZERO {
            return;
        }
        let inertia = self.inertia;
        let mut frame = self.rotation * self.principal;
        // The axis that is most unlike the other two is the top's own.
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

    /// Whether its inverse mass is the same along all axes.
    pub(crate) fn moves_alike(&self) -> bool {
        let w = self.inverse_mass;
        w.x == w.y && w.y == w.z
    }

    /// The force for an acceleration.
    pub(crate) fn force_for(&self, acceleration: DVec3) -> DVec3 {
        super::delivery::force_for(acceleration, self.inverse_mass)
    }

    /// An impulse (N s) at `arm` from the centre of mass, with the inverse inertia at hand.
    pub(crate) fn apply(&mut self, impulse: DVec3, arm: DVec3, inverse_inertia: DMat3) {
        self.given.0 += impulse;
        self.velocity += self.inverse_mass * impulse;
        if arm == DVec3::ZERO {
            return;
        }
        let angular = arm.cross(impulse);
        self.given.1 += angular;
        self.apply_angular(angular, inverse_inertia);
    }

    /// An angular impulse (N m s) by an element.
    pub(crate) fn apply_twist(&mut self, impulse: DVec3, inverse_inertia: DMat3) {
        self.given.1 += impulse;
        self.apply_angular(impulse, inverse_inertia);
    }

    /// An angular impulse (N m s).
    pub(crate) fn apply_angular(&mut self, impulse: DVec3, inverse_inertia: DMat3) {
        match &mut self.spin {
            Spin::Ignored => {}
            Spin::Free { momentum } => *momentum += impulse,
            Spin::Locked { velocity } => *velocity += inverse_inertia * impulse,
        }
    }

    /// Gravity and the user's force and torque over a time.
    pub(crate) fn apply_external(&mut self, time: f64, inverse_inertia: DMat3) {
        self.velocity += time * self.acceleration;
        self.apply_angular(time * self.torque, inverse_inertia);
    }

    /// Takes a share of another's velocities.
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

    /// Works out what elements must have given it since it was `start`.
    pub(crate) fn receive(&mut self, start: &Self, time: f64) {
        let turned = match (self.spin, start.spin) {
            (Spin::Free { momentum: now }, Spin::Free { momentum: then }) => now - then,
            // Along free axes; along others nothing turns it.
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

    /// Moves and turns no further since it was `start` than the engine will take it; says whether it would have.
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
