//! Modules of the example: the bridge, the walker, and the measurements.

mod bridge;
mod findings;
mod walker;

pub use findings::check;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Begin, Lasting};

/// Duration of one way over the bridge with all stops, s.
pub const SECONDS: f32 = walker::ROUND;
/// Time of the screenshot, s: the walker is in the middle.
pub const PICTURE: f32 = 12.0;

pub fn setup(app: &mut App) {
    app.insert_resource(Lasting(check))
        .insert_resource(stage::TickByTick);
    app.add_systems(
        Begin,
        (stage::fresh::<findings::Seen>, bridge::spawn, walker::spawn),
    )
    .add_systems(
        FixedUpdate,
        (
            (walker::walk, walker::tread)
                .chain()
                .before(PhysicsSet::SyncBackend),
            findings::record.after(CoiloverSystems::Readout),
        ),
    )
    .add_systems(Update, walker::swing_legs);
}
