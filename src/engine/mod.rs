//! The only room that knows Rapier: bodies and elements into flat arrays, forces back.
//!
//! One step runs [`scene::prepare`] → [`solve::solve`] → (Rapier steps) → [`measure::measure`].

mod body;
mod check;
mod component;
mod ends;
mod forces;
mod group;
mod held;
mod jointed;
mod measure;
mod memory;
mod scene;
mod setup;
mod sleep;
mod solve;
mod timestep;

pub use forces::SpringLoad;
pub(crate) use measure::measure;
pub(crate) use memory::ElementMemory;
pub(crate) use scene::{Scene, prepare};
pub(crate) use setup::{Watched, check_schedule, check_timestep, in_place};
pub(crate) use solve::solve;
