//! Modules of the example: the catapult, the ball and the wall, and the measurements.

mod arm;
mod findings;
mod frame;
mod shot;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, fresh};

pub use findings::check;

/// Times at which the winch begins and ends, s.
const WIND: [f32; 2] = [0.5, 4.0];
/// Time at which the ball is put into the cup, s.
const LOAD: f32 = 4.2;
/// Time at which the hook releases the arm, s.
const RELEASE: f32 = 5.5;
pub const SECONDS: f32 = 12.0;
/// Time of the screenshot, s: the ball is in flight.
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
