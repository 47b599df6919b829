//! A game that spawns and despawns springs all the time needs no more memory for it, however long it runs.
//!
//! The engine keeps some of each body that is despawned, so the same game without springs is played beside it.

use attack::lab::app;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Number of scenes that are spawned and despawned, after half as many in which what grows only once has grown.
const ROUNDS: u32 = 300;

/// Number of springs between the beam and each load.
const SPRINGS: u32 = 12;

/// Bytes by which the memory of a game with springs may grow more than without. The engine's tables double at times that depend on
/// random hashes, and so far both games grew by 4 to 37 KB. Sixteen bytes lost with each spring would be 230 KB.
const GROWTH: isize = 40 << 10;

/// What is done with the springs of a scene while it runs.
type Deed = fn(&mut World, &[Entity]);

/// Four loads on a beam, each with a dozen springs: two in flight, two on the ground. Runs them for half a second, and then they are gone.
fn round(app: &mut App, deed: Deed) {
    let world = app.world_mut();
    let beam = (RigidBody::Fixed, Transform::from_xyz(0.0, 3.0, 0.0));
    let beam = world.spawn(beam).id();
    let ground = (Collider::cuboid(9.0, 0.1, 9.0), Transform::default());
    let mut all = vec![beam, world.spawn(ground).id()];
    let mut springs = Vec::new();
    for x in 0..4_u8 {
        let height = if x < 2 { 1.5 } else { 0.3 };
        let load = world.spawn((
            RigidBody::Dynamic,
            Transform::from_xyz(x.into(), height, 0.0),
            Collider::cuboid(0.2, 0.2, 0.2),
            Velocity::default(),
        ));
        let load = load.id();
        all.push(load);
        for _ in 0..SPRINGS {
            let spring = SpringDamper::new(beam, load).with_stiffness(10.0);
            let anchors = Anchors::new(Vec3::ZERO, Vec3::Y * 0.2);
            springs.push(world.spawn((spring, anchors)).id());
        }
    }
    for tick in 0..30 {
        if tick == 15 {
            deed(app.world_mut(), &springs);
        }
        app.update();
    }
    for entity in all.into_iter().chain(springs) {
        if let Ok(entity) = app.world_mut().get_entity_mut(entity) {
            entity.despawn();
        }
    }
    app.update();
}

/// Bytes by which the memory in use grows in [`ROUNDS`].
fn growth(springs: bool, deed: Deed) -> isize {
    let mut app = app(springs);
    for _ in 0..ROUNDS / 2 {
        round(&mut app, deed);
    }
    let region = Region::new(MEMORY);
    for _ in 0..ROUNDS {
        round(&mut app, deed);
    }
    let change = region.change();
    change.bytes_allocated as isize - change.bytes_deallocated as isize
}

#[test]
fn springs_that_come_and_go_leave_no_memory_behind() {
    let deeds: [(&str, Deed); 3] = [
        ("left alone", |_, _| {}),
        ("removed", |world, springs| {
            for spring in springs {
                world.entity_mut(*spring).remove::<SpringDamper>();
            }
        }),
        ("faulty", |world, springs| {
            for spring in springs {
                if let Some(mut spring) = world.get_mut::<SpringDamper>(*spring) {
                    spring.stiffness = f32::NAN;
                }
            }
        }),
    ];
    for (title, deed) in deeds {
        let [without, with] = [false, true].map(|springs| growth(springs, deed));
        println!("{title}: {without:+} bytes without springs, {with:+} bytes with them");
        assert!(with - without <= GROWTH, "{title}: {without} and {with}");
    }
}
