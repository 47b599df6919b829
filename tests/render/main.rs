//! Is what is drawn where the ends are, and does it have the right shape?
//!
//! Needs a Vulkan, Metal or DirectX adapter; a software adapter is enough. Without an adapter, each test prints a
//! message and passes.

mod batches;
mod canvas;
mod sight;
mod spiral;
mod wire;

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use canvas::*;

#[test]
fn a_coil_is_drawn_between_its_ends_at_any_stretch() {
    for (length, rest) in [(1.2, 1.2), (1.6, 1.2), (0.6, 1.2)] {
        let Some(picture) = draw(|world| {
            let (a, b) = ends(world, Vec3::NEG_Y * 0.8, Vec3::Y * (length - 0.8));
            world.spawn((
                Spring::new(a, b).with_rest_length(rest),
                Coil::new(0.2, 0.02, 6.0).with_color(Color::srgb(1.0, 0.0, 0.0)),
            ));
        }) else {
            return;
        };
        let coil = extent(&picture, |pixel, _| is_red(pixel));
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
            (coil.low.x + 0.22).abs() < 2.0 * PIXEL && (coil.high.x - 0.22).abs() < 2.0 * PIXEL
        );
        // It must look like a coil, not like a tube: more than a fifth of its outline shows the background.
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
                tube_length: Some(0.8),
                rod_length: Some(1.0),
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
    // The collar at the open end of the tube is a little wider.
    assert!((wide.high.x - 0.224).abs() < 2.0 * PIXEL, "{}", wide.high.x);
    let below = extent(&picture, |pixel, p| is_drawn(pixel) && p.y < -0.2);
    assert!((below.high.x - 0.2).abs() < 2.0 * PIXEL, "{}", below.high.x);
    assert!(
        (wide.high.y + 0.7 - 0.8).abs() < 2.0 * PIXEL,
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
