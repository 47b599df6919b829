//! A UDP socket over which messages come late, in disorder, or never.

use bevy_ggrs::ggrs::{Message, NonBlockingSocket};
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// What a net does to messages.
#[derive(Clone, Copy, Debug)]
pub struct Weather {
    /// Ticks that each takes at least.
    pub delay: u32,
    /// Ticks that it may take longer, each number as likely.
    pub jitter: u32,
    /// The share that is lost.
    pub loss: f64,
}

/// The clock of a net, in ticks. The test moves it, so nothing waits for real time.
#[derive(Clone, Debug, Default)]
pub struct Clock(Arc<AtomicU32>);

impl Clock {
    /// A tick later.
    pub fn advance(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn now(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

/// How many messages a socket has seen.
#[derive(Clone, Debug, Default)]
pub struct Counts(Arc<[AtomicU32; 4]>);

impl Counts {
    /// Sent, with those that were lost.
    pub fn sent(&self) -> u32 {
        self.get(0)
    }

    /// Lost.
    pub fn lost(&self) -> u32 {
        self.get(1)
    }

    /// That overtook an earlier one.
    pub fn overtaken(&self) -> u32 {
        self.get(2)
    }

    /// Bytes that GGRS sent.
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

/// Numbers that look random and repeat: splitmix64.
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

    /// From 0 to 1.
    pub fn share(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A message under way.
struct Held {
    due: u32,
    from: SocketAddr,
    bytes: Vec<u8>,
}

/// The socket.
pub struct LossySocket {
    socket: UdpSocket,
    weather: Weather,
    clock: Clock,
    random: Random,
    held: Vec<Held>,
    /// What it has done.
    pub counts: Counts,
}

impl LossySocket {
    /// On loopback, on a port that is free.
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

    /// Where it listens.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Takes what has come from the real socket, and says when it is to be seen.
    fn take_in(&mut self) {
        let mut buffer = [0; 4096];
        while let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
            let Some((sent, bytes)) = buffer[..length].split_first_chunk() else {
                continue;
            };
            let span = u64::from(self.weather.jitter) + 1;
            let more = (self.random.next_u64() % span) as u32;
            self.held.push(Held {
                due: u32::from_le_bytes(*sent) + self.weather.delay + more,
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
        // The tick goes along, so that delays are what they should be whichever peer has its turn first.
        let dated = [&self.clock.now().to_le_bytes()[..], &bytes].concat();
        // What the real socket loses is lost.
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
