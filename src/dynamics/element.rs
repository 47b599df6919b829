//! An element between two ends: how its ends are held, its line, and its forces.

use super::body::{Body, Spin, turn};
use super::flight::Flight;
use super::guide::Guide;
use super::hold::Hold;
use super::law::{Drag, Elastic, Law};
use super::line::{AT_ORIGIN, COINCIDENT, Line};
use super::thresholds::is_damper_stiff;
use bevy::math::{DQuat, DVec3};
use std::sync::Arc;

/// How an end of an element is held.
#[derive(Clone, Copy, Debug)]
pub(crate) enum End {
    /// On a dynamic body. `arm` is the vector from its centre of mass in the body's frame, m.
    Body { index: usize, arm: DVec3 },
    /// At a point with prescribed motion: on a fixed or kinematic body, or a plain entity.
    Path(Path),
}

/// A point with prescribed motion, and its frame. World frame, SI units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    pub position: DVec3,
    pub velocity: DVec3,
    pub rotation: DQuat,
    /// Angular velocity.
    pub turning: DVec3,
}

impl Path {
    /// A point whose frame does not turn.
    pub(crate) const fn straight(position: DVec3, velocity: DVec3) -> Self {
        Self {
            position,
            velocity,
            rotation: DQuat::IDENTITY,
            turning: DVec3::ZERO,
        }
    }
}

/// A spring, a damper or both, as the integrator sees it.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub ends: [End; 2],
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping, N s/m.
    pub damping: f64,
    /// Rest length, m.
    pub rest_length: f64,
    /// Direction or axis of its force. For a twist, angles take the place of lengths.
    pub guide: Guide,
    /// Force law that replaces stiffness and damping.
    pub law: Option<Arc<Law>>,
    /// Twist at the start of the micro-step, rad, including full turns.
    pub angle: f64,
    /// Energy that its damping has turned into heat so far in this step, J.
    pub heat: f64,
    /// Work of its ends with prescribed motion so far in this step, J.
    pub work: f64,
    /// Last well-defined direction from end A to end B at the start of a micro-step; see [`Element::aim`].
    pub direction: Option<DVec3>,
    /// Whether the damper is strong. Then a spring of zero rest length is not treated as isotropic.
    pub stiff_damper: bool,
}

impl End {
    pub(super) fn hold(&self, bodies: &[Body]) -> Hold {
        match *self {
            End::Path(path) => Hold {
                body: None,
                arm: DVec3::ZERO,
                inverse_mass: DVec3::ZERO,
                twist: false,
                position: path.position,
            },
            End::Body { index, arm } => {
                let body = &bodies[index];
                if body.spin == Spin::Ignored && arm == DVec3::ZERO {
                    return Hold {
                        body: Some(index),
                        arm,
                        inverse_mass: body.inverse_mass,
                        twist: false,
                        position: body.position,
                    };
                }
                let arm = body.rotation * arm;
                Hold {
                    body: Some(index),
                    arm,
                    inverse_mass: body.inverse_mass,
                    twist: false,
                    position: body.position + arm,
                }
            }
        }
    }

    /// Whether the end is at the centre of mass of a body, or has prescribed motion.
    pub(super) fn is_central(&self) -> bool {
        match self {
            End::Body { arm, .. } => *arm == DVec3::ZERO,
            End::Path(_) => true,
        }
    }

    pub(crate) fn is_path(&self) -> bool {
        matches!(self, End::Path(_))
    }

    /// Position of the held point.
    fn position(&self, bodies: &[Body]) -> DVec3 {
        match *self {
            End::Path(path) => path.position,
            End::Body { index, arm } if arm == DVec3::ZERO => bodies[index].position,
            End::Body { index, arm } => bodies[index].position + bodies[index].rotation * arm,
        }
    }

    /// Moves a point with prescribed motion by `time` seconds.
    pub(crate) fn drift(&mut self, time: f64) {
        if let End::Path(path) = self {
            path.position += time * path.velocity;
            if path.turning != DVec3::ZERO {
                path.rotation = (turn(time * path.turning) * path.rotation).normalize();
            }
        }
    }

