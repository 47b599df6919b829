//! Modules of the example: lattice, skin, ball, measurements, and the statics to compare with.

mod ball;
mod findings;
mod lattice;
mod skin;
mod statics;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{Begin, fresh};

pub use findings::check;

/// Time at which the ball falls, s: the cube is at rest by then.
const BALL: f32 = 8.0;
pub const SECONDS: f32 = 18.0;
/// Time of the screenshot, s: the ball is in the jelly.
pub const PICTURE: f32 = BALL + 0.52;

pub fn setup(app: &mut App) {
    app.add_systems(Begin, (fresh::<findings::Seen>, lattice::spawn))
        .add_systems(
            FixedUpdate,
            (
                ball::drop_it.before(PhysicsSet::SyncBackend),
                findings::record.after(CoiloverSystems::Readout),
            ),
        );
}
