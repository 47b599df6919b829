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
use bevy::math::DVec3;

/// Square of h·s/L up to which the turning is resolved, and from which on it is not: about 0.3 and 0.6 rad in a micro-step. In
/// between, the corrections fade out, because near a close passage they would change the energy for good. The share that counts
/// must depend only on what is the same backwards. Pinned by `arc::tests::close_passages_do_not_add_up_in_the_energy`.
pub(super) const RESOLVED_TURN: [f64; 2] = [0.1, 0.4];

/// Greatest magnitude of h²·F/L that counts. The series of [`tilt`] converges up to 4, slowly at the end. Beyond the bound are
/// only lines that the pull makes shorter or longer by their whole length within a micro-step. Pinned by
/// `arc::tests::a_spring_that_is_squeezed_to_almost_nothing_falls_as_one_resolved_finely`.
pub(super) const MOST_PULL: f64 = 2.0;

/// Factor by which the error falls if the number of micro-steps is doubled, without damping. Extrapolation uses it. Pinned by
/// `arc::tests::without_damping_the_error_is_of_fourth_order`.
pub(super) const HALVED: f64 = 16.0;

/// Number of iterations that find the motion across the line in the middle of the kick. With one, the kick is not quite the same
/// backwards, and a whirled stiff spring loses some 3e-5 of its energy in five minutes. Pinned by
/// `arc::tests::a_whirled_stone_keeps_its_energy`.
pub(super) const ROUNDS: usize = 2;

/// Coefficients of q, q², … in [`tilt`]. Pinned by `arc::tests::uniform_rotation_is_exact`.
pub(super) const TILT: [f64; 6] = [
    1.0 / 24.0,
    7.0 / 480.0,
    19.0 / 4_480.0,
    859.0 / 725_760.0,
    20_897.0 / 63_866_880.0,
    125_011.0 / 1_383_782_400.0,
];

/// Tangent of half the rotation that a micro-step lacks, as a multiple of h·s/L, for h²·F/L = `pull`.
///
/// In uniform rotation by the angle x = 2·tan φ per micro-step, drifts and kick turn the line by 2φ, h·s/L is sin 2φ in the
/// middle of the micro-step, and h²·F/L is 4·sin²φ. This is the series of tan(tan φ − φ)/sin 2φ.
fn tilt(pull: f64) -> f64 {
    let terms = TILT.iter().rev();
    terms.fold(0.0, |sum, coefficient| (sum + coefficient) * pull)
}

/// The share of the corrections that counts where (h·s/L)² is `turned`.
fn fade(turned: f64) -> f64 {
    let [from, to] = RESOLVED_TURN;
    let beyond = ((turned - from) * (1.0 / (to - from))).clamp(0.0, 1.0);
    let left = 1.0 - beyond * beyond;
    left * left
}

/// What acts along the line, per effective mass.
pub(super) struct Along<E> {
    /// Returns the pull of the spring at a length, m/s², and its slope, 1/s².
    pub elastic: E,
    /// Deceleration by the damper, m/s².
    pub braked: f64,
    /// Share of the rate along the line that the damper takes in the step.
    pub loss: f64,
    /// Whether the step resolves the oscillation along the line.
    pub resolved: bool,
}

/// The middle of a kick, which is the same backwards in time.
struct Middle<'a> {
    line: &'a Line,
    /// Acceleration across the line from everything but the element, m/s².
    across: DVec3,
    step: f64,
    /// 1/L, 1/m.
    inverse_length: f64,
    /// (h/L)².
    per_length: f64,
    /// Pull of the spring at the length of the line, m/s², and its slope, 1/s².
    pull: [f64; 2],
    braked: f64,
    /// The share of the corrections that counts.
    share: f64,
}

impl<'a> Middle<'a> {
    fn new<E: Fn(f64) -> [f64; 2]>(
        line: &'a Line,
        across: DVec3,
        step: f64,
        along: &Along<E>,
    ) -> Self {
        let inverse_length = 1.0 / line.length;
        let per_length = step * inverse_length;
        let mut middle = Self {
            line,
            across,
            step,
            inverse_length,
            per_length: per_length * per_length,
            pull: (along.elastic)(line.length),
            braked: along.braked,
            share: 0.0,
        };
        if along.resolved {
            middle.share = fade(middle.per_length * middle.lateral_square(0.5 * step));
        }
        middle
    }

