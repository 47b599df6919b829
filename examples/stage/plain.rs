//! A window drawn by a processor instead of a graphics card: small and simple, so that it keeps up with the clock.

use bevy::prelude::*;
use bevy::render::renderer::RenderAdapterInfo;

/// Width and height of such a window, pixels: a quarter of the usual number of pixels.
const SIZE: (f32, f32) = (640.0, 360.0);

/// Simplifies drawing where the adapter needs it.
pub fn add(app: &mut App) {
    app.add_systems(PostStartup, draw_plainly);
}

fn draw_plainly(
    adapter: Res<RenderAdapterInfo>,
    mut windows: Query<&mut Window>,
    mut smoothing: Query<&mut Msaa>,
    mut lights: Query<&mut DirectionalLight>,
) {
    if adapter.device_type != wgpu::DeviceType::Cpu {
        return;
    }
    println!(
        "{} draws on the processor: a small window, without shadows and smoothed edges",
        adapter.name
    );
    for mut window in &mut windows {
        window.resolution.set(SIZE.0, SIZE.1);
    }
    for mut smoothing in &mut smoothing {
        *smoothing = Msaa::Off;
    }
    for mut light in &mut lights {
        light.shadow_maps_enabled = false;
    }
}
