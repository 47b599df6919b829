//! Keeps a step of a lone element from gaining energy.
//!
//! The kick of [`super::arc`] neither gains nor loses energy in regular motion. But where ends pass each other closely, the line turns
//! so far in a micro-step that no fixed number of them resolves it, and a strong damper may stop its ends only after they are
//! far apart. Then the step is repeated with another method: see [`remove`].

use super::energy::slowed_by;
use super::kick::Memo;
use super::law::Law;
use super::line;
use super::nonlinear_pair::NonlinearPair;
use super::pair::{Pair, Separation};
use super::thresholds::{ROUNDED_GAIN, STRONG};
use crate::functions::{cos, exp, sin};

/// Gain of a step, as a share of kinetic and stored energy, above which the step is repeated. Pinned by
/// `tests::ends_that_fly_past_each_other_win_nothing`; regular motion stays far below.
pub(super) const GAIN: f64 = 1e-3;

/// c h/m from which on energy-conserving steps would reverse the motion instead of stopping it. [`creep`] takes
/// their place. Pinned by `tests::ends_that_fly_past_each_other_win_nothing`.
const FIERCE: f64 = 40.0;

/// Repeats a step of `time` seconds, in micro-steps of `step`, that began with `start` and ended with `state`, if it gained too much
/// energy. The repeated step is that of [`super::nonlinear_pair`], which conserves energy at any stiffness. It does not suit very
/// strong damping. There the motion along the line decays so fast that its exact solution is used. A surplus that a strong damper
/// leaves is removed from the axial motion.
pub(super) fn remove(
    pair: &Pair,
    state: &mut Separation,
    start: &Separation,
    [time, step]: [f64; 2],
    memo: &mut Memo,
) {
    let [scale, before] = pair.energies(start);
    let surplus = |state: &Separation| pair.energies(state)[1] - before;
    let noticed = ROUNDED_GAIN * before.abs();
    if surplus(state) <= noticed {
        return;
    }
    let decay = pair.damping * pair.inverse_mass;
    if surplus(state) > GAIN * scale.max(before.abs()) {
        let kept = if decay * time < FIERCE {
            let law = Law::linear(pair.stiffness, pair.damping);
            let mut again = NonlinearPair::new(pair, &law, *start, memo);
            again.keep_energy(time);
            again.state
        } else {
            creep(pair, start, time)
        };
        if surplus(&kept) < surplus(state) {
            *state = Separation {
                stiff_damper: state.stiff_damper,
                ..kept
            };
        }
    }
    let surplus = surplus(state);
    if decay * step >= STRONG
        && surplus > noticed
        && let Some(line) = pair.line(state)
    {
        let rate = line.axial;
        state.v += slowed_by(rate, pair.inverse_mass, surplus) * line.direction;
    }
}

/// Returns the state after `time` seconds: the exact overdamped solution along a line that turns at its initial rate. Angular
/// momentum is conserved.
fn creep(pair: &Pair, start: &Separation, time: f64) -> Separation {
    let Some(line) = pair.line(start) else {
        return *start;
    };
    let decay = 0.5 * pair.damping * pair.inverse_mass;
    let square = pair.stiffness * pair.inverse_mass;
    let spread = (decay * decay - square).max(0.0).sqrt();
    let fast = decay + spread;
    let slow = square / fast;
    let stretch = line.length - pair.rest_length;
    let across = pair.outside - line.pushed * line.direction;
    let lateral = line.lateral + 0.5 * time * across;
    let pushed = line.pushed + line::turning(line.length, lateral.length_squared(), time);
    // Stretch to which it creeps, or without a spring the speed of creep.
    let (rest, flow) = if square > 0.0 {
        (pushed / square, 0.0)
    } else {
        (0.0, pushed / fast)
    };
    let (away, rate) = (stretch - rest, line.axial - flow);
    let [slowly, hastily] = [slow, fast].map(|rate| exp(-rate * time));
    let (even, odd) = if spread * time > 1e-4 {
        (0.5 * (slowly + hastily), 0.5 * (slowly - hastily) / spread)
    } else {
        (slowly, time * slowly)
    };
    let left = even * away + odd * (rate + decay * away);
    let axial = flow + even * rate - odd * (decay * rate + square * away);
    let moved = rest + flow * time + left - stretch;
    let length = line.length + moved;

    let speed = lateral.length();
    let side = lateral / speed.max(f64::MIN_POSITIVE);
    let angle = speed * time / line.length;
    let (sin, cos) = (sin(angle), cos(angle));
    let direction = cos * line.direction + sin * side;
    let gained = (line.lateral + time * across).dot(side);
    let across = gained * line.length / length * (cos * side - sin * line.direction);
    Separation {
        d: length * direction,
        v: axial * direction + across,
        direction: Some(direction * length.signum()),
        stiff_damper: start.stiff_damper,
    }
}

#[cfg(test)]
mod tests;
