#![deny(missing_docs)]
//! Springs and dampers between any two bodies.
mod dynamics;
