//! A rope bridge that someone walks over: twenty planks on two ropes, with a rope for each hand. A character controller
//! walks, and its weight is a force where its feet are. Arrows or A and D walk in a window.
//!
//! The banks carry bridge and walker, each bank its share by the lever rule, and the bridge sags as far as the moment in its
//! middle says.
//!
//! Opens a window where there is a display; `--screenshot FILE` and `--headless` do without.

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
