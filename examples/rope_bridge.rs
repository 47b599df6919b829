//! A rope bridge with a walker: twenty planks on two ropes, and a rope for each hand. A character controller moves
//! the walker, whose weight is a force at its feet. In a window, arrow keys or A and D walk.
//!
//! The banks carry bridge and walker according to the lever rule, and the sag of the bridge follows from the moment
//! in its middle.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

#[path = "rope_bridge/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "rope_bridge",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: 1e6,
        check: rooms::check,
        eye: Vec3::new(3.4, 2.6, 11.6),
        target: Vec3::new(0.0, -0.35, 0.0),
    })
}