    /// Square of the velocity across the line after the outside acceleration has acted for so long, m²/s².
    fn lateral_square(&self, time: f64) -> f64 {
        let gained = 2.0 * self.line.lateral.dot(self.across);
        self.line.lateral_square + time * (gained + time * self.across.dot(self.across))
    }

    /// h²·F/L, as far as it counts, under the pull of the spring.
    fn number(&self, pull: f64) -> f64 {
        let number = self.step * self.step * (pull + self.braked) * self.inverse_length;
        self.share * number.clamp(-MOST_PULL, MOST_PULL)
    }

    /// Time for which the outside acceleration acts before the rotation, and again after it, s.
    fn time(&self) -> f64 {
        let half = 0.5 * self.step;
        let [pull, slope] = self.pull;
        let mut time = half;
        for _ in 0..ROUNDS {
            // The straight half drift has lengthened the line by about this.
            let turned = (self.per_length * self.lateral_square(time)).min(1.0);
            let drifted = 0.125 * turned * self.line.length;
            time = half - half * self.number(pull - slope * drifted) * (1.0 / 6.0);
        }
        time
    }
}

impl Pair {
    /// Applies the kick after the first half drift, for a line that does not turn or has no axis. `restoring` is that of
    /// [`Self::kick_in_arc`].
    pub(super) fn kick_straight<E: Fn(f64) -> [f64; 2]>(
        &self,
        state: &mut Separation,
        line: &Line,
        step: f64,
        along: &Along<E>,
        restoring: impl FnOnce(f64) -> f64,
    ) {
        let [pull, slope] = (along.elastic)(line.length);
        let total = -restoring(slope) * (pull - line.pushed) - along.braked;
        state.v += step * (total - line.pushed) * line.direction + step * self.outside;
    }

    /// Applies the kick after the first half drift, for a line that has an axis. `restoring` returns the coefficient
    /// of [`super::poles::Poles`] for the slope of the spring.
    pub(super) fn kick_in_arc<E: Fn(f64) -> [f64; 2]>(
        &self,
        state: &mut Separation,
        line: &Line,
        step: f64,
        along: &Along<E>,
        restoring: impl FnOnce(f64) -> f64,
    ) {
        if line.length.abs() <= self.rounding {
            return self.kick_straight(state, line, step, along, restoring);
        }
        let Line {
            direction,
            length,
            axial,
            pushed,
            ..
        } = *line;
        let across = self.outside - pushed * direction;
        let middle = Middle::new(line, across, step, along);
        let (time, share) = (middle.time(), middle.share);
        let lateral = line.lateral + time * across;
        let lateral_square = lateral.dot(lateral);

        // In uniform rotation, the radius is shorter by this cosine than the line of the middle.
        let turned = middle.per_length * lateral_square;
        let within = turned.min(1.0);
        let doubled = 1.0 + (1.0 - within).sqrt();
        let cosine = (0.5 * doubled).sqrt();
        let inverse = middle.inverse_length;
        let turning = 2.0 * lateral_square * inverse / (doubled * turned.max(1.0));
        let [pull, slope] = (along.elastic)(cosine * length);
        let pull = (1.0 - share * (1.0 - cosine)) * pull;
        let (braked, loss) = (along.braked, along.loss);
        let damped = 0.5
            * share
            * (loss * step * inverse * lateral.dot(self.outside) - (1.0 - loss) * within * braked);
        let restoring = restoring(slope);
        let total = damped - braked - restoring * (pull - turning) - turning;
        let pushed_for = 0.5 * step * restoring;
        let axial = axial + pushed_for * pushed + step * total;

        let tangent = tilt(middle.number(pull)) * step * inverse;
        let tilted = tangent * tangent * lateral_square;
        let scale = 1.0 / (1.0 + tilted);
        let cos = (1.0 - tilted) * scale;
        let sin = 2.0 * tangent * scale;
        let rotated = cos * direction + sin * lateral;
        let lateral = cos * lateral - sin * lateral_square * direction;
        let axial = axial + (pushed_for - time) * self.outside.dot(rotated);
        state.d = length * rotated;
        state.v = axial * rotated + lateral + time * self.outside;
    }
}

#[cfg(test)]
mod tests;
