//! The scene: elements and the bodies they act on, kept from step to step, and what a step does with them.

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
pub(crate) mod push;
pub(crate) mod refresh;
pub(crate) mod renew;
pub(crate) mod report;
pub(crate) mod rows;
pub(crate) mod show;
pub(crate) mod sleep;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod still;
pub(crate) mod threads;
pub(crate) mod wanted;
pub(crate) mod warm_start;
