//! A relay between a client and the server that counts datagrams and loses some of them.

use crate::lossy::Random;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};

/// The relay of one client.
pub struct Relay {
    /// Socket to which the client sends.
    front: UdpSocket,
    /// Socket that the server takes for the client.
    back: UdpSocket,
    server: SocketAddr,
    client: Option<SocketAddr>,
    loss: f64,
    random: Random,
    /// Datagrams to the client, lost or not.
    pub down: Passed,
    /// Datagrams to the server, lost or not.
    pub up: Passed,
}

/// Datagrams in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passed {
    /// Number of datagrams.
    pub packets: u64,
    /// Bytes in the datagrams, without the headers of UDP and IP, which are 28 bytes a packet.
    pub bytes: u64,
    /// Number of lost datagrams.
    pub lost: u64,
}

impl Relay {
    /// Opens a relay to a server that loses a share `loss` of all datagrams.
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

    /// Address that the client takes for the server.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.front.local_addr()
    }

    /// Forwards all waiting datagrams in both directions.
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
    /// Counts a datagram. Returns whether it is forwarded.
    fn keeps(&mut self, length: usize, loss: f64, random: &mut Random) -> bool {
        self.packets += 1;
        self.bytes += length as u64;
        let is_lost = random.share() < loss;
        self.lost += u64::from(is_lost);
        !is_lost
    }
}
