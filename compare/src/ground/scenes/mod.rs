//! The scenes with contacts and joints, and the figures measured in each.

mod bridge;
mod cloth;
mod foot;
mod ragdoll;
mod wall;
mod wheel;

use super::figures::Run;
use super::stage::Stage;

/// A scene with contacts or joints.
pub struct Scene {
    pub name: &'static str,
    pub title: &'static str,
    /// Description for the report: what happens, and what the figures mean.
    pub note: &'static str,
    /// Speeds to run the scene with, m/s. A single 0 if the scene varies no speed.
    pub speeds: &'static [f32],
    /// Names and units of its one or two figures.
    pub heads: &'static [Head],
    pub make: fn(f32) -> Stage,
    pub figures: fn(&mut Run) -> Vec<f64>,
    /// Whether a quick run includes the scene.
    pub quick: bool,
}

/// A figure's name and unit.
pub struct Head {
    pub name: &'static str,
    pub unit: Unit,
}

#[derive(Clone, Copy)]
pub enum Unit {
    Ratio,
    Joule,
    Metre,
    MetrePerSecond,
    Count,
}

pub const SCENES: [Scene; 6] = [
    wheel::SCENE,
    foot::SCENE,
    ragdoll::SCENE,
    bridge::SCENE,
    cloth::SCENE,
    wall::SCENE,
];

/// Greatest energy during a run, divided by the initial energy. Shared by several scenes.
const GREATEST: Head = Head {
    name: "greatest energy over first",
    unit: Unit::Ratio,
};
