//! The mathematics of springs and dampers: no ECS, no engine, f64 throughout, SI units.
//!
//! Read in the order in which a step runs. [`tolerance`] decides how finely to step, [`step`] holds what has
//! to be solved together. [`body`] drifts, [`element`] has the [`mod@line`] between its ends (or
//! what [`guide`] gives instead, and the [`linkage`] that holds their bodies), [`poles`] gives
//! the exact coefficients; [`kick`] acts for a lone element, [`pair`] for one on bodies that do not turn, four of those at once in [`lanes`],
//! [`nonlinear_pair`] for one of those with a force [`law`] of its own, [`network`] for elements that share bodies,
//! with the linear algebra in [`system`] and [`strut`], and [`points`] for those that turn none; both iterate by
//! [`conjugate`] gradients. [`guard`] keeps strong
//! damping honest, and [`bound`] a network, by their [`energy`]. [`delivery`] says which impulse and force
//! make the engine arrive there. What an engine's own solver is to solve is [`soft`], in [`pieces`].

pub(crate) mod body;
mod bound;
mod conjugate;
pub(crate) mod delivery;
pub(crate) mod element;
pub(crate) mod energy;
mod excited;
pub(crate) mod guard;
pub(crate) mod guide;
pub(crate) mod kick;
pub(crate) mod lanes;
pub(crate) mod law;
pub(crate) mod line;
pub(crate) mod linkage;
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
mod system;
pub(crate) mod tolerance;

/// The nearest number that is finite in single precision, and 0 for NaN: no overflow reaches the engine or a user.
pub(crate) fn single(number: f64) -> f32 {
    const MOST: f64 = f32::MAX as f64;
    if number.is_nan() {
        return 0.0;
    }
    number.clamp(-MOST, MOST) as f32
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod undamped;
