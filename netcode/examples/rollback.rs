//! Two peers play over UDP with delay, jitter and loss, and their checksums are compared. Then a SyncTest session
//! measures the cost of running frames again. The exit code is the verdict.
//!
//! Run `cargo run --release -p netcode --example rollback -- SECONDS`.

use bevy_ggrs::{RollbackFrameCount, Session};
use netcode::game::{self, Mismatches, RATE};
use netcode::lossy::Weather;
use netcode::peers::Peers;
use netcode::rollback::{Cost, RollbackPhysicsPlugin};
use std::error::Error;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let seconds = std::env::args()
        .nth(1)
        .map_or(Ok(20), |text| text.parse())?;
    let frames = seconds * i32::from(RATE);
    play(frames)?;
    let frames = frames.min(3600);
    for distance in [0, 1, 7] {
        cost(distance, frames)?;
    }
    Ok(())
}

fn play(frames: i32) -> Result<(), Box<dyn Error>> {
    let weather = Weather {
        delay: 3,
        jitter: 3,
        loss: 0.05,
    };
    let mut peers = Peers::connect(weather, RollbackPhysicsPlugin::default())?;
    let reached = peers.play(frames)?;
    println!(
        "{} frames agree over delays of 50 to 100 ms and a loss of 5 %",
        reached.compared
    );
    for peer in 0..2 {
        let counts = &peers.counts[peer];
        println!(
            "peer {peer}: went back {} times, ran {} frames again; sent {} bytes in each of {} messages, of which {} were lost",
            reached.rollbacks[peer],
            reached.again[peer],
            counts.bytes() / counts.sent().max(1),
            counts.sent(),
            counts.lost(),
        );
    }
    Ok(())
}

/// Measures the cost of going back in the same game.
fn cost(distance: usize, frames: i32) -> Result<(), Box<dyn Error>> {
    let session = game::sync_test(distance)?;
    let mut app = game::app(Session::SyncTest(session), RollbackPhysicsPlugin::default());
    let start = Instant::now();
    while app.world().resource::<RollbackFrameCount>().0 < frames {
        app.update();
    }
    let all = start.elapsed();
    if !app.world().resource::<Mismatches>().0.is_empty() {
        return Err("frames came out otherwise when they were run again".into());
    }
    let cost = *app.world().resource::<Cost>();
    let each = |time: Duration, many: u32| 1e6 * time.as_secs_f64() / f64::from(many.max(1));
    match distance {
        0 => println!("never going back, µs:"),
        _ => {
            println!("going back {distance} frames in every frame, µs:");
            println!(
                "  put a snapshot back  {:6.1}",
                each(cost.loading, cost.loaded)
            );
            println!(
                "  take a snapshot      {:6.1}",
                each(cost.saving, cost.saved)
            );
        }
    }
    println!(
        "  a tick               {:6.1}",
        each(cost.ticking, cost.ticked)
    );
    println!("  a frame, all in all  {:6.1}", each(all, cost.ticked));
    Ok(())
}
