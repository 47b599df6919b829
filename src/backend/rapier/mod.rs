//! Rapier: the only room that knows it.

pub(crate) mod body;
pub(crate) mod ends;
pub(crate) mod find;
pub(crate) mod forces;
pub(crate) mod held;
pub(crate) mod kept;
pub(crate) mod measure;
pub(crate) mod prepare;
pub(crate) mod setup;
pub(crate) mod solve;
pub(crate) mod statics;
pub(crate) mod timestep;
pub(crate) mod tune;
pub(crate) mod watch;
