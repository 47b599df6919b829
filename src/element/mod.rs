//! Components that a user spawns: plain, reflected data.

mod anchors;
mod axis;
mod breakable;
mod damper;
mod damping_law;
mod end_names;
mod endless;
mod fault;
mod hold_pose;
mod law;
mod limits;
mod spring;
mod spring_damper;
mod table;
mod torsion;
mod tuning;
mod world_anchors;

pub use anchors::Anchors;
pub use axis::SpringAxis;
pub use breakable::{Breakable, SpringBroke, WhenBroken};
pub use damper::Damper;
pub use damping_law::DampingLaw;
pub(crate) use end_names::AwaitsEnds;
pub use end_names::EndNames;
pub use fault::SpringFault;
pub use hold_pose::{HeldEnd, HoldPose};
pub(crate) use law::Theirs;
pub use law::{CustomDampingLaw, CustomSpringLaw, ForceLaw, Polynomial, SpringLaw};
pub use limits::{MaxForce, Preload, SpringAction, SpringTravel};
pub use spring::Spring;
pub use spring_damper::SpringDamper;
pub use table::ForceTable;
pub use torsion::{TorsionDamper, TorsionSpring, TorsionSpringDamper};
pub use tuning::{SpringTuning, wire_stiffness};
pub use world_anchors::WorldAnchors;
