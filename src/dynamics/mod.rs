//! The mathematics of springs and dampers: no ECS, no engine, f64 throughout, SI units.
//!
//! Read in the order in which a step runs: [`body`] drifts, [`element`] measures the line between the
//! ends, [`poles`] gives the exact coefficients, [`kick`] acts for a lone element and [`network`] for
//! elements that share bodies (the linear
//! algebra is in [`system`]), [`pair`] for a lone element on bodies that do not turn, [`guard`] keeps strong damping
//! honest, [`step`] repeats that as micro-steps, and [`delivery`] says which impulse
//! and force make the engine arrive there.

pub(crate) mod body;
pub(crate) mod delivery;
pub(crate) mod element;
pub(crate) mod guard;
pub(crate) mod kick;
pub(crate) mod network;
pub(crate) mod pair;
pub(crate) mod poles;
pub(crate) mod step;
mod system;

#[cfg(test)]
mod tests;
