//! The scenes, one a file.

mod duffing;
mod dumbbell;
mod large;
mod networks;
pub mod oscillator;
mod pendulum;
mod praised;
mod quarter_car;
mod star;

use crate::problem::Problem;

/// A scene of which the work–precision picture is drawn.
pub struct Scene {
    pub name: &'static str,
    pub title: &'static str,
    /// A sentence on what moves, and on where the truth comes from.
    pub note: &'static str,
    pub make: fn() -> Problem,
    /// So large that a few settings at two rates must do.
    pub few: bool,
}

pub const SCENES: [Scene; 16] = [
    oscillator::SCENE,
    pendulum::SOFT,
    pendulum::DAMPED,
    pendulum::STIFF,
    dumbbell::SCENE,
    networks::CHAIN,
    networks::LATTICE,
    star::SCENE,
    quarter_car::SCENE,
    duffing::SCENE,
    praised::SPRING_RATIO,
    praised::HEAVY_ROPE,
    praised::CLOTH,
    large::CLOTH,
    large::BRIDGE,
    large::TOWER,
];

/// Standard gravity as the references have it, m/s².
pub const GRAVITY: f32 = 9.81;