    /// Rotation from the frame that holds the end to the world.
    pub(crate) fn rotation(&self, bodies: &[Body]) -> DQuat {
        match *self {
            End::Path(path) => path.rotation,
            End::Body { index, .. } => bodies[index].rotation,
        }
    }

    pub(crate) fn angular_velocity(&self, bodies: &[Body]) -> DVec3 {
        match *self {
            End::Path(path) => path.turning,
            End::Body { index, .. } => bodies[index].angular_velocity(),
        }
    }

    /// Motion of the body or the frame that holds the end, for bodies whose motion `flight` returns.
    #[inline]
    pub(super) fn flight_of(&self, flight: impl Fn(usize) -> Flight) -> Flight {
        match *self {
            End::Path(path) => Flight {
                velocity: path.velocity,
                turning: path.turning,
                ..Flight::default()
            },
            End::Body { index, .. } => flight(index),
        }
    }

    /// Returns the velocity of the held point, its acceleration from external forces, and its acceleration in free flight.
    pub(super) fn motion(&self, hold: &Hold, bodies: &[Body]) -> (DVec3, DVec3, DVec3) {
        self.motion_of(hold, |index| bodies[index].flight())
    }

    /// Like [`Self::motion`], for bodies whose motion `flight` returns.
    #[inline]
    pub(super) fn motion_of(
        &self,
        hold: &Hold,
        flight: impl Fn(usize) -> Flight,
    ) -> (DVec3, DVec3, DVec3) {
        let Flight {
            velocity,
            acceleration,
            turning,
            pushed,
            free,
        } = self.flight_of(flight);
        if hold.arm == DVec3::ZERO {
            return (velocity, acceleration, DVec3::ZERO);
        }
        let swing = turning.cross(hold.arm);
        (
            velocity + swing,
            acceleration + pushed.cross(hold.arm),
            free.cross(hold.arm) + turning.cross(swing),
        )
    }
}

/// Distance up to which two points count as coincident, because it may be rounding, m.
pub(crate) fn rounding(a: DVec3, b: DVec3) -> f64 {
    COINCIDENT * a.abs().max(b.abs()).max_element().max(AT_ORIGIN)
}

/// Returns the vector from end A to end B, and whether it is longer than [`rounding`].
fn separation([a, b]: [DVec3; 2]) -> (DVec3, bool) {
    let d = b - a;
    (d, d.length() > rounding(a, b))
}

impl Element {
    /// Inverse effective mass along the line, if it does not depend on the line's direction: no body of the element turns,
    /// each has the same inverse mass along all axes, and the ends are apart.
    pub(crate) fn plain_inverse_mass(&self, bodies: &[Body]) -> Option<f64> {
        if self.guide != Guide::Centres {
            return None;
        }
        let mut places = [DVec3::ZERO; 2];
        let mut sum = 0.0;
        for (place, end) in places.iter_mut().zip(&self.ends) {
            *place = match end {
                End::Path(path) => path.position,
                End::Body { index, .. } => {
                    let body = &bodies[*index];
                    if body.spin != Spin::Ignored || !body.moves_alike() {
                        return None;
                    }
                    sum += body.inverse_mass.x;
                    body.position
                }
            };
        }
        let [a, b] = places;
        (a.distance(b) > rounding(a, b)).then_some(sum)
    }

    /// Stores on which side of end A end B is before a drift. A stiff spring far from rest drifts through the centre and is
    /// kicked back within one step. Its force must not reverse meanwhile. For a twist, counts full turns instead.
    pub(crate) fn aim(&mut self, bodies: &[Body], step: f64) {
        if self.guide != Guide::Centres {
            self.count_turns(bodies);
            return;
        }
        let places = self.ends.each_ref().map(|end| end.position(bodies));
        if let (d, true) = separation(places) {
            self.direction = Some(d.normalize());
        }
        self.stiff_damper = false;
        if self.rest_length != 0.0 || self.damping == 0.0 {
            return;
        }
        let along = self.direction.unwrap_or(DVec3::Y);
        let holds = self.ends.each_ref().map(|end| end.hold(bodies));
        let inverse_mass: f64 = holds
            .iter()
            .map(|h| h.inverse_mass_along(along, bodies))
            .sum();
        let z = self.stiffness * inverse_mass * step * step;
        self.stiff_damper = is_damper_stiff(z, self.damping * inverse_mass * step);
    }

