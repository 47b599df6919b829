//! Frames without a window.

use super::means::Film;
use super::{DT, Stage, look, offscreen, physics, say};
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::image::Image;
use bevy::prelude::*;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use std::path::PathBuf;

const SIZE: (u32, u32) = (1280, 720);
/// Frames of a film.
const FRAMES: u32 = 48;
/// Updates in which shaders and textures get ready; a first picture would be empty.
const WARM_UP: u32 = 8;

/// How many pictures have been written.
#[derive(Resource, Default)]
struct Taken(u32);

pub fn shoot(stage: &Stage, film: Film) -> AppExit {
    let ticks = (stage.seconds / DT).round() as u32;
    let (frames, folder) = match &film {
        Film::Frames(folder) => (FRAMES, Some(folder.clone())),
        Film::Still(file) => (1, file.parent().map(PathBuf::from)),
    };
    if let Some(folder) = folder.filter(|f| !f.as_os_str().is_empty())
        && let Err(wrong) = std::fs::create_dir_all(&folder)
    {
        eprintln!("{}: {wrong}", folder.display());
        return AppExit::error();
    }
    let path = |frame: u32| match &film {
        Film::Frames(folder) => folder.join(format!("frame_{frame:03}.png")),
        Film::Still(file) => file.clone(),
    };

    let mut app = offscreen();
    physics(&mut app, stage, 1);
    let mut image = Image::new_target_texture(SIZE.0, SIZE.1, TextureFormat::Rgba8UnormSrgb, None);
    image.asset_usage = RenderAssetUsages::default();
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let handle = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    look::dress(
        &mut app,
        stage.eye,
        stage.target,
        Some(RenderTarget::Image(handle.clone().into())),
    );
    app.init_resource::<Taken>();
    app.finish();
    app.cleanup();

    set_ticks(&mut app, 0);
    for _ in 0..WARM_UP {
        app.update();
    }
    for frame in 0..frames {
        // All the ticks up to this frame in one update, then one picture of where they led.
        let upto = |f: u32| ticks * f / frames;
        set_ticks(&mut app, upto(frame + 1) - upto(frame));
        app.update();
        set_ticks(&mut app, 0);
        app.world_mut()
            .spawn(Screenshot::image(handle.clone()))
            .observe(save_to_disk(path(frame)))
            .observe(|_: On<ScreenshotCaptured>, mut taken: ResMut<Taken>| taken.0 += 1);
        for _ in 0..100 {
            app.update();
            if app.world().resource::<Taken>().0 > frame {
                break;
            }
        }
    }
    let taken = app.world().resource::<Taken>().0;
    say(stage, app.world_mut());
    println!(
        "  {taken} of {frames} pictures written, the last is {}",
        path(frames - 1).display()
    );
    if taken == frames {
        AppExit::Success
    } else {
        AppExit::error()
    }
}

/// The clock of the next updates: so many fixed ticks each.
fn set_ticks(app: &mut App, ticks: u32) {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    // Virtual time would cut a long frame short; a film has no such frames to hurry over.
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_max_delta(std::time::Duration::from_secs(3600));
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(tick * ticks));
}
