//! One element alone on its bodies: the closed form, with exact poles.
//!
//! With r = ω²·stretch − a_out (the acceleration that the element has yet to answer) and the
//! coefficients of [`Poles`], the relative axial acceleration over the step is
//! −restoring·r − loss/h·rate. The element's own share of it is that less a_out.

use super::body::{Body, Spin};
use super::element::Element;
use super::line::{Line, Motion};
use super::poles::{Poles, RESOLVED_PHASE};

/// The last coefficients: where no body turns they are the same for every kick of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memo {
    /// For which z = (ω h)² and g = γh they are; no number before the first.
    z: f64,
    g: f64,
    poles: Poles,
}

impl Default for Memo {
    fn default() -> Self {
        Self {
            z: f64::NAN,
            g: f64::NAN,
            poles: Poles::default(),
        }
    }
}

impl Memo {
    /// The poles for z = (ω h)² and g = γh.
    pub(crate) fn poles(&mut self, z: f64, g: f64) -> Poles {
        if self.z != z || self.g != g {
            let poles = Poles::new(z, g);
            *self = Self { z, g, poles };
        }
        self.poles
    }
}

/// The poles of an element on this line for a step.
fn poles_of(element: &Element, line: &Line, step: f64, memo: &mut Memo) -> Poles {
    memo.poles(
        element.stiffness * line.inverse_mass * step * step,
        element.damping * line.inverse_mass * step / 2.0,
    )
}

/// ω²·stretch − a_out for a length.
fn residual_acceleration(element: &Element, line: &Line, length: f64, outside: f64) -> f64 {
    element.stiffness * line.inverse_mass * (length - element.rest_length) - outside
}

/// The kick at the half drift: element and outside forces together.
pub(crate) fn kick(element: &Element, bodies: &mut [Body], step: f64, memo: &mut Memo) {
    let Some(line) = element.line(bodies) else {
        return external(bodies, step);
    };
    let poles = poles_of(element, &line, step, memo);
    let before = line.motion(element, bodies, step);
    let rate = line.backward_rate(&before, step);
    let impulse = |outside: f64, drifted: f64| {
        let residual_acceleration =
            residual_acceleration(element, &line, line.length - drifted, outside);
        if line.inverse_mass <= 0.0 {
            // Both ends are held: nothing moves for it, but what holds them feels the force.
            let stretch = line.length - drifted - element.rest_length;
            return -step * (element.stiffness * stretch + element.damping * rate);
        }
        let total = -poles.restoring * residual_acceleration - poles.loss / step * rate;
        step * (total - outside) / line.inverse_mass
    };
    let z = element.stiffness * line.inverse_mass * step * step;
    if swings_across(&line, bodies) && !is_resolved(z) {
        // The line turns too fast to tell along from across: what is lost along it is lost across.
        line.push_across(bodies, -poles.loss * before.lateral);
    }
    // What acts from outside depends on the speed across the line, which the kick changes. The mean of
    // before and after makes the step its own mirror image in time, so that its error has even powers
    // of the step only.
    let after = if line.is_plain(bodies) {
        line.coasted(&before, step)
    } else {
        let mut trial = [bodies[0], *bodies.last().unwrap_or(&bodies[0])];
        let trial = &mut trial[..bodies.len()];
        let first = impulse(before.outside(), before.drifted(step));
        act(&line, trial, first, step);
        line.motion(element, trial, step)
    };
    let mean = |f: &dyn Fn(&Motion) -> f64| 0.5 * (f(&before) + f(&after));
    let second = impulse(mean(&Motion::outside), mean(&|m| m.drifted(step)));
    act(&line, bodies, second, step);
}

/// Element and outside forces.
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
pub(crate) fn map_velocity(
    element: &Element,
    bodies: &mut [Body],
    step: f64,
    map: Map,
    memo: &mut Memo,
) {
    let Some(line) = element.line(bodies) else {
        return;
    };
    if line.inverse_mass <= 0.0 {
        return;
    }
    let coefficients = poles_of(element, &line, step, memo);
    let motion = line.motion(element, bodies, step);
    let residual_acceleration =
        residual_acceleration(element, &line, line.length, motion.outside());
    let offset = coefficients.skew * step * residual_acceleration;
    let mapped = match map {
        Map::ToStepped => (motion.axial - offset) / coefficients.speed,
        Map::ToTrue => coefficients.speed * motion.axial + offset,
    };
    line.push(bodies, (mapped - motion.axial) / line.inverse_mass);
    if swings_across(&line, bodies) {
        map_lateral(element, bodies, &line, &motion, step, map, &coefficients);
    }
}

/// An isotropic spring swings across its line as well as along it. Only where no body turns: a pair of
/// impulses across the line is a torque.
fn swings_across(line: &Line, bodies: &[Body]) -> bool {
    line.isotropic && bodies.iter().all(|body| body.spin == Spin::Ignored)
}

fn map_lateral(
    element: &Element,
    bodies: &mut [Body],
    line: &Line,
    motion: &Motion,
    step: f64,
    map: Map,
    coefficients: &Poles,
) {
    let z = element.stiffness * line.inverse_mass * step * step;
    let speed = if is_resolved(z) {
        coefficients.speed_across(z)
    } else {
        coefficients.speed
    };
    let factor = match map {
        Map::ToStepped => 1.0 / speed,
        Map::ToTrue => speed,
    };
    line.push_across(bodies, (factor - 1.0) * motion.lateral);
}

fn is_resolved(z: f64) -> bool {
    z < RESOLVED_PHASE * RESOLVED_PHASE
}

/// Whether a step resolves the element's oscillation, its decay, and the turning of its line.
pub(crate) fn resolved(element: &Element, bodies: &[Body], step: f64, limit: f64) -> bool {
    let Some(line) = element.line(bodies) else {
        return false;
    };
    let z = element.stiffness * line.inverse_mass * step * step;
    let Motion { lateral_square, .. } = line.motion(element, bodies, step);
    let turned = step * step * lateral_square;
    let decay = element.damping * line.inverse_mass * step;
    z < limit * limit && decay < limit && (line.isotropic || turned < line.length * line.length)
}
