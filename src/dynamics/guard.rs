//! Prevents a lone element with a strong damper from gaining energy.
//!
//! With strong damping, the map between true and stepped velocities is steep. If the line or an arm turns within the step,
//! a little lateral motion can become much motion along the line. The energy shows how much of it is wrong.

use super::body::Body;
use super::element::{Element, End};
use super::energy::slowed_by;
use super::line::Line;
use super::thresholds::{ROUNDED_GAIN, STRONG};
use bevy::math::DVec3;

/// Mechanical energy at the start of a step, in the frame of an end with prescribed motion.
pub(crate) struct Guard {
    energy: f64,
    frame: DVec3,
}

impl Guard {
    /// Begins the check if the element is strongly damped, no user's torque acts on its bodies, and no end with prescribed
    /// motion turns. Torques and turning ends do work that is not accounted for here. `line` is the element's.
    pub(crate) fn begin(
        element: &Element,
        bodies: &[Body],
        line: Option<&Line>,
        step: f64,
    ) -> Option<Self> {
        let line = line?;
        let known = bodies.iter().all(|b| b.torque == DVec3::ZERO);
        let turns = |end: &End| matches!(end, End::Path(path) if path.turning != DVec3::ZERO);
        let known = known && !element.ends.iter().any(turns);
        if !known || element.damping * line.inverse_mass * step < STRONG {
            return None;
        }
        let frame = element
            .ends
            .iter()
            .find_map(|end| match end {
                End::Path(path) => Some(path.velocity),
                End::Body { .. } => None,
            })
            .unwrap_or(DVec3::ZERO);
        let mut guard = Self { energy: 0.0, frame };
        guard.energy = guard.energy_of(element, bodies, 0.0)?;
        Some(guard)
    }

    /// Removes gained energy from the motion along the line.
    pub(crate) fn end(&self, element: &Element, bodies: &mut [Body], step: f64) {
        let (Some(line), Some(energy)) =
            (element.line(bodies), self.energy_of(element, bodies, step))
        else {
            return;
        };
        let surplus = energy - self.energy;
        if surplus <= ROUNDED_GAIN * self.energy.abs() || line.inverse_mass <= 0.0 {
            return;
        }
        let rate = line.motion(element, bodies, step).axial;
        let change = slowed_by(rate, line.inverse_mass, surplus);
        line.push(bodies, change / line.inverse_mass);
    }

    /// Kinetic and stored energy, and potential energy in the external forces, `time` seconds after the start, J.
    fn energy_of(&self, element: &Element, bodies: &[Body], time: f64) -> Option<f64> {
        let line = element.line(bodies)?;
        let stretch = line.length - element.rest_length;
        let mut sum = 0.5 * element.stiffness * stretch * stretch;
        for body in bodies {
            let (mass, velocity) = (body.mass(), body.velocity - self.frame);
            let place = body.position - time * self.frame;
            sum += 0.5 * (mass * velocity).dot(velocity) - (mass * body.acceleration).dot(place);
            sum += body.rotational();
        }
        Some(sum)
    }
}
