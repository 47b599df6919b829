//! Model of the workbench without a window: plain data and functions on it.

pub(crate) mod code;
pub(crate) mod facts;
pub(crate) mod figures;
pub(crate) mod history;
pub(crate) mod like;
pub(crate) mod preset;
mod preset_parts;
pub(crate) mod record;
pub(crate) mod rows;
#[cfg(test)]
mod samples;
pub(crate) mod snapshot;
pub(crate) mod units;
pub(crate) mod verdict;
