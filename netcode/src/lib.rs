//! Springs over the net: rollback with GGRS, and a server that rules, with Replicon. For maintainers, and to copy from; the
//! guide's page on it, `docs/guide/netcode.md`, says what it shows.

pub mod game;
pub mod lossy;
pub mod peers;
#[cfg(feature = "server")]
pub mod relay;
pub mod rollback;
#[cfg(feature = "server")]
pub mod server;

/// The code of the guide's page.
#[cfg(all(doctest, feature = "server"))]
#[doc = include_str!("../../docs/guide/netcode.md")]
pub mod guide {}
