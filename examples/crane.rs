//! A crane lifts a crate, carries it along its jib and sets it down, over and over. Its cables pull and never push,
//! and the winch is a rest length that changes. On the ground the slings are slack. In the air the crate swings as a
//! double pendulum until drag has damped it.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

#[path = "crane/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "crane",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: 1e6,
        check: rooms::check,
        eye: Vec3::new(1.6, 4.7, 18.6),
        target: Vec3::new(-2.1, 4.45, 0.0),
    })
}
