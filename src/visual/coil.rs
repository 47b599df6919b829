use super::place::Placement;
use bevy::prelude::*;

/// Draws a coil spring between the ends of the [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper) on the same entity.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Coil {
    /// From the axis to the centre of the wire, m.
    pub radius: f32,
    /// Half the thickness of the wire, m.
    pub wire_radius: f32,
    /// Turns of the wire from end to end, the flat ones at the ends included.
    pub turns: f32,
    /// Paint.
    pub color: Color,
}

impl Default for Coil {
    fn default() -> Self {
        Self {
            radius: 0.13,
            wire_radius: 0.016,
            turns: 8.0,
            color: Color::srgb(0.80, 0.09, 0.07),
        }
    }
}

impl Coil {
    /// A coil of this size, m.
    pub fn new(radius: f32, wire_radius: f32, turns: f32) -> Self {
        Self {
            radius,
            wire_radius,
            turns,
            ..default()
        }
    }

    /// Sets the paint.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    /// Whether a wire can be wound so.
    pub(super) fn is_sound(&self) -> bool {
        let all = [self.radius, self.wire_radius, self.turns];
        all.iter().all(|x| x.is_finite() && *x > 0.0)
            && self.wire_radius < self.radius
            && self.turns <= 1000.0
    }
}
