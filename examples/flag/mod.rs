//! Modules of the example: threads, wind, tearing, and the measurements.

mod cloth;
mod findings;
mod tear;
mod wind;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, fresh};

pub use findings::check;

/// Time span of the gust, s.
const GUST: [f32; 2] = [20.0, 23.0];
pub const SECONDS: f32 = 40.0;
/// Early, because later the least rounding decides how the flag flutters.
pub const PICTURE: f32 = 1.5;

pub fn setup(app: &mut App) {
    app.world_mut()
        .resource_mut::<CoiloverSettings>()
        .microsteps = 8;
    app.add_systems(Begin, (fresh::<findings::Seen>, cloth::setup).chain())
        .add_systems(
            FixedUpdate,
            (tear::carry_off, tear::fray, wind::blow)
                .chain()
                .before(PhysicsSet::SyncBackend),
        )
        .add_systems(
            FixedUpdate,
            findings::record.after(CoiloverSystems::Readout),
        )
        .add_observer(tear::snap);
}
