//! A flag in the wind: 19 × 13 points under a mesh that follows them. It flutters for twenty seconds. Then a gust
//! tears it, thread by thread, and the wind carries the loose parts away.
//!
//! On average the pole carries the weight and the drag of the flag, as conservation of momentum requires.
//!
//! Opens a window where there is a display. `--screenshot FILE` and `--headless` need none.

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
