//! A flag in the wind: 19 × 13 points under a mesh that follows them. It flutters for twenty seconds; then a gust tears it,
//! thread by thread, and the wind carries off what has come loose.
//!
//! Whatever it does, the pole carries its weight and its drag: in the mean, momentum goes nowhere.
//!
//! Opens a window where there is a display; `--screenshot FILE` and `--headless` do without.

#[path = "flag/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "flag",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: rooms::SECONDS + 5.0,
        check: rooms::check,
        eye: Vec3::new(1.0, 2.3, 3.9),
        target: Vec3::new(0.75, 2.35, 0.0),
    })
}
