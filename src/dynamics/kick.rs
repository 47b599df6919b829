//! One element alone on its bodies: the closed form, with exact poles.
//!
//! With r = ω²·stretch − a_out (the acceleration that the element has yet to answer) and the
//! coefficients of [`Poles`], the relative axial acceleration over the step is
//! −restoring·r − loss/h·rate. The element's own share of it is that less a_out.

use super::body::Body;
use super::element::{Element, Line, Motion};
use super::poles::Poles;

/// The poles of an element on this line for a step.
fn poles(element: &Element, line: &Line, step: f64) -> Poles {
    Poles::new(
        element.stiffness * line.inverse_mass * step * step,
        element.damping * line.inverse_mass * step / 2.0,
    )
}

/// ω²·stretch − a_out.
fn unanswered(element: &Element, line: &Line, outside: f64) -> f64 {
    element.stiffness * line.inverse_mass * (line.length - element.rest_length) - outside
}

/// The kick at the half drift: element and outside forces together.
pub(crate) fn kick(element: &mut Element, bodies: &mut [Body], step: f64) {
    let Some(line) = element.line(bodies) else {
        return external(bodies, step);
    };
    element.direction = Some(line.direction);
    if line.inverse_mass <= 0.0 {
        return external(bodies, step);
    }
    let poles = poles(element, &line, step);
    let before = line.motion(element, bodies, step);
    let rate = line.backward_rate(&before, step);
    let impulse = |outside: f64| {
        let total =
            -poles.restoring * unanswered(element, &line, outside) - poles.loss / step * rate;
        step * (total - outside) / line.inverse_mass
    };
    // What acts from outside depends on the speed across the line, which the kick changes. The mean of
    // before and after makes the step its own mirror image in time, so that its error has even powers
    // of the step only.
    let mut trial = [bodies[0], *bodies.last().unwrap_or(&bodies[0])];
    let trial = &mut trial[..bodies.len()];
    act(&line, trial, impulse(before.outside()), step);
    let after = line.motion(element, trial, step);
    act(
        &line,
        bodies,
        impulse(0.5 * (before.outside() + after.outside())),
        step,
    );
}

fn act(line: &Line, bodies: &mut [Body], impulse: f64, step: f64) {
    line.push(bodies, impulse);
    external(bodies, step);
}

/// Outside forces alone.
pub(crate) fn external(bodies: &mut [Body], step: f64) {
    for body in bodies {
        let inverse_inertia = body.inverse_inertia();
        body.apply_external(step, inverse_inertia);
    }
}

/// Which way to map velocities between the true motion and the stepped one.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Map {
    ToStepped,
    ToTrue,
}

/// The change of axial velocity under which the step becomes the exact axial flow.
///
/// It is an impulse pair along the line at the true positions, so linear and angular momentum stay as
/// they are; and as the map after one step is undone before the next, the long run is that of the
/// drift–kick–drift step, time-symmetric and without energy drift.
pub(crate) fn map_velocity(element: &Element, bodies: &mut [Body], step: f64, map: Map) {
    let Some(line) = element.line(bodies) else {
        return;
    };
    if line.inverse_mass <= 0.0 {
        return;
    }
    let poles = poles(element, &line, step);
    let motion = line.motion(element, bodies, step);
    let axial = motion.axial;
    let offset = poles.skew * step * unanswered(element, &line, motion.outside());
    let mapped = match map {
        Map::ToStepped => (axial - offset) / poles.speed,
        Map::ToTrue => poles.speed * axial + offset,
    };
    line.push(bodies, (mapped - axial) / line.inverse_mass);
}

/// ω h of the element where it stands, and whether the lateral motion is resolved too.
pub(crate) fn resolved(element: &Element, bodies: &[Body], step: f64, limit: f64) -> bool {
    let Some(line) = element.line(bodies) else {
        return false;
    };
    let z = element.stiffness * line.inverse_mass * step * step;
    let Motion { lateral_square, .. } = line.motion(element, bodies, step);
    let turned = step * step * lateral_square;
    z < limit * limit && (line.isotropic || turned < line.length * line.length)
}
