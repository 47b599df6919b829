//! The scenes with known motion.

mod duffing;
pub mod dumbbell;
mod large;
mod networks;
pub mod oscillator;
pub mod pendulum;
mod praised;
mod quarter_car;
mod star;

use crate::problem::Problem;

/// A scene with a work–precision chart.
pub struct Scene {
    pub name: &'static str,
    pub title: &'static str,
    /// Description for the report: what moves, and the source of the true motion.
    pub note: &'static str,
    pub make: fn() -> Problem,
    /// Whether the scene is so large that it is run with few settings at two tick rates.
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

/// Gravitational acceleration of the reference solutions, m/s².
pub const GRAVITY: f32 = 9.81;
