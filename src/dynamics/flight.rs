//! Motion of a body at an instant, which all elements at the body share.

use super::body::{Body, Spin};
use bevy::math::DVec3;

/// Motion of a body at an instant, and what changes it besides elements. World frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flight {
    /// Velocity of the centre of mass, m/s.
    pub velocity: DVec3,
    /// Acceleration of the centre of mass, m/s².
    pub acceleration: DVec3,
    /// Angular velocity, rad/s.
    pub turning: DVec3,
    /// Angular acceleration from the user's torque, rad/s².
    pub pushed: DVec3,
    /// Gyroscopic acceleration, rad/s².
    pub free: DVec3,
}

impl Body {
    /// Its motion at the present instant.
    #[inline]
    pub(crate) fn flight(&self) -> Flight {
        let mut flight = Flight {
            velocity: self.velocity,
            acceleration: self.acceleration,
            ..Flight::default()
        };
        if self.spin != Spin::Ignored {
            self.add_turning(&mut flight);
        }
        flight
    }

    fn add_turning(&self, flight: &mut Flight) {
        if self.torque != DVec3::ZERO {
            flight.pushed = self.turned_by(self.torque);
        }
        match self.spin {
            Spin::Free { momentum } => {
                flight.turning = self.turned_by(momentum);
                flight.free = self.turned_by(momentum.cross(flight.turning));
            }
            Spin::Locked { velocity } => flight.turning = velocity,
            Spin::Ignored => {}
        }
    }

    /// Its motion at the same place, after it gained a velocity and an angular velocity since `before`.
    pub(crate) fn flight_after(&self, before: &Flight, gained: [DVec3; 2]) -> Flight {
        let turning = before.turning + gained[1];
        Flight {
            velocity: before.velocity + gained[0],
            turning,
            free: self.precession(turning),
            ..*before
        }
    }
}
