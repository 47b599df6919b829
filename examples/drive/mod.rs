//! Modules of the example: the course, the car with its tyres, the driver, and the measurements.

mod camera;
mod car;
mod course;
mod driver;
mod findings;
mod keyboard;
mod log;
mod tyre;

pub use camera::EYE;
pub use findings::check;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stage::{self, Begin};

/// Duration of the script, s.
pub const SECONDS: f32 = 78.0;
/// Time of the screenshot, s: the car is in the air.
pub const PICTURE: f32 = 56.5;

pub fn setup(app: &mut App) {
    app.insert_resource(stage::SpaceIsTaken);
    app.add_systems(
        Begin,
        (
            stage::fresh::<driver::Pedals>,
            stage::fresh::<driver::Script>,
            stage::fresh::<log::Log>,
            course::spawn,
            car::spawn,
        ),
    )
    .add_systems(
        FixedUpdate,
        (
            (driver::read_script, keyboard::read, tyre::weigh, tyre::push)
                .chain()
                .before(PhysicsSet::SyncBackend),
            log::write.after(CoiloverSystems::Readout),
        ),
    )
    .add_systems(Update, (car::turn_wheels, camera::follow));
}
