//! Renders frames without a window.

use super::means::Film;
use super::progress::Progress;
use super::{DT, PictureAt, Stage, TickByTick, given, look, offscreen, physics, say};
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use std::path::{Path, PathBuf};

/// Width and height, pixels. `--small` halves them: a processor draws a quarter of the pixels in less than half the
/// time.
const SIZE: (u32, u32) = (1280, 720);
/// Number of frames of a film.
const FRAMES: u32 = 48;
/// Pictures a second for a film of the last seconds. `pictures` makes an animation of them.
const RATE: u32 = 20;
/// Duration of a film of the last seconds, s.
const LENGTH: u32 = 3;
/// Number of updates in which the meshes and materials of a scene appear: of springs in its first step, of the rest before it.
const APPEARING: u32 = 10;

/// Writes the pictures. The exit code also tells whether the check holds.
pub fn shoot(stage: &Stage, film: Film) -> AppExit {
    let ticks = (stage.seconds / DT).round() as u32;
    let (frames, folder) = match &film {
        Film::Frames(folder) => (FRAMES, Some(folder.clone())),
        Film::Last(folder) => (RATE * LENGTH, Some(folder.clone())),
        Film::Still(file) => (1, file.parent().map(PathBuf::from)),
    };
    if let Some(folder) = folder.filter(|f| !f.as_os_str().is_empty())
        && let Err(wrong) = std::fs::create_dir_all(&folder)
    {
        eprintln!("{}: {wrong}", folder.display());
        return AppExit::error();
    }
    let path = |frame: u32| match &film {
        Film::Frames(folder) | Film::Last(folder) => folder.join(format!("frame_{frame:03}.png")),
        Film::Still(file) => file.clone(),
    };
    let part = if given("--small") { 2 } else { 1 };
    let (mut app, image) = offscreen::app(SIZE.0 / part, SIZE.1 / part);
    app.add_plugins(CoiloverPlugins);
    physics(&mut app, stage, 1);
    look::dress(
        &mut app,
        stage.eye,
        stage.target,
        Some(offscreen::target(&image)),
    );
    app.finish();
    app.cleanup();
    // Spawns everything before time passes.
    pass(&mut app, 0);
    // A single picture may show an earlier time than the check.
    let shown = match (&film, app.world().get_resource::<PictureAt>()) {
        (Film::Still(_), Some(at)) => (at.0 / DT).round() as u32,
        _ => ticks,
    };
    let begun = match &film {
        Film::Last(_) => ticks.saturating_sub((LENGTH as f32 / DT).round() as u32),
        _ => 0,
    };
    if begun > 0 {
        offscreen::undrawn(&mut app, |app| pass(app, begun));
    }
    let progress = Progress::new(frames);
    offscreen::settle(&mut app);
    let mut taken = 0;
    for frame in 0..frames {
        // All ticks up to this frame in one update, then one picture of the result.
        let upto = |f: u32| begun + (shown - begun) * f / frames;
        let mut ticks = upto(frame + 1) - upto(frame);
        if app.world().contains_resource::<TickByTick>() && ticks > 1 {
            offscreen::undrawn(&mut app, |app| pass(app, ticks - 1));
            ticks = 1;
        }
        set_ticks(&mut app, ticks);
        let picture = offscreen::shoot_next(&mut app, &image, |app| set_ticks(app, 0));
        let Some(picture) = picture else {
            continue;
        };
        match save(picture, &path(frame)) {
            Ok(()) => {
                taken += 1;
                progress.taken(&path(frame));
            }
            Err(wrong) => eprintln!("{}: {wrong}", path(frame).display()),
        }
    }
    progress.done();
    if shown < ticks {
        offscreen::undrawn(&mut app, |app| pass(app, ticks - shown));
    }
    let good = say(stage, app.world_mut());
    println!(
        "  {taken} of {frames} pictures written, the last is {}",
        path(frames - 1).display()
    );
    if good && taken == frames {
        AppExit::Success
    } else {
        AppExit::error()
    }
}

fn save(picture: Image, path: &Path) -> Result<(), String> {
    let picture = picture.try_into_dynamic().map_err(|e| e.to_string())?;
    // The file gets its name only when it is complete, so a stopped program leaves no partial picture under that
    // name.
    let unfinished = path.with_extension("part.png");
    let saved = picture.to_rgb8().save(&unfinished);
    saved.map_err(|e| e.to_string())?;
    std::fs::rename(unfinished, path).map_err(|e| e.to_string())
}

/// Advances by a number of fixed ticks, in one update if possible. If not, the renderer takes part in the first updates, in
/// which meshes and materials appear, and in the last one: even if it draws nothing, it takes longer than all else in an update.
fn pass(app: &mut App, ticks: u32) {
    let (at_once, updates) = match app.world().contains_resource::<TickByTick>() {
        true => (1, ticks),
        false => (ticks, 1),
    };
    set_ticks(app, at_once);
    for update in 0..updates {
        if (APPEARING..updates.saturating_sub(1)).contains(&update) {
            app.main_mut().update();
        } else {
            app.update();
        }
    }
    set_ticks(app, 0);
}

/// Sets the number of fixed ticks in each of the next updates.
fn set_ticks(app: &mut App, ticks: u32) {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    // By default virtual time would shorten a long frame. A film needs every tick.
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_max_delta(std::time::Duration::from_secs(3600));
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(tick * ticks));
}
