//! Springs on what contacts and joints hold: wheels that roll, feet, nets, heaps, walls, bridges and ragdolls.
//!
//! Each scene is one that a game has. Energy is kinetic, of gravity, and stored in springs, all from geometry.

mod actuator;
mod beside;
mod bounce;
mod bridge;
mod ccd;
mod changes;
mod cloth;
mod companions;
mod drive;
mod far;
mod feet;
mod heap;
mod hierarchy;
mod hinge;
mod links;
mod mixed;
mod motorcycle;
mod nets;
mod play;
mod ragdoll;
mod rates;
mod rolling;
mod ropes;
mod scenes;
mod shock;
mod sizes;
mod stand;
mod torsion;
mod wall;
