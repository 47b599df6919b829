//! The only room that knows Rapier: bodies and elements into flat arrays, forces back.
//!
//! One step runs [`prepare::prepare`] → [`forces::read_users`] → [`solve::solve`] → (Rapier steps) → [`measure::measure`].
//! [`scene`] holds what is kept between; [`renew`] fills it where [`watch`] or an element says that it
//! changed. What contacts or joints hold goes through [`inside`]; of the rest a lone element through [`lone`], everything
//! else through [`assembly`], where [`carry`] takes networks of points past most of the work, and [`still`] a world asleep
//! past all of it.

mod anchoring;
mod assembly;
mod body;
mod breaking;
mod carry;
mod check;
mod companions;
mod element;
mod ends;
mod energy;
mod find;
mod forces;
mod group;
mod held;
mod inside;
mod lone;
mod measure;
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
mod statics;
mod step;
mod still;
mod strays;
mod timestep;
mod tune;
mod watch;

pub(crate) use anchoring::anchor;
pub(crate) use breaking::break_overloaded;
pub use forces::SpringLoad;
pub(crate) use forces::read_users;
pub(crate) use measure::measure;
pub(crate) use prepare::prepare;
pub(crate) use scene::{Scene, mark};
pub(crate) use setup::{Watched, check_schedule, check_timestep, in_place};
pub(crate) use solve::solve;
pub(crate) use strays::{Role, Strays, any_strays, notice, tell_strays};
