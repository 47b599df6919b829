//! Modules of the example: the doors, the person who goes through them, and the measurements.

mod doors;
mod findings;
mod person;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Begin};

pub use findings::check;

/// Duration of one way in and out, s.
pub const SECONDS: f32 = 24.0;
/// Time of the screenshot, s: the person is in the first door.
pub const PICTURE: f32 = 3.2;

pub fn setup(app: &mut App) {
    app.insert_resource(stage::TickByTick)
        .add_systems(Begin, (doors::spawn, person::spawn))
        .add_systems(
            FixedUpdate,
            (person::walk, person::push).before(PhysicsSet::SyncBackend),
        );
}
