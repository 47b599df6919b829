//! What an element acts along: the line of centres, a given axis, or a twist about one.
//!
//! Each is one generalised coordinate (a length or an angle), its rate is linear in the velocities, and the
//! force on the bodies is its gradient, so that energy is kept whichever it is.

use super::body::Body;
use super::element::{Element, Hold};
use super::line::{Line, Motion};
use crate::functions::atan2;
use bevy::math::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// Unit vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Guide {
    /// From end to end.
    #[default]
    Centres,
    /// Along an axis of the world: each end is pushed at its own point, so the pair is not free of torque.
    World(DVec3),
    /// Along an axis of end A's frame: end A is pushed where end B is, as by a slide on it.
    OfA(DVec3),
    /// About an axis of end A's frame.
    Twist(DVec3),
}

impl Guide {
    /// Whether it is a twist, not a length.
    pub(crate) fn is_twist(self) -> bool {
        matches!(self, Self::Twist(_))
    }

    /// Whether it turns bodies even where it holds them at their centres.
    pub(crate) fn turns(self) -> bool {
        matches!(self, Self::OfA(_) | Self::Twist(_))
    }
}

/// Least cos² of half the tilt between both axes: beyond, within a degree of half a turn, a twist has no meaning.
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
                holds[0].inverse_inertia = holds[0].inverse_inertia_of(bodies);
                (axis, d.dot(axis))
            }
            Guide::Twist(axis) => {
                for hold in &mut holds {
                    hold.inverse_inertia = hold.inverse_inertia_of(bodies);
                    hold.twist = true;
                }
                let (gradient, angle) = self.twist(axis, bodies)?;
                (gradient, self.angle + wrapped(angle - self.angle))
            }
        };
        let inverse_mass = holds.iter().map(|h| h.inverse_mass_along(direction)).sum();
        Some(Line {
            holds,
            length,
            direction,
            inverse_mass,
            isotropic: false,
            guided: true,
        })
    }

    /// Twist of end B against end A about an axis of A's (swing–twist decomposition), within a turn, and its
    /// gradient with respect to rotation vectors of the world: the axis itself where that is common.
    fn twist(&self, axis: DVec3, bodies: &[Body]) -> Option<(DVec3, f64)> {
        twist(axis, self.ends.each_ref().map(|end| end.rotation(bodies)))
    }

    /// What it acts about where its ends are turned like this, if it is a torsion element.
    pub(crate) fn twist_gradient(&self, ends: [DQuat; 2]) -> Option<DVec3> {
        match self.guide {
            Guide::Twist(axis) => Some(twist(axis, ends)?.0),
            _ => None,
        }
    }

    /// Notes the twist, so that full turns are counted.
    pub(super) fn count_turns(&mut self, bodies: &[Body]) {
        if let Guide::Twist(axis) = self.guide
            && let Some((_, angle)) = self.twist(axis, bodies)
        {
            self.angle += wrapped(angle - self.angle);
        }
    }
}

/// Twist of one frame against another, and its gradient: see [`Element::twist`].
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

/// An angle less whole turns, so that it is within half a turn, rad.
fn wrapped(angle: f64) -> f64 {
    let within = angle.rem_euclid(TAU);
    if within > PI { within - TAU } else { within }
}

impl Hold {
    fn inverse_inertia_of(&self, bodies: &[Body]) -> bevy::math::DMat3 {
        self.body.map_or(bevy::math::DMat3::ZERO, |index| {
            bodies[index].inverse_inertia()
        })
    }
}

impl Line {
    pub(super) fn guided_motion(&self, element: &Element, bodies: &[Body]) -> Motion {
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
            for ((end, hold), sign) in element.ends.iter().zip(&self.holds).zip([-1.0, 1.0]) {
                motion.axial += sign * u.dot(end.angular_velocity(bodies));
                if let Some(index) = hold.body {
                    let (pushed, free) = bodies[index].angular_acceleration(hold.inverse_inertia);
                    motion.pushed += sign * u.dot(pushed);
                    motion.arms += sign * u.dot(free);
                }
            }
            return motion;
        }
        let [a, b] = [0, 1].map(|i| element.ends[i].motion(&self.holds[i], bodies));
        motion.axial = (b.0 - a.0).dot(u);
        motion.pushed = (b.1 - a.1).dot(u);
        motion.arms = (b.2 - a.2).dot(u);
        if let Guide::OfA(_) = element.guide {
            // Seen from a frame that turns.
            let turning = element.ends[0].angular_velocity(bodies);
            motion.arms -= 2.0 * turning.cross(b.0 - a.0).dot(u);
        }
        motion
    }
}
