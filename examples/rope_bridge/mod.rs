//! The rooms of the example: the bridge, who walks over it, and what is measured.

mod bridge;
mod findings;
mod walker;

pub use findings::check;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Begin, Lasting};

/// Seconds of one way over the bridge, with all its stops.
pub const SECONDS: f32 = walker::ROUND;
/// Second of the picture: in the middle.
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
