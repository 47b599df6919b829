//! Components with at least one body that contacts or joints hold. Rapier's own solver solves their elements.
//!
//! A force that is computed for a whole step, before contacts and joints are solved, is explicit to contacts and joints, even
//! if it is exact in free flight. So each element of a held component becomes a soft constraint in Rapier's solver, with as
//! many substeps as it needs.
//!
//! A [`step`] runs [`touch`] → [`plan`] → [`mod@write`] → (Rapier steps) → [`arrive`]. [`order`] computes the joints of one
//! element, [`sweeps`] the number of sweeps over all joints, and [`linkage`] the inverse mass that contacts and joints leave.
//! [`crate::scene::held`] has the data of an element inside the solver; [`joint`] and [`lend`] write it to Rapier.

mod ahead;
mod arrive;
mod joint;
mod lend;
mod linkage;
mod near;
mod order;
mod plan;
mod pushes;
mod stagger;
mod stand_in;
mod step;
mod sweeps;
mod touch;
mod write;

pub(crate) use joint::is_ours;
pub(crate) use lend::{fits, give_back};
pub(crate) use linkage::{Holding, inverse_mass, joints_of, locks};
pub(crate) use stand_in::remove;
pub(crate) use step::{View, add_up};
pub(crate) use write::{Engine as EngineParts, Solver};
