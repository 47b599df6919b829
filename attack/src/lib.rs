//! Random scenes, and random changes to them while they run.
//!
//! [`plan`] describes a scene and its changes, [`stage`] builds and changes it with Bevy and Rapier, and [`judge`] checks
//! it. `tests/attack.rs` searches for faults. It shrinks a scene that fails and prints it.

pub mod endurance;
pub mod fault;
pub mod judge;
pub mod lab;
mod left;
mod numbers;
pub mod plan;
mod springs;
pub mod stage;
