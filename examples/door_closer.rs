//! Two doors on hinges, each with a torsion spring and a damper. The left one has a door closer: it comes back without
//! swinging past, and meets its frame gently. The right one is a swing door that has less damping: it swings through its
//! frame to both sides, a little less each time. Someone goes in by the one and comes out by the other.
//!
//! Opens a window where there is a display; `--screenshot FILE` and `--headless` do without.

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
