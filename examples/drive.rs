//! A car to drive, over kerbs, waves, a washboard and a jump. Arrows or WASD steer, space brakes, R starts again.
//!
//! Until a key is pressed it drives itself, and measures: how high it stands, how far it rolls in a corner and dives under
//! its brakes, what its wheels press on the washboard, how it lands, and whether it creeps on a slope.
//!
//! Opens a window where there is a display; `--screenshot FILE` and `--headless` do without. With `--rapier` it stands on
//! Rapier's `SpringJoint`s.

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
