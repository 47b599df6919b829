//! The scenes, one a file, and what is told of each.

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
    /// What happens in it, and what is told of it.
    pub note: &'static str,
    /// What is varied, in m/s; a single 0 where nothing is.
    pub speeds: &'static [f32],
    /// What is told, with its unit: one or two figures.
    pub heads: &'static [Head],
    pub make: fn(f32) -> Stage,
    pub figures: fn(&mut Run) -> Vec<f64>,
    /// So small that a quick look has it too.
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

/// A ratio without a name of its own.
const GREATEST: Head = Head {
    name: "greatest energy over first",
    unit: Unit::Ratio,
};
