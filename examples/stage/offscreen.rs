//! Renders pictures without a window. The render tests use this file too.

use bevy::app::{ScheduleRunnerPlugin, TerminalCtrlCHandlerPlugin};
use bevy::asset::RenderAssetUsages;
use bevy::camera::{RenderTarget, Viewport};
use bevy::image::Image;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PipelineCache, TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use std::time::{Duration, Instant};

/// Longest wait for anything here, on the slowest machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Number of updates without a shader compilation after which a picture is complete.
const QUIET: u32 = 4;
/// Number by which width and height of the picture are divided while shaders are compiled.
const SMALLER: u32 = 8;

/// Returns the name of an adapter that can render, including software adapters.
pub fn adapter() -> Option<String> {
    let instance = wgpu::Instance::default();
    let adapters = bevy::tasks::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    adapters.first().map(|adapter| {
        let info = adapter.get_info();
        format!("{} ({})", info.name, info.backend)
    })
}

/// Returns an app without a window, and the image for its camera to draw into.
pub fn app(width: u32, height: u32) -> (App, Handle<Image>) {
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            // A picture requested in one update shows that update.
            .disable::<PipelinedRenderingPlugin>()
            // It only asks an app to end, and whoever calls `update` himself would have to look. Without it, Ctrl-C ends the
            // program at once, as it should.
            .disable::<TerminalCtrlCHandlerPlugin>()
            .disable::<LogPlugin>()
            .disable::<WinitPlugin>(),
        ScheduleRunnerPlugin::default(),
    ))
    .init_resource::<Picture>();
    let mut image = Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
    image.asset_usage = RenderAssetUsages::default();
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    (app, image)
}

/// Returns the image as a render target for the camera.
pub fn target(image: &Handle<Image>) -> RenderTarget {
    RenderTarget::Image(image.clone().into())
}

#[derive(Resource, Default)]
struct Picture(Option<Image>);

/// Updates until nothing is missing from the picture: shaders are compiled in the background. Until then the cameras draw small
/// pictures, because nobody looks at them and a software adapter takes long for each pixel.
pub fn settle(app: &mut App) {
    each_camera(app, |camera| {
        camera.viewport = camera.physical_target_size().map(|size| Viewport {
            physical_size: (size / SMALLER).max(UVec2::ONE),
            ..default()
        });
    });
    compile(app);
    each_camera(app, |camera| camera.viewport = None);
}

fn each_camera(app: &mut App, change: impl Fn(&mut Camera)) {
    let mut cameras = app.world_mut().query::<&mut Camera>();
    for mut camera in cameras.iter_mut(app.world_mut()) {
        change(&mut camera);
    }
}

fn compile(app: &mut App) {
    let begun = Instant::now();
    let mut quiet = 0;
    while quiet < QUIET && begun.elapsed() < PATIENCE {
        app.update();
        let busy = is_compiling(app);
        quiet = if busy { 0 } else { quiet + 1 };
        if busy {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

fn is_compiling(app: &App) -> bool {
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    cache.waiting_pipelines().next().is_some()
}

/// Returns what the camera sees at the end of the next update. Two updates draw: entities that no camera has seen
/// before are drawn only in the second. `then` is called after the first.
pub fn shoot_next(
    app: &mut App,
    image: &Handle<Image>,
    then: impl FnOnce(&mut App),
) -> Option<Image> {
    app.update();
    then(app);
    ask(app, image);
    app.update();
    let picture = undrawn(app, wait);
    if !is_compiling(app) {
        return picture;
    }
    // An entity is in view that never was before.
    settle(app);
    shoot(app, image)
}

/// Returns what the camera sees now.
pub fn shoot(app: &mut App, image: &Handle<Image>) -> Option<Image> {
    ask(app, image);
    wait(app)
}

/// Calls `act` without drawing: software adapters take long for a picture that nobody looks at.
pub fn undrawn<T>(app: &mut App, act: impl FnOnce(&mut App) -> T) -> T {
    each_camera(app, |camera| camera.is_active = false);
    let out = act(app);
    each_camera(app, |camera| camera.is_active = true);
    out
}

fn ask(app: &mut App, image: &Handle<Image>) {
    app.world_mut()
        .spawn(Screenshot::image(image.clone()))
        .observe(
            |shot: On<ScreenshotCaptured>, mut picture: ResMut<Picture>| {
                picture.0 = Some(shot.image.clone());
            },
        );
}

/// Updates until the requested picture has arrived.
fn wait(app: &mut App) -> Option<Image> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        app.update();
        if let Some(picture) = app.world_mut().resource_mut::<Picture>().0.take() {
            return Some(picture);
        }
    }
    None
}
