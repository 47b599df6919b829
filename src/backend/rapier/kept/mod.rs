//! Converts between the plain data of a snapshot and a world with Rapier. [`take`] reads the data from the scene. [`put`]
//! restores a scene from it if [`check`] finds that it fits; otherwise [`anew`] lets springs start afresh.

mod anew;
mod check;
mod put;
mod put_body;
mod take;

pub(crate) use anew::{is_disturbed, note_engine};
