//! The kick of a lone element whose line turns: of fourth order in the step, and exact for uniform rotation.
//!
//! A drift–kick–drift step can be exact along a line that does not turn (see [`super::poles`]). Where the line turns, straight
//! drifts leave the arc on which the ends move. Take a separation of length L that moves at the rate a along and s across its
//! line, under the pull F of spring and damper per effective mass, and the acceleration g across it from everything else. The
//! Taylor series of the motion and of the step h then differ in third order by
//!
//! - a rotation of separation and velocity by h³·F·s/(12·L²),
//! - an impulse along the line of h³·F·s²/(8·L²),
//! - an impulse across the line of −h³·F·g/(6·L),
//! - with damping c per effective mass, an impulse along the line of h³·c·(g·s/(2·L) − a·s²/(2·L²)).
//!
//! The kick of this module adds them, so that the error is of fourth order (third with damping). The first two are given by
//! functions that agree with them to this order and make uniform rotation exact. All are central or rotations, so without
//! outside accelerations the angular momentum is kept. Without damping the kick is the same backwards in time, so energy does
//! not drift. `arc::tests` checks orders, uniform rotation, angular momentum, and energy.

use super::pair::{Line, Pair, Separation};
use super::poles::Poles;
use super::thresholds::is_resolved;

/// Square of the way of an end per length of the line, within a micro-step, up to which the turning is resolved and from which on
/// it is not. Beyond the first, the corrections fade out, because near a close passage they would change the energy for good.
/// Pinned by `arc::tests::close_passages_do_not_add_up_in_the_energy`.
pub(super) const RESOLVED_SWEEP: [f64; 2] = [0.25, 1.0];

/// Greatest magnitude of h²·F/L for which the corrections count. The series of [`tilt`] converges slowly beyond. Reached only
/// where the sweep is large as well.
pub(super) const MOST_PULL: f64 = 2.0;

/// Factor by which the error falls if the number of micro-steps is doubled, without damping. Extrapolation uses it.
pub(super) const HALVED: f64 = 16.0;

/// Number of iterations that find the motion across the line in the middle of the kick. With one, the kick is not quite the same
/// backwards, and a whirled stiff spring loses a ten-thousandth of its energy in five minutes.
pub(super) const ROUNDS: usize = 2;

/// Coefficients of q, q², … in [`tilt`].
pub(super) const TILT: [f64; 8] = [
    1.0 / 24.0,
    7.0 / 480.0,
    19.0 / 4_480.0,
    859.0 / 725_760.0,
    20_897.0 / 63_866_880.0,
    125_011.0 / 1_383_782_400.0,
    74_624_437.0 / 2_988_969_984_000.0,
    2_457_750_121.0 / 355_687_428_096_000.0,
];

/// Tangent of half the rotation that a micro-step lacks, as a multiple of h·s/L, for h²·F/L = `pull`.
///
/// In uniform rotation by the angle x = 2·tan φ per micro-step, drifts and kick turn the line by 2φ, h·s/L is sin 2φ in the
/// middle of the micro-step, and h²·F/L is 4·sin²φ. This is the series of tan(tan φ − φ)/sin 2φ.
fn tilt(pull: f64) -> f64 {
    let terms = TILT.iter().rev();
    terms.fold(0.0, |sum, coefficient| (sum + coefficient) * pull)
}

/// The share of the corrections that counts, where an end moves by the square root of `sweep` lengths of the line.
fn fade(sweep: f64) -> f64 {
    let [from, to] = RESOLVED_SWEEP;
    let beyond = ((sweep - from) / (to - from)).clamp(0.0, 1.0);
    let left = 1.0 - beyond * beyond;
    left * left
}

impl Pair {
    /// Applies the kick after the first half drift, for a line of some length that has an axis.
    pub(super) fn kick_in_arc(
        &self,
        state: &mut Separation,
        line: &Line,
        poles: &Poles,
        step: f64,
    ) {
        let Line {
            direction,
            length,
            axial,
            lateral,
            pushed,
            ..
        } = *line;
        let half = 0.5 * step;
        let square = self.stiffness * self.inverse_mass;
        let braked = poles.loss / step * line.backward_rate(step);
        let across = self.outside - pushed * direction;
        let per_length = step * step / (length * length);

        // How far the corrections count. It depends on the middle of the kick, so that it is the same backwards.
        let gained = 2.0 * lateral.dot(across);
        let across_square = across.dot(across);
        let lateral_square =
            |time: f64| line.lateral_square + time * (gained + time * across_square);
        let middle = axial + half * (pushed - square * (length - self.rest_length));
        let sweep = per_length * (middle * middle + lateral_square(half));
        let share = if is_resolved(self.stiffness_number(step)) {
            fade(sweep)
        } else {
            0.0
        };
        let pull_number = |pull: f64| {
            let number = step * step * (pull + braked) / length;
            share * number.clamp(-MOST_PULL, MOST_PULL)
        };

        // The outside acceleration acts half before and half after the rotation, for this time.
        let mut time = half;
        for _ in 0..ROUNDS {
            let turned = (per_length * lateral_square(time)).min(1.0);
            let drifted = length - 0.125 * turned * length;
            let pull = square * (drifted - self.rest_length);
            time = half - half * pull_number(pull) / 6.0;
        }
        let lateral = lateral + time * across;
        let lateral_square = lateral.dot(lateral);

        // In uniform rotation, the line of the middle is longer than the radius by this cosine.
        let turned = per_length * lateral_square;
        let within = turned.min(1.0);
        let doubled = 1.0 + (1.0 - within).sqrt();
        let cosine = (0.5 * doubled).sqrt();
        let turning = 2.0 * lateral_square / (length * doubled * turned.max(1.0));
        let lessened = 1.0 - share * (1.0 - cosine);
        let pull = lessened * square * (cosine * length - self.rest_length);
        let damped = 0.5
            * share
            * (poles.loss * step / length * lateral.dot(self.outside)
                - (1.0 - poles.loss) * within * braked);
        let total = damped - braked - poles.restoring * (pull - turning) - turning;
        let pushed_for = half * poles.restoring;
        let axial = axial + pushed_for * pushed + step * total;

        let tangent = tilt(pull_number(pull)) * step / length;
        let tilted = tangent * tangent * lateral_square;
        let cos = (1.0 - tilted) / (1.0 + tilted);
        let sin = 2.0 * tangent / (1.0 + tilted);
        let rotated = cos * direction + sin * lateral;
        let lateral = cos * lateral - sin * lateral_square * direction;
        let pushed = self.outside.dot(rotated);
        let axial = axial + (pushed_for - time) * pushed;
        state.d = length * rotated;
        state.v = axial * rotated + lateral + time * self.outside;
    }
}

#[cfg(test)]
mod tests;
