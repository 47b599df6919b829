//! Springs on bodies that contacts and joints hold: rolling wheels, feet, nets, heaps, walls, bridges and ragdolls.
//!
//! Each scene occurs in games. Its energy is the sum of kinetic, gravitational and spring energy, all computed from geometry.

mod actuator;
mod beside;
mod between_planks;
mod bounce;
mod brakes;
mod bridge;
mod burdens;
mod ccd;
mod changes;
mod cloth;
mod companions;
mod crossing;
mod dampers;
mod drive;
mod far;
mod feet;
mod fitted_cars;
mod heap;
mod hierarchy;
mod hinge;
mod led;
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
mod several_steps;
mod shock;
mod sizes;
mod stand;
mod surfaces;
mod torsion;
mod wall;
mod wheel_shapes;
mod winch;
