//! Mechanical energy of bodies and elements, and taking some of it out of the motion.

use super::body::{Body, Spin};
use super::element::Element;
use bevy::math::DVec3;

/// J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Energy {
    /// Kinetic.
    pub motion: f64,
    /// In the springs.
    pub stored: f64,
    /// Potential in gravity and the users' forces, less the work of their torques in this step.
    pub place: f64,
}

impl Energy {
    /// Of all bodies and elements as they stand.
    pub(crate) fn of(elements: &[Element], bodies: &[Body]) -> Self {
        let mut energy = Self::default();
        for body in bodies {
            energy.motion += body.motion();
            energy.place -= (body.mass() * body.acceleration).dot(body.position) + body.torque_work;
        }
        for element in elements {
            energy.stored += element.elastic(element.distance(bodies).0).energy;
        }
        energy
    }

    pub(crate) fn sum(&self) -> f64 {
        self.motion + self.stored + self.place
    }
}

/// Takes so much energy out of the motion along the elements, as far as there is any, by impulse pairs
/// along their lines, which keep both momenta; returns how much.
pub(crate) fn take(elements: &[Element], bodies: &mut [Body], surplus: f64) -> f64 {
    let mut left = surplus;
    for element in elements {
        if left <= 0.0 {
            break;
        }
        let Some(line) = element.line(bodies).filter(|l| l.inverse_mass > 0.0) else {
            continue;
        };
        let rate = line.motion(element, bodies, 0.0).axial;
        let taken = left.min(0.5 * rate * rate / line.inverse_mass);
        let after = (rate * rate - 2.0 * line.inverse_mass * taken)
            .max(0.0)
            .sqrt();
        line.push(bodies, (after.copysign(rate) - rate) / line.inverse_mass);
        left -= taken;
    }
    surplus - left
}

impl Body {
    /// Per world axis, kg; zero on a locked axis.
    pub(crate) fn mass(&self) -> DVec3 {
        let w = self.inverse_mass;
        DVec3::select(w.cmpgt(DVec3::ZERO), w.recip(), DVec3::ZERO)
    }

    /// Kinetic energy, J.
    pub(crate) fn motion(&self) -> f64 {
        0.5 * (self.mass() * self.velocity).dot(self.velocity) + self.turning()
    }

    /// Kinetic energy of its rotation, J.
    pub(crate) fn turning(&self) -> f64 {
        let twice = match self.spin {
            Spin::Ignored => 0.0,
            Spin::Free { momentum } => momentum.dot(self.angular_velocity()),
            Spin::Locked { velocity } => {
                let mut inverse = self.inverse_inertia();
                let mut free = velocity;
                for k in 0..3 {
                    if inverse.col(k)[k] == 0.0 {
                        inverse.col_mut(k)[k] = 1.0;
                        free[k] = 0.0;
                    }
                }
                free.dot(inverse.inverse() * free)
            }
        };
        0.5 * twice
    }
}
