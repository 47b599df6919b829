//! Two peers of the game, in one program, over UDP.

use crate::game::{self, Net, Seen};
use crate::lossy::{Clock, Counts, LossySocket, Weather};
use crate::rollback::{Cost, RollbackPhysicsPlugin};
use bevy::prelude::*;
use bevy_ggrs::Session;
use bevy_ggrs::ggrs::{DesyncDetection, GgrsEvent, PlayerType, SessionBuilder, SessionState};
use std::error::Error;
use std::time::{Duration, Instant};

/// Frames that peers may run ahead of what they know.
pub const WINDOW: usize = 10;

/// Two peers.
pub struct Peers {
    /// Their apps.
    pub apps: [App; 2],
    /// What their sockets did.
    pub counts: [Counts; 2],
    /// Frames that each ran again before each of its own.
    pub again: [Vec<u32>; 2],
    clock: Clock,
}

/// How far two peers came.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    /// Frames whose checksums were compared.
    pub compared: usize,
    /// How often each went back.
    pub rollbacks: [u32; 2],
    /// Frames that each ran more than once.
    pub again: [i64; 2],
}

impl Peers {
    /// Connects two that play on such physics.
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
                // Real time: a slow machine is no lost peer.
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
            // GGRS greets anew after 200 ms of real time.
            std::thread::sleep(Duration::from_millis(2));
            if start.elapsed() > Duration::from_secs(60) {
                return Err("the peers do not find each other".into());
            }
        }
        Ok(peers)
    }

    /// Has both play until so many frames are sure, and compares them all.
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
            // Frames before the first are those that no rollback reaches.
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
            // One of them is the frame itself; there is none while it waits for the other peer.
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
