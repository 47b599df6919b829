//! Random scenes, and random deeds while they run.
//!
//! [`plan`] says what a scene can be made of and what can be done to it, [`stage`] makes and does it with Bevy and Rapier,
//! [`judge`] watches. `tests/attack.rs` searches; a scene that fails is made as small as it can be, and printed.

pub mod endurance;
pub mod judge;
pub mod plan;
pub mod stage;
