//! The mathematics of springs and dampers, without ECS and engine. All numbers are f64 in SI units.
//!
//! The modules in the order of a step:
//!
//! - [`tolerance`] chooses the number of micro-steps, and [`step`] advances a component.
//! - A [`body`] drifts in free flight, whose velocities at an instant are its [`flight`]. An [`element`] [`hold`]s its bodies, and
//!   acts along the [`mod@line`] between its ends, or as its [`guide`] says. [`linkage`] computes how mobile joints and contacts
//!   leave the bodies.
//! - [`poles`] computes exact coefficients. [`kick`] uses them for a lone element, [`pair`] for one that turns no body,
//!   and [`lanes`] for four of those at once. [`nonlinear_pair`] solves one with a force [`law`].
//! - [`network`] solves elements that share bodies, with the linear algebra in [`system`] and [`strut`]. [`points`] does
//!   so if no body turns. Both iterate by [`conjugate`] gradients; a small [`system`] is solved [`direct`]ly, within its
//!   [`envelope`].
//! - [`resolution`] and [`excited`] say how many micro-steps a stiff mode needs; [`thresholds`] has the limits. [`arc`] is the kick of
//!   a line that turns, and [`surplus`] checks its energy. [`moving`] and [`micro`] connect lone elements with [`tolerance`] and
//!   [`lanes`].
//! - [`guard`] limits the [`energy`] of a strongly damped element, and [`bound`] that of a network.
//! - [`delivery`] computes the impulse and force with which the engine arrives at the same state.
//! - [`soft`] and [`pieces`] describe an element to the engine's own solver.

mod arc;
pub(crate) mod body;
mod bound;
mod conjugate;
pub(crate) mod delivery;
#[cfg(test)]
pub(crate) mod dice;
mod direct;
pub(crate) mod element;
pub(crate) mod energy;
mod envelope;
mod excited;
mod flight;
pub(crate) mod guard;
pub(crate) mod guide;
mod hold;
pub(crate) mod kick;
pub(crate) mod lanes;
pub(crate) mod law;
pub(crate) mod line;
pub(crate) mod linkage;
pub(crate) mod micro;
pub(crate) mod moving;
pub(crate) mod network;
pub(crate) mod nonlinear_pair;
pub(crate) mod pair;
pub(crate) mod pieces;
pub(crate) mod points;
pub(crate) mod poles;
mod resolution;
pub(crate) mod soft;
pub(crate) mod step;
mod strut;
mod surplus;
mod system;
pub(crate) mod thresholds;
pub(crate) mod tolerance;

/// Rounds to single precision. Numbers that are too large become the largest finite number, and NaN becomes 0, so that no
/// overflow reaches the engine or a user.
pub(crate) fn single(number: f64) -> f32 {
    const MOST: f64 = f32::MAX as f64;
    if number.is_nan() {
        return 0.0;
    }
    number.clamp(-MOST, MOST) as f32
}

#[cfg(test)]
pub(crate) mod tests;
#[cfg(test)]
mod undamped;
