//! One end of an element's line at an instant, and how easily it moves.

use super::body::{Body, is_same_along_all_axes};
use bevy::math::DVec3;

/// One end of a line at an instant. World frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    /// Index of the dynamic body, if there is one.
    pub body: Option<usize>,
    /// Vector from the centre of mass to the point at which the force acts, m.
    pub arm: DVec3,
    pub inverse_mass: DVec3,
    /// Whether the element turns the body about an axis instead of pushing it.
    pub twist: bool,
    pub position: DVec3,
}

impl Hold {
    /// Upper bound on the inverse effective mass along any direction.
    pub(crate) fn most_inverse_mass(&self, bodies: &[Body]) -> f64 {
        let sum = |levers: [DVec3; 3]| -> f64 {
            let turned = levers.map(|lever| lever.dot(self.turned_by(lever, bodies)));
            turned.iter().sum()
        };
        if self.twist {
            return sum(DVec3::AXES);
        }
        let levers = DVec3::AXES.map(|axis| self.arm.cross(axis));
        self.inverse_mass.max_element() + sum(levers)
    }

    /// Angular acceleration of its body by a torque.
    #[inline]
    fn turned_by(&self, torque: DVec3, bodies: &[Body]) -> DVec3 {
        self.body
            .map_or(DVec3::ZERO, |index| bodies[index].turned_by(torque))
    }

    /// Inverse effective mass of this end along a direction, 1/kg.
    pub(crate) fn inverse_mass_along(&self, direction: DVec3, bodies: &[Body]) -> f64 {
        if self.twist {
            return direction.dot(self.turned_by(direction, bodies));
        }
        let w = self.inverse_mass;
        // The direction would add rounding. Without it, equal lines have bitwise equal coefficients.
        let linear = if is_same_along_all_axes(w) {
            w.x
        } else {
            (w * direction).dot(direction)
        };
        if self.arm == DVec3::ZERO {
            return linear;
        }
        let lever = self.arm.cross(direction);
        linear + lever.dot(self.turned_by(lever, bodies))
    }
}
