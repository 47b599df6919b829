//! What a user spawns: plain, reflected data.

mod anchors;
mod damper;
mod fault;
mod spring;
mod spring_damper;

pub use anchors::Anchors;
pub use damper::Damper;
pub use fault::SpringFault;
pub use spring::Spring;
pub use spring_damper::SpringDamper;
