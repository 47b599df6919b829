//! A relay between a client and the server: it counts what passes on the wire, and loses some of it.

use crate::lossy::Random;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

/// The relay of one client.
pub struct Relay {
    /// Where the client sends to.
    front: UdpSocket,
    /// What the server takes for the client.
    back: UdpSocket,
    server: SocketAddr,
    client: Option<SocketAddr>,
    loss: f64,
    random: Random,
    /// What went to the client, lost or not.
    pub down: Passed,
    /// What went to the server, lost or not.
    pub up: Passed,
}

/// What passed one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// Datagrams.
    pub packets: u64,
    /// Bytes in them, without the headers of UDP and IP, which are 28 bytes a packet.
    pub bytes: u64,
    /// Datagrams that were lost.
    pub lost: u64,
}

impl Relay {
    /// Before a server, losing a share.
    pub fn new(server: SocketAddr, loss: f64, seed: u64) -> io::Result<Self> {
        let open = || {
            let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
            socket.set_nonblocking(true)?;
            io::Result::Ok(socket)
        };
        Ok(Self {
            front: open()?,
            back: open()?,
            server,
            client: None,
            loss,
            random: Random(seed),
            down: Passed::default(),
            up: Passed::default(),
        })
    }

    /// What the client takes for the server.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.front.local_addr()
    }

    /// Passes on what is there.
    pub fn pass(&mut self) {
        let mut buffer = [0; 2048];
        while let Ok((length, from)) = self.front.recv_from(&mut buffer) {
            self.client = Some(from);
            if self.up.keeps(length, self.loss, &mut self.random) {
                let _ = self.back.send_to(&buffer[..length], self.server);
            }
        }
        while let Ok((length, _)) = self.back.recv_from(&mut buffer) {
            let keeps = self.down.keeps(length, self.loss, &mut self.random);
            if let (true, Some(client)) = (keeps, self.client) {
                let _ = self.front.send_to(&buffer[..length], client);
            }
        }
    }
}

impl Passed {
    /// Counts one, and says whether it is passed on.
    fn keeps(&mut self, length: usize, loss: f64, random: &mut Random) -> bool {
        self.packets += 1;
        self.bytes += length as u64;
        let is_lost = random.share() < loss;
        self.lost += u64::from(is_lost);
        !is_lost
    }
}
