//! Is the future the same after going back to an earlier tick, bit for bit?

mod again;
mod alike;
mod apart;
mod changed;
mod film;
mod held;
mod scenes;
mod wrong;
