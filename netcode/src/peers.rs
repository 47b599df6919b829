//! Two peers of the game in one program, connected over UDP.

use crate::game::{self, Net, Seen};
use crate::lossy::{Clock, Counts, LossySocket, Weather};
use crate::rollback::{Cost, RollbackPhysicsPlugin};
use bevy::prelude::*;
use bevy_ggrs::Session;
use bevy_ggrs::ggrs::{DesyncDetection, GgrsEvent, PlayerType, SessionBuilder, SessionState};
use std::error::Error;
use std::time::{Duration, Instant};

/// Greatest number of frames that a peer runs ahead of confirmed inputs.
pub const WINDOW: usize = 10;

/// Two connected peers.
pub struct Peers {
    /// Apps of the peers.
    pub apps: [App; 2],
    /// Counters of their sockets.
    pub counts: [Counts; 2],
    /// For each update of a peer that ran ticks: the number of ticks beside the one of the frame itself.
    pub again: [Vec<u32>; 2],
    clock: Clock,
}

/// Results of a run of two peers.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    /// Number of frames whose checksums were compared.
    pub compared: usize,
    /// Number of rollbacks of each peer.
    pub rollbacks: [u32; 2],
    /// Number of frames that each peer ran again.
    pub again: [i64; 2],
}

impl Peers {
    /// Connects two peers over a network of a given quality, both with the given physics.
    pub fn connect(
        weather: Weather,
        physics: RollbackPhysicsPlugin,
    ) -> Result<Self, Box<dyn Error>> {
        let clock = Clock::default();
        let sockets = [
            LossySocket::new(weather, clock.clone(), 1)?,
            LossySocket::new(weather, clock.clone(), 2)?,
        ];
        let addresses = [sockets[0].address()?, sockets[1].address()?];
        let counts = [sockets[0].counts.clone(), sockets[1].counts.clone()];
        let mut apps = Vec::new();
        for (me, socket) in sockets.into_iter().enumerate() {
            let other = 1 - me;
            let session = SessionBuilder::<Net>::new()
                .with_num_players(2)?
                .with_max_prediction_window(WINDOW)
                .with_input_delay(2)
                // This timeout is in real time, and a slow machine is not a lost peer.
                .with_disconnect_timeout(Duration::from_secs(60))
                .with_desync_detection_mode(DesyncDetection::On { interval: 10 })
                .add_player(PlayerType::Local, me)?
                .add_player(PlayerType::Remote(addresses[other]), other)?
                .start_p2p_session(socket)?;
            let session = Session::P2P(session);
            apps.push(game::app(session, physics));
        }
        let [Some(b), Some(a)] = [apps.pop(), apps.pop()] else {
            return Err("two apps".into());
        };
        let mut peers = Self {
            apps: [a, b],
            counts,
            again: default(),
            clock,
        };
        let start = Instant::now();
        while !peers.are_running() {
            peers.update()?;
            // GGRS sends its greeting again after 200 ms of real time.
            std::thread::sleep(Duration::from_millis(2));
            if start.elapsed() > Duration::from_secs(60) {
                return Err("the peers do not find each other".into());
            }
        }
        Ok(peers)
    }

    /// Lets both play until `frames` and some more are confirmed. Compares the checksums of all frames up to `frames`.
    pub fn play(&mut self, frames: i32) -> Result<Reached, Box<dyn Error>> {
        let sure = frames + 2 * WINDOW as i32;
        let mut last = (Instant::now(), -1);
        loop {
            self.update()?;
            let confirmed = self.confirmed();
            if confirmed >= sure {
                break;
            }
            if confirmed > last.1 {
                last = (Instant::now(), confirmed);
            } else if last.0.elapsed() > Duration::from_secs(60) {
                return Err(format!("they stand at frame {confirmed}").into());
            }
        }
        let [a, b] = &self.apps;
        let [a, b] = [a, b].map(|app| &app.world().resource::<Seen>().0);
        let mut compared = 0;
        for frame in 0..=frames {
            // A checksum that is missing at a peer is an error as well.
            match (a.get(&frame), b.get(&frame)) {
                (Some(one), Some(other)) if one == other => compared += 1,
                (one, other) => {
                    return Err(format!("frame {frame}: {one:?} here, {other:?} there").into());
                }
            }
        }
        let cost = |app: &App| *app.world().resource::<Cost>();
        let frame =
            |app: &App| i64::from(app.world().resource::<bevy_ggrs::RollbackFrameCount>().0);
        let [one, other] = &self.apps;
        Ok(Reached {
            compared,
            rollbacks: [cost(one).loaded, cost(other).loaded],
            again: [one, other].map(|app| i64::from(cost(app).ticked) - frame(app) - 1),
        })
    }

    fn update(&mut self) -> Result<(), Box<dyn Error>> {
        self.clock.advance();
        for (app, again) in self.apps.iter_mut().zip(&mut self.again) {
            let before = app.world().resource::<Cost>().ticked;
            app.update();
            let ticks = app.world().resource::<Cost>().ticked - before;
            // One of the ticks is the frame itself. There is none while the peer waits for the other one.
            again.extend(ticks.checked_sub(1));
            let Session::P2P(session) = &mut *app.world_mut().resource_mut::<Session<Net>>() else {
                return Err("no session".into());
            };
            for event in session.events() {
                match event {
                    GgrsEvent::DesyncDetected { frame, .. } => {
                        return Err(format!("GGRS: frame {frame} differs").into());
                    }
                    GgrsEvent::Disconnected { addr } => {
                        return Err(format!("{addr} is gone").into());
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    fn are_running(&self) -> bool {
        self.sessions()
            .all(|session| session.current_state() == SessionState::Running)
    }

    fn confirmed(&self) -> i32 {
        let all = self.sessions().map(|session| session.confirmed_frame());
        all.min().unwrap_or(-1)
    }

    fn sessions(&self) -> impl Iterator<Item = &bevy_ggrs::ggrs::P2PSession<Net>> {
        self.apps
            .iter()
            .filter_map(|app| match app.world().resource() {
                Session::P2P(session) => Some(session),
                _ => None,
            })
    }
}
