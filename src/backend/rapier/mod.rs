//! The Rapier backend: the only folder of the physics that knows Rapier.
//!
//! Three systems run the stages of [`crate::scene`]:
//!
//! - [`prepare`] finds elements and their ends, with [`watch`], [`ends`], [`find`], [`tune`] and [`statics`].
//! - [`solve`] reads, solves and writes. [`body`] converts bodies, [`rotation`] repeats Rapier's rotation, [`timestep`] predicts
//!   the step, [`forces`] shares `ExternalForce` with the user, and [`held`] uses Rapier's own solver.
//! - [`measure`] reads the result after the step and writes readouts.
//!
//! [`setup`] reports wrong set-ups. [`snapshot`] and [`kept`] return to an earlier tick.

pub(crate) mod body;
pub(crate) mod ends;
pub(crate) mod find;
pub(crate) mod forces;
pub(crate) mod held;
pub(crate) mod kept;
pub(crate) mod measure;
pub(crate) mod prepare;
pub(crate) mod rotation;
pub(crate) mod setup;
pub(crate) mod snapshot;
pub(crate) mod solve;
pub(crate) mod statics;
pub(crate) mod timestep;
pub(crate) mod tune;
pub(crate) mod watch;
