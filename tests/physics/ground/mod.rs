//! Springs on what contacts and joints hold: wheels that roll, feet, nets, heaps, walls, bridges and ragdolls.
//!
//! Each scene is one that a game has. Energy is kinetic, of gravity, and stored in springs, all from geometry.

mod bridge;
mod cloth;
mod drive;
mod feet;
mod heap;
mod hinge;
mod nets;
mod ragdoll;
mod rolling;
mod stand;
mod torsion;
mod wall;
