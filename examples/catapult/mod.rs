//! The catapult in its parts: the engine of war, what it throws and at what, and what is measured.

mod arm;
mod findings;
mod frame;
mod shot;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, fresh};

pub use findings::check;

/// When the winch begins and ends, and when the hook lets go, s.
const WIND: [f32; 2] = [0.5, 4.0];
const LOAD: f32 = 4.2;
const RELEASE: f32 = 5.5;
pub const SECONDS: f32 = 12.0;
/// The ball is on its way.
pub const PICTURE: f32 = RELEASE + 0.62;

pub fn setup(app: &mut App) {
    app.add_systems(
        Begin,
        (
            fresh::<findings::Seen>,
            (frame::spawn, arm::spawn).chain(),
            shot::spawn_wall,
        ),
    )
    .add_systems(
        FixedUpdate,
        (
            (arm::wind, shot::load).before(PhysicsSet::SyncBackend),
            findings::record.after(CoiloverSystems::Readout),
        ),
    );
}
