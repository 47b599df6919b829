//! A cube of jelly: 4 × 4 × 4 points on a lattice of springs, under a skin that follows them. The cube falls on its
//! edge, wobbles and comes to rest. Then a ball falls on it and bounces off, and the cube returns to its shape.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

#[path = "jelly/mod.rs"]
mod rooms;

use bevy::prelude::*;
use stage::{PictureAt, Stage};

fn main() -> AppExit {
    stage::run(&Stage {
        title: "jelly",
        setup: |app| {
            app.insert_resource(PictureAt(rooms::PICTURE));
            rooms::setup(app);
        },
        seconds: rooms::SECONDS,
        again: rooms::SECONDS + 2.0,
        check: rooms::check,
        eye: Vec3::new(1.0, 1.25, 2.7),
        target: Vec3::new(0.0, 0.3, 0.0),
    })
}
