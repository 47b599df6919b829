//! A car to drive over kerbs, waves, a washboard and a jump. Arrow keys or WASD steer, space brakes, R restarts.
//!
//! Until a key is pressed, a script drives the car and the example measures: ride height, roll in a corner, dive
//! under braking, wheel load on the washboard, the landing after the jump, and creep on a slope.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none. With `--rapier` the car
//! uses Rapier's `SpringJoint`s instead of coilovers.

#[path = "drive/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "drive",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: rooms::SECONDS + 3.0,
        check: rooms::check,
        eye: rooms::EYE,
        target: Vec3::Y * 0.5,
    })
}
