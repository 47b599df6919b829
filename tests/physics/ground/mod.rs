//! Springs on what contacts and joints hold: wheels that roll, feet, nets, heaps, walls, bridges and ragdolls.
//!
//! Each scene is one that a game has. Energy is kinetic, of gravity, and stored in springs, all from geometry.

mod bridge;
mod feet;
mod heap;
mod nets;
mod rolling;
mod stand;
mod torsion;
mod wall;
