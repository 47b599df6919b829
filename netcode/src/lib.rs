//! Networked springs: rollback with GGRS, and an authoritative server with Replicon. For maintainers, and to copy from.
//! The guide's page `docs/guide/netcode.md` explains it.

pub mod game;
pub mod lossy;
pub mod peers;
#[cfg(feature = "server")]
pub mod relay;
pub mod rollback;
#[cfg(feature = "server")]
pub mod server;

/// Tests of the code on the guide's page.
#[cfg(all(doctest, feature = "server"))]
#[doc = include_str!("../../docs/guide/netcode.md")]
pub mod guide {}
