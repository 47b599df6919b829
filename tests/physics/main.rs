//! Tests of springs and dampers on the real Rapier pipeline, one file for each physical question.

/// What differs between versions of Bevy. The folder of each manifest has its own `compat.rs`.
mod compat {
    include!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/physics/compat.rs"
    ));
}
mod fit;
mod harness;

mod adams;
mod against_rapier;
mod anchoring;
mod as_data;
mod bad_input;
mod car;
mod carried;
mod cloth;
mod comes_and_goes;
mod decay;
mod dice;
mod elastic_pendulum;
mod end_speeds;
mod ends;
mod engine_settings;
mod free_fall;
mod ground;
mod hard_cases;
mod house;
mod joints;
mod laws;
mod messages;
mod mouse_spring;
mod named_ends;
mod natural_frequency;
mod networks;
mod other_anchors;
mod passenger;
mod paused;
mod quarter_car;
mod recommend;
mod repeatability;
mod sleeping;
mod snapshot;
mod spinning_pair;
#[cfg(feature = "visual")]
mod spoilt;
mod stability;
mod static_sag;
mod stiff_by_default;
mod still;
mod strangers;
mod strays;
mod tolerance;
mod undamped;
mod user_force;
#[cfg(feature = "visual")]
mod visual_cuts;
#[cfg(feature = "visual")]
mod visual_data;
#[cfg(feature = "visual")]
mod visual_gizmos;
#[cfg(feature = "visual")]
mod visual_gone;
#[cfg(feature = "visual")]
mod visual_layers;
#[cfg(feature = "visual")]
mod visual_looks;
#[cfg(feature = "visual")]
mod visual_rest;
#[cfg(feature = "visual")]
mod visual_torsion;
#[cfg(feature = "visual")]
mod visual_winch;
