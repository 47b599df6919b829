//! Keys of every window: restart, pause, single tick, faster and slower.

use super::{Again, Stage};
use bevy::prelude::*;

/// What mouse and keys do, in one sentence.
pub const SENTENCE: &str = "drag a body to pull it, drag beside it to look around, wheel to zoom; \
    R restarts, space pauses, full stop steps one tick, [ and ] change the speed";
/// Least and greatest speed of the clock, relative to real time.
const SPEEDS: (f32, f32) = (1.0 / 32.0, 4.0);

/// Inserted by a scene that uses the space bar for something else. There, P pauses.
#[derive(Resource)]
pub struct SpaceIsTaken;

pub fn add(app: &mut App, stage: &Stage) {
    println!("{}: {SENTENCE}", stage.title);
    let title = stage.title;
    app.add_systems(
        Update,
        (
            press,
            move |time: Res<Time<Virtual>>, windows: Query<&mut Window>| show(title, time, windows),
        )
            .chain(),
    );
}

fn press(
    keys: Res<ButtonInput<KeyCode>>,
    taken: Option<Res<SpaceIsTaken>>,
    mut again: ResMut<Again>,
    mut clock: ResMut<Time<Virtual>>,
    mut fixed: ResMut<Time<Fixed>>,
) {
    if keys.just_pressed(KeyCode::KeyR) {
        again.asked = true;
        // Visible at once, even while the clock is paused.
        step(&clock, &mut fixed);
    }
    let pause = if taken.is_some() {
        KeyCode::KeyP
    } else {
        KeyCode::Space
    };
    if keys.just_pressed(pause) {
        clock.toggle();
    }
    if keys.just_pressed(KeyCode::Period) {
        clock.pause();
        step(&clock, &mut fixed);
    }
    let speed = clock.relative_speed();
    if keys.just_pressed(KeyCode::BracketLeft) {
        clock.set_relative_speed((0.5 * speed).max(SPEEDS.0));
    }
    if keys.just_pressed(KeyCode::BracketRight) {
        clock.set_relative_speed((2.0 * speed).min(SPEEDS.1));
    }
}

/// Runs one more tick in the next frame if the clock is paused.
fn step(clock: &Time<Virtual>, fixed: &mut Time<Fixed>) {
    if clock.is_paused() {
        let missing = fixed.timestep().saturating_sub(fixed.overstep());
        fixed.accumulate_overstep(missing);
    }
}

/// Shows [`SENTENCE`] and the speed of the clock in the window's title.
fn show(title: &str, clock: Res<Time<Virtual>>, mut windows: Query<&mut Window>) {
    let speed = match (clock.is_paused(), clock.relative_speed()) {
        (true, _) => " (paused)".into(),
        (false, 1.0) => String::new(),
        (false, speed) => format!(" ({speed} of its speed)"),
    };
    let wanted = format!("{title}{speed}: {SENTENCE}");
    for mut window in &mut windows {
        if window.title != wanted {
            window.title.clone_from(&wanted);
        }
    }
}
