//! A catapult whose arm is driven by twisted ropes. A winch pulls the arm down, a ball is put into its cup, and the
//! hook releases it. The arm swings up against a padded beam, and the ball flies on into a wall of boxes.
//!
//! The work of the winch, the speed of the arm, and the height of the ball at the wall are compared with theory.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

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
