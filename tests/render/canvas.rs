//! A view of two metres, seen straight on, and measurements of what is drawn in it.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::image::Image;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use stage::offscreen;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Software adapters are slow: one renderer uses all threads.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub const SIZE: u32 = 512;
/// Width and height of the view, m.
pub const VIEW: f32 = 2.0;
/// Size of a pixel, m.
pub const PIXEL: f32 = VIEW / SIZE as f32;

/// An app that draws, with an orthographic view along −Z.
pub struct Canvas {
    pub app: App,
    image: Handle<Image>,
    _alone: MutexGuard<'static, ()>,
}

/// Whether there is a graphics adapter. Prints a message if there is none, and panics if `COILOVER_MUST_DRAW` is set.
pub fn can_draw() -> bool {
    let can = offscreen::adapter().is_some();
    if !can {
        assert!(
            std::env::var_os("COILOVER_MUST_DRAW").is_none(),
            "no graphics adapter"
        );
        eprintln!(
            "SKIPPED: no graphics adapter on this machine (install mesa-vulkan-drivers for a software one)"
        );
    }
    can
}

/// Makes all other renderers wait while the guard is held.
pub fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Canvas {
    pub fn new() -> Option<Self> {
        if !can_draw() {
            return None;
        }
        let alone = alone();
        let (mut app, image) = offscreen::app(SIZE, SIZE);
        app.add_plugins(CoiloverVisualPlugin)
            .insert_resource(ClearColor(Color::BLACK));
        app.world_mut().spawn((
            Camera3d::default(),
            offscreen::target(&image),
            Transform::from_xyz(0.0, 0.0, 5.0),
            Projection::Orthographic(OrthographicProjection {
                scale: PIXEL,
                ..OrthographicProjection::default_3d()
            }),
            AmbientLight {
                brightness: 600.0,
                ..default()
            },
            Msaa::Off,
            Tonemapping::None,
        ));
        app.finish();
        app.cleanup();
        Some(Self {
            app,
            image,
            _alone: alone,
        })
    }

    /// Takes a picture when everything has been loaded and drawn.
    pub fn shoot(&mut self) -> Image {
        offscreen::settle(&mut self.app);
        offscreen::shoot(&mut self.app, &self.image).expect("a picture within two minutes")
    }
}

/// Draws what `setup` spawns. Returns `None` where there is no adapter.
pub fn draw(setup: impl FnOnce(&mut World)) -> Option<Image> {
    let mut canvas = Canvas::new()?;
    setup(canvas.app.world_mut());
    Some(canvas.shoot())
}

pub fn is_drawn(pixel: [u8; 3]) -> bool {
    pixel.into_iter().any(|c| c > 25)
}

pub fn is_red([r, g, _]: [u8; 3]) -> bool {
    r > g.saturating_add(30)
}

/// Colour of a pixel. x and y count from the top left.
pub fn pixel(picture: &Image, x: u32, y: u32) -> [u8; 3] {
    let data = picture.data.as_ref().expect("pixels");
    let at = ((y * SIZE + x) * 4) as usize;
    [data[at], data[at + 1], data[at + 2]]
}

/// Bounds of the pixels that a test selects, m, and their number.
pub struct Extent {
    pub low: Vec2,
    pub high: Vec2,
    pub count: usize,
}

pub fn extent(picture: &Image, is_it: impl Fn([u8; 3], Vec2) -> bool) -> Extent {
    let mut out = Extent {
        low: Vec2::MAX,
        high: Vec2::MIN,
        count: 0,
    };
    for y in 0..SIZE {
        for x in 0..SIZE {
            let p = (Vec2::new(x as f32, (SIZE - 1 - y) as f32) + 0.5) * PIXEL - VIEW / 2.0;
            if is_it(pixel(picture, x, y), p) {
                out.low = out.low.min(p);
                out.high = out.high.max(p);
                out.count += 1;
            }
        }
    }
    out
}

/// Lengths of the runs of selected pixels in the column at x, m, from the top down. Lengths in pixels.
pub fn runs(picture: &Image, x: f32, is_it: impl Fn([u8; 3]) -> bool) -> Vec<u32> {
    let column = ((x + VIEW / 2.0) / PIXEL) as u32;
    let mut out = Vec::new();
    let mut run = 0;
    for y in 0..SIZE {
        if is_it(pixel(picture, column, y)) {
            run += 1;
        } else if run > 0 {
            out.push(run);
            run = 0;
        }
    }
    out
}

pub fn ends(world: &mut World, a: Vec3, b: Vec3) -> (Entity, Entity) {
    let mut point = |at| world.spawn(Transform::from_translation(at)).id();
    (point(a), point(b))
}
