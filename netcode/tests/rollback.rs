//! Springs go back under GGRS, and are the same at both peers.
//!
//! Set `COILOVER_NET_SECONDS=600` for ten simulated minutes.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_ggrs::{RollbackFrameCount, Session};
use bevy_rapier3d::prelude::*;
use netcode::game::{self, Lift, Mismatches, RATE, Seen};
use netcode::lossy::Weather;
use netcode::peers::Peers;
use netcode::rollback::{Cost, RollbackPhysicsPlugin};
use std::collections::HashSet;
use std::f32::consts::TAU;

/// Number of frames to play.
fn frames() -> i32 {
    let seconds = std::env::var("COILOVER_NET_SECONDS");
    let seconds = seconds.map_or(20, |text| text.parse().expect("a number of seconds"));
    seconds * i32::from(RATE)
}

const WEATHER: Weather = Weather {
    delay: 3,
    jitter: 3,
    loss: 0.05,
};

const FORGETFUL: RollbackPhysicsPlugin = RollbackPhysicsPlugin {
    springs: false,
    rate: RATE,
};

/// Plays alone and goes back by 7 frames in every frame. Returns the number of mismatches, and the cost.
fn sync_test(frames: i32, physics: RollbackPhysicsPlugin) -> (usize, Cost) {
    let session = game::sync_test(7).expect("a session");
    let mut app = game::app(Session::SyncTest(session), physics);
    while app.world().resource::<RollbackFrameCount>().0 < frames {
        app.update();
        if !app.world().resource::<Mismatches>().0.is_empty() {
            break;
        }
    }
    let world = app.world();
    let seen = &world.resource::<Seen>().0;
    let moved = seen.values().collect::<HashSet<_>>();
    // The scene has to move, or the comparison says nothing.
    assert!(moved.len() > seen.len() / 2 || seen.len() < 10);
    (
        world.resource::<Mismatches>().0.len(),
        *world.resource::<Cost>(),
    )
}

#[test]
fn the_scene_has_all_that_springs_remember_something_of() {
    let session = game::sync_test(1).expect("a session");
    let physics = RollbackPhysicsPlugin::default();
    let mut app = game::app(Session::SyncTest(session), physics);
    let (mut turned, mut slack, mut taut) = (0.0_f32, false, false);
    let (mut asleep, mut contacts, mut lengths) = (false, HashSet::new(), HashSet::new());
    for _ in 0..20 * u32::from(RATE) {
        app.update();
        let world = app.world_mut();
        let mut torsion = world.query_filtered::<&SpringReadout, With<TorsionSpringDamper>>();
        torsion
            .iter(world)
            .for_each(|seen| turned = turned.max(seen.length.abs()));
        let mut ropes = world.query_filtered::<&SpringReadout, With<SpringAction>>();
        for seen in ropes.iter(world) {
            (slack, taut) = (
                slack || seen.spring_force == 0.0,
                taut || seen.spring_force > 0.0,
            );
        }
        let mut bodies = world.query::<&Sleeping>();
        asleep |= bodies.iter(world).any(|body| body.sleeping);
        let mut engine = world.query::<&RapierContextSimulation>();
        let engine = engine.single(world).expect("an engine");
        let pairs = engine.narrow_phase.contact_pairs();
        contacts.insert(pairs.filter(|pair| pair.has_any_active_contact()).count());
        let mut lifts = world.query_filtered::<&SpringDamper, With<Lift>>();
        lengths.extend(
            lifts
                .iter(world)
                .filter_map(|lift| lift.rest_length.map(f32::to_bits)),
        );
    }
    assert!(turned > 2.0 * TAU, "{turned}");
    assert!(slack && taut && asleep, "{slack} {taut} {asleep}");
    assert!(contacts.len() > 1 && lengths.len() > 50, "{contacts:?}");
}

#[test]
fn frames_that_are_run_again_come_out_the_same() {
    let frames = frames();
    let (mismatches, cost) = sync_test(frames, RollbackPhysicsPlugin::default());
    assert_eq!(mismatches, 0);
    println!("{frames} frames: {cost:?}");
    assert!(cost.loaded as i32 > frames - 20, "{cost:?}");
    assert!(cost.ticked as i32 > 7 * (frames - 20), "{cost:?}");
}

#[test]
fn without_the_springs_snapshot_they_do_not() {
    let (mismatches, _) = sync_test(600, FORGETFUL);
    assert!(mismatches > 0);
}

#[test]
fn ggrs_finds_out_that_peers_without_it_differ() {
    let mut peers = Peers::connect(WEATHER, FORGETFUL).expect("connected");
    let verdict = peers.play(600).expect_err("they differ").to_string();
    println!("{verdict}");
    assert!(verdict.starts_with("GGRS: "), "{verdict}");
}

#[test]
fn two_peers_agree_over_a_net_that_loses_and_delays() {
    let physics = RollbackPhysicsPlugin::default();
    let mut peers = Peers::connect(WEATHER, physics).expect("connected");
    let frames = frames();
    let reached = peers.play(frames).expect("all frames agree");
    println!("{reached:?}");
    assert_eq!(reached.compared, frames as usize + 1);
    for (rollbacks, again) in reached.rollbacks.into_iter().zip(reached.again) {
        assert!(rollbacks as i32 > frames / 20, "{reached:?}");
        assert!(again > i64::from(rollbacks), "{reached:?}");
    }
    for counts in &peers.counts {
        let share = f64::from(counts.lost()) / f64::from(counts.sent());
        println!(
            "{} messages of {} bytes, {share:.3} lost, {} overtook others",
            counts.sent(),
            counts.bytes() / counts.sent(),
            counts.overtaken()
        );
        assert!((0.02..0.08).contains(&share), "{share}");
        assert!(counts.overtaken() > 0);
    }
}
