//! Two doors on hinges, each with a torsion spring and a damper. The left door has a door closer: it returns without
//! overshoot and meets its frame gently. The right door is a swing door with less damping: it swings through its
//! frame to both sides with decreasing amplitude. A person goes in by the left door and comes out by the right one.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

#[path = "door_closer/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "door_closer",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: rooms::SECONDS,
        check: rooms::check,
        eye: Vec3::new(1.9, 3.9, 6.6),
        target: Vec3::new(0.0, 1.0, 0.0),
    })
}
