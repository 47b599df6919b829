//! Memory that springs take: `cargo bench -p benches --bench memory`.
//!
//! Everything on the heap after twenty steps, minus that of the same bodies without springs.

use benches::{Link, Scene};
use bevy::prelude::*;
use bevy_coilover::SpringLoad;
use bevy_rapier3d::prelude::{ExternalForce, RigidBody};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// As large as [`SpringLoad`], which only the crate can make.
#[derive(Component, Clone)]
#[expect(dead_code, reason = "only its size matters")]
struct Stand([u8; size_of::<SpringLoad>()]);

/// Gives every body the components that a spring gives it.
fn load(world: &mut World) {
    let mut bodies = world.query_filtered::<Entity, With<RigidBody>>();
    let loads = (ExternalForce::default(), Stand([0; _]));
    let bodies: Vec<_> = bodies
        .iter(world)
        .map(|body| (body, loads.clone()))
        .collect();
    world.insert_batch(bodies);
}

/// Returns the bytes that an app holds on the heap after a change.
fn held_after(scene: Scene, count: u32, link: Link, change: fn(&mut World)) -> usize {
    let live = || {
        let stats = GLOBAL.stats();
        stats.bytes_allocated - stats.bytes_deallocated
    };
    let before = live();
    let mut app = scene.app(count, link);
    change(app.world_mut());
    let bytes = live() - before;
    drop(app);
    bytes
}

/// Returns the bytes that an app holds on the heap.
fn held(scene: Scene, count: u32, link: Link) -> usize {
    held_after(scene, count, link, |_| {})
}

fn main() {
    // The first app of a process allocates memory that stays.
    held(Scene::Isolated, 1, Link::Ours);
    for count in [1 << 13, 1 << 16] {
        let nothing = held(Scene::Isolated, count, Link::Nothing);
        let loaded = held_after(Scene::Isolated, count, Link::Nothing, load);
        println!(
            "{count} pairs of bodies with forces, without springs: {} bytes a pair",
            loaded.saturating_sub(nothing) / count as usize
        );
        for link in [
            Link::Bare,
            Link::Joint,
            Link::Ours,
            Link::Laws,
            Link::Turning,
        ] {
            let bytes = held(Scene::Isolated, count, link).saturating_sub(nothing);
            println!(
                "{count} of {link:?}: {} bytes a spring",
                bytes / count as usize
            );
        }
    }
    for count in [1 << 13, 1 << 16] {
        let nothing = held(Scene::Chain, count, Link::Nothing);
        let bytes = held(Scene::Chain, count, Link::Ours).saturating_sub(nothing);
        println!(
            "{count} in a chain: {} bytes a spring",
            bytes / count as usize
        );
    }
}
