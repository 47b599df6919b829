//! The kick of a lone element on its bodies, in closed form with exact poles.
//!
//! a_out is the axial acceleration of the separation from everything but the element, and r = ω²·stretch − a_out. With the
//! coefficients of [`Poles`], the axial acceleration over the step is −restoring·r − loss/h·rate. The element's own part is
//! this minus a_out.

use super::body::{Body, Spin};
use super::element::Element;
use super::line::{Line, Motion};
use super::poles::Poles;
use super::thresholds::{converges, is_resolved};

/// The last coefficients. If no body turns, they are the same for every kick of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Memo {
    /// (ω h)² of these coefficients; NaN before the first ones.
    z: f64,
    /// γh of these coefficients; NaN before the first ones.
    g: f64,
    /// Coefficients that nothing has asked for yet are NaN.
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
    /// Returns the poles for z = (ω h)² and g = γh.
    #[inline]
    pub(crate) fn poles(&mut self, z: f64, g: f64) -> Poles {
        let known = self.z == z && self.g == g;
        if !known || self.poles.restoring.is_nan() || self.poles.speed.is_nan() {
            let poles = Poles::new(z, g);
            *self = Self { z, g, poles };
        }
        self.poles
    }

    /// Returns `restoring` and `loss` of the poles. Where the length changes z, the other two would be of no use.
    pub(crate) fn of_kick(&mut self, z: f64, g: f64) -> [f64; 2] {
        self.turn_to(z, g);
        let poles = &mut self.poles;
        if poles.restoring.is_nan() {
            [poles.restoring, poles.loss] = Poles::of_kick(z, g);
        }
        [poles.restoring, poles.loss]
    }

    /// Returns `speed` and `skew` of the poles.
    pub(crate) fn of_map(&mut self, z: f64, g: f64) -> [f64; 2] {
        self.turn_to(z, g);
        let poles = &mut self.poles;
        if poles.speed.is_nan() {
            [poles.speed, poles.skew] = Poles::of_map(z, g);
        }
        [poles.speed, poles.skew]
    }

    /// Forgets the coefficients if they are those of other numbers.
    fn turn_to(&mut self, z: f64, g: f64) {
        if self.z != z || self.g != g {
            let poles = Poles::UNKNOWN;
            *self = Self { z, g, poles };
        }
    }
}

/// (ω h)² and γh of an element on a line for a step.
fn numbers(element: &Element, line: &Line, step: f64) -> [f64; 2] {
    [
        element.stiffness * line.inverse_mass * step * step,
        element.damping * line.inverse_mass * step / 2.0,
    ]
}

/// ω²·stretch − a_out at a length, m/s². `outside` is a_out.
fn residual_acceleration(element: &Element, line: &Line, length: f64, outside: f64) -> f64 {
    element.stiffness * line.inverse_mass * (length - element.rest_length) - outside
}

/// Applies the kick after the first half drift: element and external forces together.
pub(crate) fn kick(element: &Element, bodies: &mut [Body], step: f64, memo: &mut Memo) {
    let Some(line) = element.line(bodies) else {
        return external(bodies, step);
    };
    let [z, g] = numbers(element, &line, step);
    let [restoring, loss] = memo.of_kick(z, g);
    let before = line.motion(element, bodies, step);
    let rate = line.backward_rate(&before, step);
    let impulse = |outside: f64, drifted: f64| {
        let residual_acceleration =
            residual_acceleration(element, &line, line.length - drifted, outside);
        if line.inverse_mass <= 0.0 {
            // The element can move neither end, but its force still acts on them.
            let stretch = line.length - drifted - element.rest_length;
            return -step * (element.stiffness * stretch + element.damping * rate);
        }
        let total = -restoring * residual_acceleration - loss / step * rate;
        step * (total - outside) / line.inverse_mass
    };
    if swings_across(&line, bodies) && !is_resolved(z) {
        // The line turns too fast to separate axial from lateral motion, so both lose the same share.
        line.push_across(bodies, -loss * before.lateral);
    }
    // a_out depends on the lateral speed, which the kick changes. The mean of before and after makes the step time-symmetric,
    // so that its error has only even powers of the step.
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

/// Applies an impulse along the line, and the external forces.
fn act(line: &Line, bodies: &mut [Body], impulse: f64, step: f64) {
    line.push(bodies, impulse);
    external(bodies, step);
}

/// Applies the external forces alone.
pub(crate) fn external(bodies: &mut [Body], step: f64) {
    for body in bodies {
        body.apply_external(step);
    }
}

/// Direction of the velocity map between the true and the stepped motion.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Map {
    ToStepped,
    ToTrue,
}

/// Maps the axial velocity so that the step becomes the exact axial flow.
///
/// The map is a pair of impulses along the line at the true positions, so it conserves linear and angular momentum. The map
/// after one step is undone before the next. So in the long run the motion is that of the drift–kick–drift step, which is
/// time-symmetric and has no energy drift.
pub(crate) fn map_velocity(
    element: &Element,
    line: &Line,
    bodies: &mut [Body],
    step: f64,
    map: Map,
    memo: &mut Memo,
) {
    if line.inverse_mass <= 0.0 {
        return;
    }
    let [z, g] = numbers(element, line, step);
    let [speed, skew] = memo.of_map(z, g);
    let motion = line.motion(element, bodies, step);
    let residual_acceleration = residual_acceleration(element, line, line.length, motion.outside());
    let offset = skew * step * residual_acceleration;
    let mapped = match map {
        Map::ToStepped => (motion.axial - offset) / speed,
        Map::ToTrue => speed * motion.axial + offset,
    };
    line.push(bodies, (mapped - motion.axial) / line.inverse_mass);
    if swings_across(line, bodies) {
        map_lateral(bodies, line, &motion, map, z, &memo.poles(z, g));
    }
}

/// Whether the element is an isotropic spring, which also oscillates across its line, and no body turns. On turning bodies,
/// a pair of impulses across the line would be a torque.
fn swings_across(line: &Line, bodies: &[Body]) -> bool {
    line.isotropic && bodies.iter().all(|body| body.spin == Spin::Ignored)
}

/// Maps the velocity across the line. `z` is (ω h)².
fn map_lateral(
    bodies: &mut [Body],
    line: &Line,
    motion: &Motion,
    map: Map,
    z: f64,
    coefficients: &Poles,
) {
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

/// Whether a step resolves the element's oscillation and decay, so that extrapolation converges, and the turning of its line.
pub(crate) fn resolved(element: &Element, bodies: &[Body], step: f64) -> bool {
    let Some(line) = element.line(bodies) else {
        return false;
    };
    let z = element.stiffness * line.inverse_mass * step * step;
    let Motion { lateral_square, .. } = line.motion(element, bodies, step);
    let turned = step * step * lateral_square;
    let decay = element.damping * line.inverse_mass * step;
    converges(z, decay) && (line.isotropic || turned < line.length * line.length)
}
