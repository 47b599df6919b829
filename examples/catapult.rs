//! A catapult: twisted ropes drive an arm. A winch pulls it down against them, a ball comes to lie in its cup, the hook lets
//! go, the arm swings up against a padded beam, and the ball flies on into a wall of boxes.
//!
//! Work of the winch, speed of the arm, and where the ball comes down are compared with theory.
//!
//! Opens a window where there is a display; `--screenshot FILE` and `--headless` do without.

#[path = "catapult/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "catapult",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: rooms::SECONDS + 2.0,
        check: rooms::check,
        eye: Vec3::new(0.8, 3.4, 12.2),
        target: Vec3::new(3.4, 1.6, 0.0),
    })
}
