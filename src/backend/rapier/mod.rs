//! Rapier: the only room that knows it.
//!
//! Three systems run the stages of [`crate::scene`]: [`prepare`] finds (with [`watch`], [`ends`], [`find`], [`tune`], [`statics`]), [`solve`]
//! reads, solves and writes ([`body`] and [`rotation`] are how Rapier sees bodies and turns them, [`timestep`] how it steps,
//! [`forces`] what stands in `ExternalForce`, [`held`] what its own solver solves), and [`measure`] observes and shows.
//! [`setup`] tells of wrong set-ups; [`snapshot`] and [`kept`] go back to an earlier tick.

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
