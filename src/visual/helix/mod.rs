//! A coil of round wire as a Bevy primitive.

mod mesh;
#[cfg(test)]
mod tests;
mod wire;

pub use mesh::HelixMeshBuilder;

use crate::compat::Primitive3d;
use bevy::prelude::*;
use std::f32::consts::PI;
use std::fmt;
use wire::Wire;

/// How the wire of a coil ends.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum HelixEnds {
    /// Constant pitch up to the cut.
    Open,
    /// The last turn at each end lies wire on wire. It keeps that pitch however far the coil is stretched.
    Closed,
    /// The last turn at each end lies wire on wire, and is ground flat as a seat.
    #[default]
    ClosedGround,
}

impl HelixEnds {
    /// Number of turns that do not act, both ends together.
    pub const fn dead_turns(self) -> f32 {
        match self {
            Self::Open => 0.0,
            Self::Closed | Self::ClosedGround => 2.0,
        }
    }
}

/// Direction in which a coil is wound.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub enum Handedness {
    /// Right-handed, like a common screw.
    #[default]
    Right,
    /// Left-handed.
    Left,
}

impl Handedness {
    /// 1 if the wire goes along its axis by the right-hand rule, else −1.
    pub(super) fn sign(self) -> f32 {
        match self {
            Self::Right => 1.0,
            Self::Left => -1.0,
        }
    }
}

/// A coil of round wire about the Y axis. It stands on the origin and is `length` high, with the thickness of the wire.
///
/// The cross-section of the wire is a circle perpendicular to the wire. The ends of the wire are capped.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone)]
pub struct Helix {
    /// Radius from the axis to the middle of the wire, m.
    pub radius: f32,
    /// Radius of the wire, m.
    pub wire_radius: f32,
    /// Number of turns from end to end, with the dead ones.
    pub turns: f32,
    /// Height, m.
    pub length: f32,
    /// How the wire ends.
    pub ends: HelixEnds,
    /// Direction in which the wire is wound.
    pub handedness: Handedness,
}

impl Primitive3d for Helix {}

impl Default for Helix {
    fn default() -> Self {
        Self {
            radius: 0.5,
            wire_radius: 0.06,
            turns: 6.0,
            length: 1.5,
            ends: HelixEnds::default(),
            handedness: Handedness::default(),
        }
    }
}

/// Why a coil cannot be wound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HelixError {
    /// A field is not above zero, or too small or too large to compute with: its name and value.
    NotPositive(&'static str, f32),
    /// The wire would cross the axis of the coil: radius of the wire and radius of the coil, m.
    WireTooThick(f32, f32),
    /// There are more than 1000 turns: their number.
    TooManyTurns(f32),
}

/// Sizes that can be drawn, m, and numbers of turns. The products of two of them, and their quotients, fit into f32.
pub(super) fn is_size(x: f32) -> bool {
    (1e-12..=1e12).contains(&x)
}

/// What [`is_size`] asks for, for messages.
pub(super) const SIZES: &str = "finite and positive, from 1e-12 to 1e12";

/// Most turns of a coil. With more, the mesh gets too large to draw.
const MOST_TURNS: f32 = 1000.0;

impl fmt::Display for HelixError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPositive(field, value) => {
                write!(f, "{field} is {value}, and must be {SIZES}")
            }
            Self::WireTooThick(wire, radius) => write!(
                f,
                "wire_radius is {wire} m, and must be less than the coil's radius of {radius} m"
            ),
            Self::TooManyTurns(turns) => {
                write!(f, "turns is {turns}, and must be at most {MOST_TURNS}")
            }
        }
    }
}

impl std::error::Error for HelixError {}

impl Helix {
    /// Returns a right-handed coil of this radius (m), wire radius (m), number of turns and length (m), with closed and
    /// ground ends.
    pub fn new(radius: f32, wire_radius: f32, turns: f32, length: f32) -> Self {
        Self {
            radius,
            wire_radius,
            turns,
            length,
            ..default()
        }
    }

    /// Sets how the wire ends.
    pub const fn with_ends(mut self, ends: HelixEnds) -> Self {
        self.ends = ends;
        self
    }

    /// Sets the direction in which the wire is wound.
    pub const fn with_handedness(mut self, handedness: Handedness) -> Self {
        self.handedness = handedness;
        self
    }

    /// Checks whether such a wire can be wound. Returns an error if a size or the number of turns is not from 1e-12 to
    /// 1e12, if the wire would cross the axis, or if there are more than 1000 turns.
    pub fn check(&self) -> Result<(), HelixError> {
        for (field, value) in [
            ("radius", self.radius),
            ("wire_radius", self.wire_radius),
            ("turns", self.turns),
            ("length", self.length),
        ] {
            if !is_size(value) {
                return Err(HelixError::NotPositive(field, value));
            }
        }
        if self.wire_radius >= self.radius {
            return Err(HelixError::WireTooThick(self.wire_radius, self.radius));
        }
        if self.turns > MOST_TURNS {
            return Err(HelixError::TooManyTurns(self.turns));
        }
        Ok(())
    }

    /// Length at which all turns touch, m. In a shorter coil, wire would pass through wire.
    pub fn solid_length(&self) -> f32 {
        let thickness = 2.0 * self.wire_radius;
        match self.ends {
            HelixEnds::ClosedGround => self.turns * thickness,
            HelixEnds::Open | HelixEnds::Closed => (self.turns + 1.0) * thickness,
        }
    }

    /// Length of the wire along its middle, m.
    pub fn wire_length(&self) -> f32 {
        Wire::new(self).length()
    }

    /// Volume of the wire, m³, with what is ground off ground ends.
    pub fn wire_volume(&self) -> f32 {
        PI * self.wire_radius * self.wire_radius * self.wire_length()
    }
}

impl Meshable for Helix {
    type Output = HelixMeshBuilder;

    fn mesh(&self) -> Self::Output {
        HelixMeshBuilder::new(*self)
    }
}

impl From<Helix> for Mesh {
    fn from(helix: Helix) -> Self {
        helix.mesh().build()
    }
}
