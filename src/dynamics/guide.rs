//! What an element acts along: the line between its ends, a given axis, or a twist about an axis.
//!
//! Each of them is one generalised coordinate (a length or an angle). Its rate is linear in the velocities, and the force on
//! the bodies is along its gradient. So each of them conserves energy.

use super::body::Body;
use super::element::Element;
use super::flight::Flight;
use super::line::{Line, Motion};
use crate::functions::atan2;
use bevy::math::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// What an element acts along. Axes are unit vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Guide {
    /// The line from end to end.
    #[default]
    Centres,
    /// An axis of the world. Each end is pushed at its own point, so the pair of forces has a torque.
    World(DVec3),
    /// An axis of end A's frame. The force on end A acts at the point of end B, as from a slider on the axis.
    OfA(DVec3),
    /// A twist about an axis of end A's frame.
    Twist(DVec3),
}

impl Guide {
    /// Whether it is a twist, not a length.
    pub(crate) fn is_twist(self) -> bool {
        matches!(self, Self::Twist(_))
    }

    /// Whether it turns bodies even if it holds them at their centres of mass.
    pub(crate) fn turns(self) -> bool {
        matches!(self, Self::OfA(_) | Self::Twist(_))
    }
}

/// Least cos² of half the angle between the axes of both ends. Beyond it, within about a degree of half a turn, a twist is not
/// defined. Pinned by `laws::torsion::a_rest_angle_is_taken_where_the_angle_has_a_meaning`.
const UPRIGHT: f64 = 1e-4;

impl Element {
    pub(super) fn guided_line(&self, bodies: &[Body]) -> Option<Line> {
        let mut holds = [self.ends[0].hold(bodies), self.ends[1].hold(bodies)];
        let d = holds[1].position - holds[0].position;
        let (direction, length) = match self.guide {
            Guide::Centres => return None,
            Guide::World(axis) => (axis, d.dot(axis)),
            Guide::OfA(axis) => {
                let axis = self.ends[0].rotation(bodies) * axis;
                holds[0].arm += d;
                (axis, d.dot(axis))
            }
            Guide::Twist(axis) => {
                for hold in &mut holds {
                    hold.twist = true;
                }
                let (gradient, angle) = self.twist(axis, bodies)?;
                (gradient, self.angle + wrapped(angle - self.angle))
            }
        };
        let inverse_masses = holds
            .each_ref()
            .map(|hold| hold.inverse_mass_along(direction, bodies));
        Some(Line {
            holds,
            length,
            direction,
            inverse_masses,
            inverse_mass: inverse_masses.iter().sum(),
            isotropic: false,
            guided: true,
        })
    }

    /// Returns the gradient of the twist with respect to rotation vectors of the world, and the twist within one turn, rad.
    /// The twist is that of end B relative to end A about an axis of A (swing–twist decomposition). The gradient is the axis
    /// itself if both ends share it.
    fn twist(&self, axis: DVec3, bodies: &[Body]) -> Option<(DVec3, f64)> {
        twist(axis, self.ends.each_ref().map(|end| end.rotation(bodies)))
    }

    /// Gradient of the twist at given rotations of the ends, if it is a torsion element.
    pub(crate) fn twist_gradient(&self, ends: [DQuat; 2]) -> Option<DVec3> {
        match self.guide {
            Guide::Twist(axis) => Some(twist(axis, ends)?.0),
            _ => None,
        }
    }

    /// Stores the twist, so that full turns are counted.
    pub(super) fn count_turns(&mut self, bodies: &[Body]) {
        if let Guide::Twist(axis) = self.guide
            && let Some((_, angle)) = self.twist(axis, bodies)
        {
            self.angle += wrapped(angle - self.angle);
        }
    }
}

/// Returns the gradient of the twist and the twist of `other` relative to `frame`; see [`Element::twist`].
fn twist(axis: DVec3, [frame, other]: [DQuat; 2]) -> Option<(DVec3, f64)> {
    let q = frame.inverse() * other;
    let (v, w) = (q.xyz(), q.w);
    let along = v.dot(axis);
    let square = w * w + along * along;
    if square < UPRIGHT {
        return None;
    }
    let gradient = (w * w * axis + w * v.cross(axis) + along * v) / square;
    Some((frame * gradient, 2.0 * atan2(along, w)))
}

/// Removes whole turns from an angle, so that it is at most half a turn, rad.
fn wrapped(angle: f64) -> f64 {
    let within = angle.rem_euclid(TAU);
    if within > PI { within - TAU } else { within }
}

impl Line {
    /// See [`Line::motion_of`].
    pub(super) fn guided_motion(
        &self,
        element: &Element,
        flight: &impl Fn(usize) -> Flight,
    ) -> Motion {
        let u = self.direction;
        let mut motion = Motion {
            axial: 0.0,
            lateral_square: 0.0,
            lateral: DVec3::ZERO,
            pushed_across: DVec3::ZERO,
            pushed: 0.0,
            arms: 0.0,
            turning: 0.0,
        };
        if self.holds[0].twist {
            for (end, sign) in element.ends.iter().zip([-1.0, 1.0]) {
                let flight = end.flight_of(flight);
                motion.axial += sign * u.dot(flight.turning);
                motion.pushed += sign * u.dot(flight.pushed);
                motion.arms += sign * u.dot(flight.free);
            }
            return motion;
        }
        let [a, b] = [0, 1].map(|i| element.ends[i].motion_of(&self.holds[i], flight));
        motion.axial = (b.0 - a.0).dot(u);
        motion.pushed = (b.1 - a.1).dot(u);
        motion.arms = (b.2 - a.2).dot(u);
        if let Guide::OfA(_) = element.guide {
            // Coriolis acceleration, because the axis turns with end A.
            let turning = element.ends[0].flight_of(flight).turning;
            motion.arms -= 2.0 * turning.cross(b.0 - a.0).dot(u);
        }
        motion
    }
}
