//! After going back to an earlier tick, the future is the same bit for bit.

mod again;
mod alike;
mod apart;
mod changed;
mod film;
#[cfg(feature = "serialize")]
mod forged;
mod held;
mod scenes;
mod wrong;
