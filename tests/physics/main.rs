//! Springs and dampers on the real Rapier pipeline, by physical question.

mod fit;
mod harness;

mod decay;
mod elastic_pendulum;
mod free_fall;
mod natural_frequency;
mod static_sag;
