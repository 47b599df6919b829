//! Modules of the example: the static parts, the moving parts with their drive, and the measurements.

mod findings;
mod load;
mod steel;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Begin, Lasting};

pub use findings::check;

/// Duration of one way, from the ground to the ground, s.
pub const SECONDS: f32 = load::ROUND;
/// Time of the screenshot, s: the crate lags behind the trolley.
pub const PICTURE: f32 = 13.3;

pub fn setup(app: &mut App) {
    app.insert_resource(Lasting(check))
        .insert_resource(stage::TickByTick);
    app.add_systems(
        Begin,
        (stage::fresh::<findings::Seen>, steel::spawn, load::spawn),
    )
    .add_systems(
        FixedUpdate,
        (
            load::drive.before(PhysicsSet::SyncBackend),
            findings::record.after(CoiloverSystems::Readout),
        ),
    );
}
