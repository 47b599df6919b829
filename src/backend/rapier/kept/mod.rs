//! Between the plain data of a snapshot and a world with Rapier: [`take`] reads it from the scene, [`put`] makes a scene of it
//! again, if [`check`] finds that it fits; else springs begin [`anew`].

mod anew;
mod check;
mod put;
mod take;

pub(crate) use anew::note_engine;
