//! The scene: elements and the bodies they act on, kept from step to step, and what a step does with them. It knows engines
//! by what [`crate::backend`] says of them, and by nothing else.
//!
//! A step runs through these, in this order:
//!
//! 1. *find*: is the scene still the one that is known? [`refresh`] takes in changed numbers and moved ends; [`renew`] makes
//!    all [`rows`] anew, and [`group`] the components that are solved together.
//! 2. *read*, *solve* and *write*, in [`free`]: [`lone`] elements by themselves, all others in an [`assembly`] (networks of points
//!    go on from the last step: [`warm_start`]). All is read before anything is solved, and all is solved before anything is
//!    written: [`push`] says what a body is given. [`sleep`] and [`still`] leave out what rests.
//!    What contacts or joints [`held`] hold, the engine's own room has solved before.
//! 3. The engine steps.
//! 4. *observe*: where has it taken everything? [`observe`], and [`energy`] says where the energy went.
//! 5. *show*: readouts, and what was found: [`show`], [`report`], [`breaking`].
//!
//! [`state`] holds it all, [`step`] is what all stages of a step share, [`kept`] is what snapshots keep.

pub(crate) mod assembly;
pub(crate) mod breaking;
pub(crate) mod element;
pub(crate) mod energy;
pub(crate) mod free;
pub(crate) mod group;
pub(crate) mod held;
pub(crate) mod kept;
pub(crate) mod lone;
pub(crate) mod observe;
pub(crate) mod order;
#[cfg(test)]
mod own_engine;
pub(crate) mod push;
pub(crate) mod refresh;
pub(crate) mod renew;
pub(crate) mod report;
pub(crate) mod rows;
pub(crate) mod runs;
pub(crate) mod show;
pub(crate) mod sleep;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod still;
pub(crate) mod wanted;
pub(crate) mod warm_start;
