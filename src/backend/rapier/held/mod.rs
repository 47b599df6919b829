//! What the engine holds, the engine solves: components some body of which contacts or joints hold.
//!
//! A force that is worked out for a whole step, before the engine knows of contact and joint, is explicit to them, however
//! exact it is in free flight. So each element of such a component is a soft constraint of the engine's own solver, in as
//! many substeps as it needs. A [`step`] runs [`touch`] → [`plan`] → [`mod@write`] → (Rapier steps) → [`arrive`]. [`order`] says what one
//! element is to do, [`linkage`] what mass it has then; [`crate::scene::held`] is what it has in the engine, [`joint`] and [`lend`]
//! how Rapier is told.

mod ahead;
mod arrive;
mod joint;
mod lend;
mod linkage;
mod near;
mod order;
mod plan;
mod pushes;
mod stand_in;
mod step;
mod touch;
mod write;

pub(crate) use joint::is_ours;
pub(crate) use lend::{fits, give_back};
pub(crate) use linkage::{Holding, inverse_mass, locks};
pub(crate) use stand_in::remove;
pub(crate) use step::{View, add_up};
pub(crate) use write::{Engine as EngineParts, Solver};
