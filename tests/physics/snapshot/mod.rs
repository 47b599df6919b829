//! After going back to an earlier tick, the future is the same bit for bit.

mod again;
mod alike;
mod apart;
mod changed;
mod film;
mod held;
mod paused;
mod scenes;
mod twins;
mod wrong;
