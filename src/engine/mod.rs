//! Bodies and elements into flat arrays, forces back: the room that knows Rapier.
//!
//! One step runs [`prepare::prepare`] → [`forces::read_users`] → [`solve::solve`] → (Rapier steps) → [`measure::measure`].
//!
//! - [`rows`] are plain data about elements and bodies, kept from step to step; [`scene`] holds them. Nothing in `rows` knows
//!   what is done with them.
//! - [`prepare`] finds out whether the scene is still the same, by [`watch`], [`parts`], [`companions`], [`find`] and
//!   [`ends`]; [`renew`] fills it anew where it is not. [`check`] and [`report`] say what is wrong; [`named_ends`] puts entities in the place of
//!   names before all that.
//! - [`solve`] takes each component its way: what contacts or joints hold through [`inside`] (and [`held`], which is what it
//!   leaves in the engine); of the rest, in [`free`], lone elements through [`lone`], everything else through [`assembly`], where
//!   [`warm_start`] takes networks of points past most of the work. [`sleep`] and [`still`] leave out what rests.
//! - [`measure`] shows what came of it, [`energy`] where the energy went.

mod anchoring;
mod assembly;
mod body;
mod breaking;
mod check;
mod companions;
#[cfg(feature = "workbench")]
mod curve;
mod element;
mod ends;
mod energy;
mod find;
mod forces;
mod free;
mod group;
mod held;
mod inside;
mod kept;
mod lone;
mod measure;
mod named_ends;
mod parts;
mod point;
mod pose;
mod prepare;
mod renew;
mod report;
mod rows;
mod scene;
mod setup;
mod sleep;
mod solve;
mod stamps;
mod statics;
mod step;
mod still;
mod strays;
mod timestep;
mod tune;
mod warm_start;
mod watch;

pub(crate) use anchoring::anchor;
pub(crate) use breaking::break_overloaded;
#[cfg(feature = "workbench")]
pub(crate) use companions::Beside;
#[cfg(feature = "workbench")]
pub(crate) use curve::Curve;
pub use forces::SpringLoad;
pub(crate) use forces::read_users;
pub(crate) use kept::{Kept, note_engine};
pub(crate) use measure::measure;
pub(crate) use named_ends::find_named_ends;
#[cfg(feature = "workbench")]
pub(crate) use parts::{IsElement, Parts};
pub(crate) use prepare::prepare;
pub(crate) use scene::{Scene, mark};
pub(crate) use setup::{Watched, check_schedule, check_timestep, in_place};
pub(crate) use solve::solve;
pub(crate) use strays::{Role, Strays, any_strays, notice, tell_strays};
