//! A UDP socket that delays, reorders and loses messages.

use bevy_ggrs::ggrs::{Message, NonBlockingSocket};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Quality of a network.
#[derive(Clone, Copy, Debug)]
pub struct Weather {
    /// Least delay of a message, ticks.
    pub delay: u32,
    /// Greatest additional delay, ticks. Its distribution is uniform.
    pub jitter: u32,
    /// Share of messages that are lost.
    pub loss: f64,
}

/// Clock of a network, in ticks. The test moves it, so nothing waits for real time.
#[derive(Clone, Debug, Default)]
pub struct Clock(Arc<AtomicU32>);

impl Clock {
    /// Moves the clock on by a tick.
    pub fn advance(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn now(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Counters of a socket.
#[derive(Clone, Debug, Default)]
pub struct Counts(Arc<[AtomicU32; 4]>);

impl Counts {
    /// Number of messages sent, including lost ones.
    pub fn sent(&self) -> u32 {
        self.get(0)
    }

    /// Number of messages lost.
    pub fn lost(&self) -> u32 {
        self.get(1)
    }

    /// Number of messages that overtook an earlier one.
    pub fn overtaken(&self) -> u32 {
        self.get(2)
    }

    /// Number of bytes that GGRS sent.
    pub fn bytes(&self) -> u32 {
        self.get(3)
    }

    fn get(&self, which: usize) -> u32 {
        self.0[which].load(Ordering::Relaxed)
    }

    fn add(&self, which: usize, many: usize) {
        let many = u32::try_from(many).unwrap_or(u32::MAX);
        self.0[which].fetch_add(many, Ordering::Relaxed);
    }
}

/// Pseudo-random numbers that are the same in each run: splitmix64.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next number.
    pub fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// The next number from 0 to 1.
    pub fn share(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Greatest number of ticks by which a message may be dated ahead of this peer's clock: a second. Peers drift by a few ticks.
const AHEAD: u32 = 60;
/// Greatest number of messages that are held back. Two peers hold a few dozen.
const MOST_HELD: usize = 4096;

/// A received message that is not delivered yet.
struct Held {
    due: u32,
    from: SocketAddr,
    bytes: Vec<u8>,
}

/// A UDP socket with a network of a given quality.
pub struct LossySocket {
    socket: UdpSocket,
    weather: Weather,
    clock: Clock,
    random: Random,
    held: Vec<Held>,
    /// Counters of this socket.
    pub counts: Counts,
}

impl LossySocket {
    /// Binds to a free port on loopback.
    pub fn new(weather: Weather, clock: Clock, seed: u64) -> io::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            weather,
            clock,
            random: Random(seed),
            held: Vec::new(),
            counts: Counts::default(),
        })
    }

    /// Address of the socket.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Receives from the real socket, and sets the tick at which each message is delivered.
    fn take_in(&mut self) {
        let mut buffer = [0; 4096];
        while let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
            let Some((sent, bytes)) = buffer[..length].split_first_chunk() else {
                continue;
            };
            // Anybody may send such bytes, as many as he likes, and with a tick that never comes.
            let sent = u32::from_le_bytes(*sent);
            if sent > self.clock.now().saturating_add(AHEAD) || self.held.len() >= MOST_HELD {
                continue;
            }
            let span = u64::from(self.weather.jitter) + 1;
            let more = (self.random.next_u64() % span) as u32;
            self.held.push(Held {
                due: sent.saturating_add(self.weather.delay.saturating_add(more)),
                from,
                bytes: bytes.to_vec(),
            });
        }
    }
}

impl NonBlockingSocket<SocketAddr> for LossySocket {
    fn send_to(&mut self, message: &Message, to: &SocketAddr) {
        let Ok(bytes) = bincode::serialize(message) else {
            return;
        };
        self.counts.add(0, 1);
        self.counts.add(3, bytes.len());
        if self.random.share() < self.weather.loss {
            self.counts.add(1, 1);
            return;
        }
        // The tick is sent along, so that the delay does not depend on which peer updates first.
        let dated = [&self.clock.now().to_le_bytes()[..], &bytes].concat();
        // A message that the real socket fails to send is lost.
        let _ = self.socket.send_to(&dated, to);
    }

    fn receive_all_messages(&mut self) -> Vec<(SocketAddr, Message)> {
        self.take_in();
        let now = self.clock.now();
        let (mut here, mut late) = (Vec::new(), false);
        let mut overtaken = 0;
        self.held.retain(|held| {
            let is_here = held.due <= now;
            if is_here {
                overtaken += usize::from(late);
                if let Ok(message) = bincode::deserialize(&held.bytes) {
                    here.push((held.from, message));
                }
            }
            late |= !is_here;
            !is_here
        });
        self.counts.add(2, overtaken);
        here
    }
}
