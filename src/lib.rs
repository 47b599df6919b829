#![doc = include_str!("../README.md")]
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod dynamics;
mod element;
mod engine;
mod plugin;
mod readout;

pub use element::{Anchors, Damper, Spring, SpringDamper, SpringFault};
pub use engine::SpringLoad;
pub use plugin::{CoiloverPlugin, CoiloverSettings, CoiloverSystems};
pub use readout::SpringReadout;

/// Everything that a game needs.
pub mod prelude {
    pub use crate::{
        Anchors, CoiloverPlugin, CoiloverSettings, CoiloverSystems, Damper, Spring, SpringDamper,
        SpringFault, SpringLoad, SpringReadout,
    };
}
