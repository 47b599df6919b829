//! The scene: elements, the bodies on which they act, and the stages of a step. It is kept from step to step and knows
//! engines only through [`crate::backend`].
//!
//! A step has these stages, in this order:
//!
//! 1. *find*: checks whether the known scene is still valid. [`refresh`] reads changed parameters and moved ends. If that is not
//!    enough, [`renew`] makes all [`rows`] anew, and [`group`] finds the components that must be solved together.
//! 2. *read*, *solve* and *write*, in [`free`]: [`lone`] elements are solved by themselves, all others in an [`assembly`].
//!    Networks of points continue from the last step ([`warm_start`]). The engine is written to only after everything is read and
//!    solved; [`push`] computes what each body is given. [`sleep`] and [`still`] skip what is at rest. Components that contacts
//!    or joints hold ([`held`]) have been solved before, by the backend.
//! 3. The engine steps.
//! 4. *observe*: [`observe`] reads where bodies and ends are now, and [`energy`] computes where the energy went.
//! 5. *show*: [`show`] writes readouts, [`report`] reports faults, and [`breaking`] breaks overloaded elements.
//!
//! Bodies get their rows from [`wanted`], and [`handles`] finds these by the engine's handles. [`sequence`] sorts the bodies of a
//! component, [`runs`] divides networks among threads, and [`to_element`] converts a row to the element of [`crate::dynamics`].
//! A test drives all this with an engine of its own (`own_engine`).
//!
//! [`state`] holds the data of the scene, [`step`] what all components share within a step, and [`kept`] the data of snapshots.

pub(crate) mod assembly;
pub(crate) mod breaking;
pub(crate) mod energy;
pub(crate) mod free;
pub(crate) mod group;
pub(crate) mod handles;
pub(crate) mod held;
pub(crate) mod kept;
pub(crate) mod lone;
pub(crate) mod observe;
#[cfg(test)]
mod own_engine;
pub(crate) mod push;
pub(crate) mod refresh;
pub(crate) mod renew;
pub(crate) mod report;
pub(crate) mod rows;
pub(crate) mod runs;
pub(crate) mod sequence;
pub(crate) mod show;
pub(crate) mod sleep;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod still;
pub(crate) mod to_element;
pub(crate) mod wanted;
pub(crate) mod warm_start;
