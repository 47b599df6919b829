//! Is what is drawn where the ends are, and does it look like anything?
//!
//! Needs a Vulkan, Metal or DirectX adapter, a software one included; says so and passes where there is
//! none.

use bevy::app::ScheduleRunnerPlugin;
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::image::Image;
use bevy::prelude::*;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy::window::ExitCondition;
use bevy::winit::WinitPlugin;
use bevy_coilover::prelude::*;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Software adapters are slow, and one renderer has all their threads.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

const SIZE: u32 = 256;
/// Metres that the picture is wide and high.
const VIEW: f32 = 2.0;

#[derive(Resource, Default)]
struct Picture(Option<Image>);

fn has_adapter() -> bool {
    let instance = wgpu::Instance::default();
    !bevy::tasks::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY)).is_empty()
}

/// Draws what `setup` spawns, seen along −Z without perspective, and returns the picture.
fn draw(setup: impl FnOnce(&mut World)) -> Option<Image> {
    if !has_adapter() {
        eprintln!(
            "SKIPPED: no graphics adapter on this machine (install mesa-vulkan-drivers for a software one)"
        );
        return None;
    }
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .disable::<bevy::log::LogPlugin>()
            .disable::<WinitPlugin>(),
        ScheduleRunnerPlugin::default(),
        CoiloverVisualPlugin,
    ))
    .insert_resource(ClearColor(Color::BLACK))
    .init_resource::<Picture>();
    let mut image = Image::new_target_texture(SIZE, SIZE, TextureFormat::Rgba8UnormSrgb, None);
    image.asset_usage = RenderAssetUsages::default();
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let target = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    app.world_mut().spawn((
        Camera3d::default(),
        RenderTarget::Image(target.clone().into()),
        Transform::from_xyz(0.0, 0.0, 5.0),
        Projection::Orthographic(OrthographicProjection {
            scale: VIEW / SIZE as f32,
            ..OrthographicProjection::default_3d()
        }),
        AmbientLight {
            brightness: 600.0,
            ..default()
        },
        Msaa::Off,
        Tonemapping::None,
    ));
    // Pipelines are compiled in the background: the picture is ready when this mark is on it.
    let mark = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(0.1, 0.1));
    let green = StandardMaterial {
        base_color: Color::srgb(0.0, 1.0, 0.0),
        unlit: true,
        ..default()
    };
    let green = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(green);
    app.world_mut().spawn((
        Mesh3d(mark),
        MeshMaterial3d(green),
        Transform::from_xyz(-0.9, -0.9, 0.0),
    ));
    setup(app.world_mut());
    app.finish();
    app.cleanup();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(120) {
        app.update();
        app.world_mut()
            .spawn(Screenshot::image(target.clone()))
            .observe(
                |shot: On<ScreenshotCaptured>, mut picture: ResMut<Picture>| {
                    picture.0 = Some(shot.image.clone());
                },
            );
        app.update();
        let picture = app.world_mut().resource_mut::<Picture>().0.take();
        if let Some(picture) = picture
            && extent(&picture, |pixel, _| is_mark(pixel)).count > 0
        {
            return Some(picture);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("nothing was drawn in two minutes");
}

fn is_mark(pixel: [u8; 3]) -> bool {
    let [r, g, b] = pixel.map(u16::from);
    g > 40 && g > 3 * r.max(b)
}

fn is_drawn(pixel: [u8; 3]) -> bool {
    pixel.into_iter().any(|c| c > 25) && !is_mark(pixel)
}

/// Where the pixels lie that a test picks, in metres, and how many they are.
struct Extent {
    low: Vec2,
    high: Vec2,
    count: usize,
}

fn extent(picture: &Image, is_it: impl Fn([u8; 3], Vec2) -> bool) -> Extent {
    let data = picture.data.as_ref().expect("pixels");
    let mut out = Extent {
        low: Vec2::MAX,
        high: Vec2::MIN,
        count: 0,
    };
    for y in 0..SIZE {
        for x in 0..SIZE {
            let at = ((y * SIZE + x) * 4) as usize;
            let p = (Vec2::new(x as f32, (SIZE - 1 - y) as f32) + 0.5) * PIXEL - VIEW / 2.0;
            if is_it([data[at], data[at + 1], data[at + 2]], p) {
                out.low = out.low.min(p);
                out.high = out.high.max(p);
                out.count += 1;
            }
        }
    }
    out
}

fn ends(world: &mut World, a: Vec3, b: Vec3) -> (Entity, Entity) {
    let mut point = |at| world.spawn(Transform::from_translation(at)).id();
    (point(a), point(b))
}

const PIXEL: f32 = VIEW / SIZE as f32;

#[test]
fn a_coil_is_drawn_between_its_ends_at_any_stretch() {
    for (length, rest) in [(1.2, 1.2), (1.6, 1.2), (0.6, 1.2)] {
        let Some(picture) = draw(|world| {
            let (a, b) = ends(world, Vec3::NEG_Y * 0.8, Vec3::Y * (length - 0.8));
            world.spawn((
                Spring::new(a, b).with_rest_length(rest),
                Coil::new(0.2, 0.03, 6.0).with_color(Color::srgb(1.0, 0.0, 0.0)),
            ));
        }) else {
            return;
        };
        // The seats beyond its ends are grey.
        let coil = extent(&picture, |[r, g, _], _| r > g.saturating_add(40));
        assert!(
            (coil.low.y + 0.8).abs() < 2.0 * PIXEL,
            "{length}: foot at {}",
            coil.low.y
        );
        assert!(
            (coil.high.y - length + 0.8).abs() < 2.0 * PIXEL,
            "{length}: top at {}",
            coil.high.y
        );
        assert!(
            (coil.low.x + 0.23).abs() < 2.0 * PIXEL && (coil.high.x - 0.23).abs() < 2.0 * PIXEL
        );
        // A coil, not a tube: more than a fifth of its outline shows what is behind.
        let outline = (coil.high - coil.low) / PIXEL;
        let share = coil.count as f32 / (outline.x * outline.y);
        assert!((0.1..0.8).contains(&share), "{length}: {share} covered");
    }
}

#[test]
fn a_telescope_is_a_wide_tube_and_a_thin_rod_from_end_to_end() {
    let Some(picture) = draw(|world| {
        let (a, b) = ends(world, Vec3::NEG_Y * 0.7, Vec3::Y * 0.7);
        world.spawn((
            Damper::new(a, b),
            Telescope {
                tube_radius: 0.2,
                rod_radius: 0.05,
                color: Color::srgb(0.0, 0.0, 1.0),
                ..default()
            },
        ));
    }) else {
        return;
    };
    let all = extent(&picture, |pixel, _| is_drawn(pixel));
    assert!((all.low.y + 0.7).abs() < 2.0 * PIXEL && (all.high.y - 0.7).abs() < 2.0 * PIXEL);
    let wide = extent(&picture, |pixel, p| is_drawn(pixel) && p.x.abs() > 0.1);
    assert!((wide.high.x - 0.2).abs() < 2.0 * PIXEL, "{}", wide.high.x);
    // 0.55 of the length when first drawn.
    assert!(
        (wide.high.y + 0.7 - 0.55 * 1.4).abs() < 2.0 * PIXEL,
        "{}",
        wide.high.y
    );
    let rod = extent(&picture, |pixel, p| is_drawn(pixel) && p.y > 0.3);
    assert!((rod.high.x - 0.05).abs() < 2.0 * PIXEL, "{}", rod.high.x);
}

#[test]
fn a_coil_that_cannot_be_wound_is_told_and_nothing_is_drawn() {
    let Some(picture) = draw(|world| {
        let (a, b) = ends(world, Vec3::NEG_Y, Vec3::Y);
        world.spawn((Spring::new(a, b), Coil::new(0.1, 0.2, f32::NAN)));
    }) else {
        return;
    };
    let drawn = extent(&picture, |pixel, _| is_drawn(pixel));
    assert_eq!(drawn.count, 0);
}
