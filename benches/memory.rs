//! Memory that springs take: `cargo bench -p benches --bench memory`.
//!
//! Everything on the heap after twenty steps, minus that of the same bodies without springs.

use benches::{Link, Scene};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Returns the bytes that an app holds on the heap.
fn held(scene: Scene, count: u32, link: Link) -> usize {
    let live = || {
        let stats = GLOBAL.stats();
        stats.bytes_allocated - stats.bytes_deallocated
    };
    let before = live();
    let app = scene.app(count, link, 1);
    let bytes = live() - before;
    drop(app);
    bytes
}

fn main() {
    // The first app of a process allocates memory that stays.
    held(Scene::Isolated, 1, Link::Ours);
    for count in [1 << 13, 1 << 16] {
        let nothing = held(Scene::Isolated, count, Link::Nothing);
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
