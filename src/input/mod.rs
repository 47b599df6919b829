//! Reads what the user has spawned, checks it, and turns components into numbers. Nothing here depends on an engine.

pub(crate) mod anchoring;
pub(crate) mod check;
pub(crate) mod companions;
#[cfg(feature = "workbench")]
pub(crate) mod curve;
pub(crate) mod lists;
pub(crate) mod named_ends;
pub(crate) mod parts;
pub(crate) mod pose;
pub(crate) mod say;
pub(crate) mod stamps;
pub(crate) mod strays;