    /// Returns the line at this instant, or `None` if the ends coincide and no direction is known. The length between
    /// centres is negative while end B is on the far side of end A during a drift.
    pub(crate) fn line(&self, bodies: &[Body]) -> Option<Line> {
        if self.guide != Guide::Centres {
            return self.guided_line(bodies);
        }
        let holds = [self.ends[0].hold(bodies), self.ends[1].hold(bodies)];
        let (d, apart) = separation(holds.each_ref().map(|hold| hold.position));
        let isotropic = self.rest_length == 0.0 && !self.stiff_damper && self.law.is_none();
        let direction = match (apart, self.direction) {
            (true, None) => d.normalize(),
            (true, Some(side)) => d.normalize() * if d.dot(side) < 0.0 { -1.0 } else { 1.0 },
            (false, Some(side)) => side,
            (false, None) if self.rest_length == 0.0 => {
                // Relative velocity and acceleration give the direction. If both are zero, any axis will do.
                let [a, b] = [0, 1].map(|i| self.ends[i].motion(&holds[i], bodies));
                let hint = (b.0 - a.0) + (b.1 - a.1);
                hint.try_normalize().unwrap_or(DVec3::Y)
            }
            (false, None) => return None,
        };
        let inverse_masses = holds
            .each_ref()
            .map(|hold| hold.inverse_mass_along(direction, bodies));
        Some(Line {
            holds,
            length: d.dot(direction),
            direction,
            inverse_masses,
            inverse_mass: inverse_masses.iter().sum(),
            isotropic,
            guided: false,
        })
    }

    /// Returns the length as [`Line::distance`] gives it, and the largest coordinate of the ends; zeros without a line.
    pub(crate) fn distance(&self, bodies: &[Body]) -> (f64, f64) {
        if self.guide != Guide::Centres {
            return self
                .guided_line(bodies)
                .map_or((0.0, 0.0), |line| (line.length, line.reach()));
        }
        let [a, b] = self.ends.each_ref().map(|end| end.position(bodies));
        (a.distance(b), a.abs().max(b.abs()).max_element())
    }

    /// Tension without damping, its slope, and the stored energy. A length between centres is negative only during a drift,
    /// while end B is on the far side of end A.
    pub(crate) fn elastic(&self, length: f64) -> Elastic {
        match &self.law {
            Some(law) => law.elastic(length, self.rest_length),
            None => Elastic::linear(self.stiffness, length - self.rest_length),
        }
    }

    /// Tension from damping, and its slope.
    pub(crate) fn drag(&self, length: f64, rate: f64) -> Drag {
        match &self.law {
            Some(law) => law.drag(length, self.rest_length, rate),
            None => Drag {
                force: self.damping * rate,
                slope: self.damping,
            },
        }
    }

    /// Tension of spring and damper together, N.
    pub(crate) fn tension(&self, length: f64, rate: f64) -> f64 {
        self.elastic(length).force + self.drag(length, rate).force
    }

    /// Whether a force law gives finite numbers at a length and rate.
    pub(crate) fn is_sound(&self, length: f64, rate: f64) -> bool {
        if self.law.is_none() {
            return true;
        }
        let (elastic, drag) = (self.elastic(length), self.drag(length, rate));
        [
            elastic.force,
            elastic.stiffness,
            elastic.energy,
            drag.force,
            drag.slope,
        ]
        .iter()
        .all(|x| x.is_finite())
    }

    /// Greatest slope of the spring's force between a length and `length + way`, N/m.
    pub(crate) fn stiffness_ahead(&self, length: f64, way: f64) -> f64 {
        match &self.law {
            Some(law) => law.stiffest([length, length + way], self.rest_length),
            None => self.stiffness,
        }
    }
}
