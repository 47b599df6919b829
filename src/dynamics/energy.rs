//! Mechanical energy of bodies and elements, and its removal from the motion.

use super::body::{Body, Spin};
use super::element::Element;
use bevy::math::DVec3;

/// Greatest error of a length by rounding in one step, in units of rounding of the greatest coordinate of its ends: one unit in
/// each of four substeps, which are Rapier's default, at each of two ends.
pub(super) const ROUNDINGS: f64 = 8.0;

/// Mechanical energy, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Energy {
    /// Kinetic energy.
    pub motion: f64,
    /// Energy stored in springs.
    pub stored: f64,
    /// Potential energy in gravity and the users' forces, minus the work of the users' torques in this step.
    pub place: f64,
}

impl Energy {
    /// Energy of all bodies and elements in their present state.
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

/// Removes energy from the motion along the elements: `surplus` (J), or as much as there is. Returns the removed energy, J.
/// Each element gets a pair of opposite impulses along its line, which conserves linear and angular momentum (on an axis of
/// the world only linear momentum).
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
    /// Mass along each world axis, kg; zero on a locked axis.
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
