//! Mechanical energy of bodies and elements, and its removal from the motion.

use super::body::{Body, Spin};
use super::delivery::free_inertia;
use super::element::Element;
use bevy::math::DVec3;

/// Greatest error of a length by rounding in one step, in units of rounding of the greatest coordinate of its ends: one unit in
/// each of four substeps, which are Rapier's default, at each of two ends. Pinned by
/// `energy::tests::rounding_in_four_substeps_changes_a_length_by_less_than_is_allowed_for`.
pub(super) const ROUNDINGS: f64 = 8.0;

/// Mechanical energy, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Energy {
    /// Kinetic energy.
    pub motion: f64,
    /// Energy stored in springs.
    pub stored: f64,
    /// Potential energy in gravity and the users' forces, minus the work of the users' torques in this step.
    pub potential: f64,
}

impl Energy {
    /// Energy of all bodies and elements in their present state.
    pub(crate) fn of(elements: &[Element], bodies: &[Body]) -> Self {
        let mut energy = Self::default();
        for body in bodies {
            energy.motion += body.motion();
            energy.potential -=
                (body.mass() * body.acceleration).dot(body.position) + body.torque_work;
        }
        for element in elements {
            energy.stored += element.elastic(element.distance(bodies).0).energy;
        }
        energy
    }

    pub(crate) fn sum(&self) -> f64 {
        self.motion + self.stored + self.potential
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
        let change = slowed_by(rate, line.inverse_mass, taken);
        line.push(bodies, change / line.inverse_mass);
        left -= taken;
    }
    surplus - left
}

/// Change of a rate (m/s) that removes `energy` (J) from the motion along a line with this inverse effective mass (1/kg). It stops
/// the motion at most.
pub(super) fn slowed_by(rate: f64, inverse_mass: f64, energy: f64) -> f64 {
    let left = (rate * rate - 2.0 * inverse_mass * energy).max(0.0).sqrt();
    left.copysign(rate) - rate
}

impl Body {
    /// Mass along each world axis, kg; zero on a locked axis.
    pub(crate) fn mass(&self) -> DVec3 {
        let w = self.inverse_mass;
        DVec3::select(w.cmpgt(DVec3::ZERO), w.recip(), DVec3::ZERO)
    }

    /// Kinetic energy, J.
    pub(crate) fn motion(&self) -> f64 {
        0.5 * (self.mass() * self.velocity).dot(self.velocity) + self.rotational()
    }

    /// Kinetic energy of its rotation, J.
    pub(crate) fn rotational(&self) -> f64 {
        let twice = match self.spin {
            Spin::Ignored => 0.0,
            Spin::Free { momentum } => momentum.dot(self.angular_velocity()),
            Spin::Locked { velocity } => {
                let (inertia, free) = free_inertia(self.inverse_inertia());
                let velocity = free * velocity;
                velocity.dot(inertia * velocity)
            }
        };
        0.5 * twice
    }
}

#[cfg(test)]
mod tests {
    use super::super::bound::Bound;
    use super::super::step::Component;
    use super::super::tests::{DT, point, row};
    use super::*;

    #[test]
    fn a_surplus_is_taken_from_a_chain_at_once_though_each_element_disturbs_its_neighbours() {
        let bodies: Vec<Body> = [3.0, -1.0, 4.0, -4.0, 1.0, -3.0]
            .into_iter()
            .enumerate()
            .map(|(at, speed)| {
                let mut body = point(1.0, DVec3::X * at as f64, DVec3::ZERO);
                body.velocity = DVec3::X * speed;
                body
            })
            .collect();
        let Component { elements, .. } = row(bodies.clone(), 1e3);
        let energy = Energy::of(&elements, &bodies);
        let mut bound = Bound::default();
        // Since it was as lively a moment ago, a little more than what it is to have left passes the check.
        bound.finish(&energy, DT);
        for share in [0.1, 0.5, 0.8, 0.95] {
            let mut bodies = bodies.clone();
            bound.forget();
            bound.start((1.0 - share) * energy.sum(), 0.0, 0.0, false);
            let left = bound
                .hold(&elements, &mut bodies, DT)
                .map(|left| left.sum());
            let most = (1.0 - share + 0.021) * energy.sum();
            assert!(
                left.is_some_and(|left| left < most),
                "{left:?} J, not {most}"
            );
        }
    }

    #[test]
    fn rounding_in_four_substeps_changes_a_length_by_less_than_is_allowed_for() {
        let (substep, mut worst) = (1.0 / 240.0_f32, 0.0_f64);
        // Ends side by side and at opposite sides of the world, that move by less than a millimetre or by metres in a step.
        for (a, b) in [(1000.0, 1001.0), (-700.0, 900.0), (3.0, 500.0)] {
            for at in 0..20_000 {
                let share = f64::from(at) / 20_000.0;
                let places = [a + share, b - 0.37 * share];
                let mut length = 0.0;
                for (place, sign) in places.into_iter().zip([-1.0, 1.0]) {
                    let velocity = (sign * (0.01 + 500.0 * share * share)) as f32;
                    let mut rounded = place as f32;
                    let exact = f64::from(rounded) + 4.0 * f64::from(substep) * f64::from(velocity);
                    for _ in 0..4 {
                        rounded += velocity * substep;
                    }
                    length += sign * (f64::from(rounded) - exact);
                }
                let reach = f64::max(a.abs(), b.abs()) + 9.0;
                worst = worst.max(length.abs() / (reach * f64::from(f32::EPSILON)));
            }
        }
        // Errors add up to a good part of what they could be.
        assert!(
            (0.2 * ROUNDINGS..ROUNDINGS).contains(&worst),
            "{worst} units"
        );
    }
}
