//! Do many springs need as few draws as one?

use crate::canvas::*;
use bevy::core_pipeline::core_3d::Opaque3d;
use bevy::pbr::Shadow;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_phase::{BinnedPhaseItem, ViewBinnedRenderPhases};
use bevy_coilover::prelude::*;

/// Number of draws in the phases of one kind.
fn draws<P: BinnedPhaseItem>(app: &App) -> usize {
    let world = app.sub_app(RenderApp).world();
    let phases = world.resource::<ViewBinnedRenderPhases<P>>();
    let unbatchable = |phase: &bevy::render::render_phase::BinnedRenderPhase<P>| {
        let each = phase.unbatchable_meshes.values();
        each.map(|u| u.entities.len()).sum::<usize>()
    };
    phases
        .values()
        .map(|p| p.multidrawable_meshes.len() + p.batchable_meshes.len() + unbatchable(p))
        .sum()
}

fn count(springs: u32) -> Option<(usize, usize)> {
    let mut canvas = Canvas::new()?;
    let world = canvas.app.world_mut();
    world.spawn((
        DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::default().looking_to(Vec3::new(0.3, -0.2, -1.0), Vec3::Y),
    ));
    for i in 0..springs {
        let foot = Vec3::new(-0.9 + 0.006 * i as f32, -0.5, -0.01 * i as f32);
        let length = 0.4 + 0.003 * i as f32;
        let (a, b) = ends(world, foot, foot + Vec3::Y * length);
        world.spawn((Spring::new(a, b), Coil::new(0.05, 0.006, 6.0)));
    }
    canvas.shoot();
    Some((draws::<Opaque3d>(&canvas.app), draws::<Shadow>(&canvas.app)))
}

#[test]
fn three_hundred_springs_of_all_lengths_are_as_many_draws_as_one() {
    let (Some(one), Some(many)) = (count(1), count(300)) else {
        return;
    };
    println!("draws in the picture and in shadow maps: {one:?} for one spring, {many:?} for 300");
    assert!(one.0 == 1 && one.1 >= 1, "{one:?}");
    assert_eq!(one, many);
}
