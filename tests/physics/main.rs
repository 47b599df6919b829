//! Springs and dampers on the real Rapier pipeline, by physical question.

mod fit;
mod harness;

mod adams;
mod decay;
mod elastic_pendulum;
mod free_fall;
mod hard_cases;
mod natural_frequency;
mod spinning_pair;
mod static_sag;
