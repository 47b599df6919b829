use super::helix::{Handedness, Helix, HelixEnds, HelixError};
use super::place::Placement;
use bevy::prelude::*;

/// Draws a coil spring between the ends of the [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper) on the same entity. Its wire stays round at any length.
///
/// Beside a [`Telescope`](crate::Telescope) it sits around it, between spring seats: a coilover.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Coil {
    /// From the axis to the centre of the wire, m, or a share if it is [fitted](Self::fitted()).
    pub radius: f32,
    /// Half the thickness of the wire, m, or a share.
    pub wire_radius: f32,
    /// Turns of the wire from end to end, the flat ones at the ends included.
    pub turns: f32,
    /// How the wire ends.
    pub ends: HelixEnds,
    /// Which way it is wound.
    pub handedness: Handedness,
    /// Paint.
    pub color: Color,
    /// Its radii are shares of the length between the ends when first drawn, not metres; see [`Coil::fitted()`].
    pub fitted: bool,
}

impl Default for Coil {
    /// Of the size of a car's coilover, whatever the scene; see [`Coil::fitted()`].
    fn default() -> Self {
        Self {
            radius: 0.13,
            wire_radius: 0.016,
            turns: 8.0,
            ends: HelixEnds::default(),
            handedness: Handedness::default(),
            color: Color::srgb(0.80, 0.09, 0.07),
            fitted: false,
        }
    }
}

/// What [`Coil::from_wire`] says of a spring of round wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WoundCoil {
    /// How it looks.
    pub coil: Coil,
    /// Of the active turns, N/m.
    pub stiffness: f32,
    /// Length at which all turns touch, m.
    pub solid_length: f32,
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

    /// A coil that fits its scene: its radius is a tenth of the length between the ends when first drawn, and its wire
    /// 2.4 % of that length thick.
    ///
    /// The length is taken once, to within 5 %, so that springs of nearly one length share a mesh. A [`Telescope`]
    /// beside it should be [fitted](crate::Telescope::fitted()) too.
    ///
    /// [`Telescope`]: crate::Telescope
    pub fn fitted() -> Self {
        Self {
            radius: 0.1,
            wire_radius: 0.012,
            fitted: true,
            ..default()
        }
    }

    /// In metres, where the ends are `first` apart when first drawn.
    pub(super) fn at(self, first: f32) -> Self {
        let scale = if self.fitted { rounded(first) } else { 1.0 };
        Self {
            radius: scale * self.radius,
            wire_radius: scale * self.wire_radius,
            fitted: false,
            ..self
        }
    }

    /// A compression spring of real wire, its ends closed and ground: diameters of the wire and of the
    /// coil, at the middle of the wire (m), the turns that act, and the wire's shear modulus (Pa; steel
    /// has about 79e9). Its stiffness is G d⁴ / (8 D³ n).
    ///
    /// ```
    /// # use bevy_coilover::Coil;
    /// let wound = Coil::from_wire(0.012, 0.1, 6.0, 79.3e9)?;
    /// assert!((wound.stiffness - 34_257.6).abs() < 1.0);
    /// assert!((wound.solid_length - 8.0 * 0.012).abs() < 1e-6);
    /// # Ok::<(), bevy_coilover::HelixError>(())
    /// ```
    pub fn from_wire(
        wire_diameter: f32,
        coil_diameter: f32,
        active_turns: f32,
        shear_modulus: f32,
    ) -> Result<WoundCoil, HelixError> {
        for (field, value) in [
            ("active_turns", active_turns),
            ("shear_modulus", shear_modulus),
        ] {
            if !value.is_finite() || value <= 0.0 {
                return Err(HelixError::NotPositive(field, value));
            }
        }
        let turns = active_turns + HelixEnds::ClosedGround.dead_turns();
        let coil = Self::new(0.5 * coil_diameter, 0.5 * wire_diameter, turns);
        coil.helix(1.0).check()?;
        Ok(WoundCoil {
            coil,
            stiffness: crate::wire_stiffness(
                wire_diameter,
                coil_diameter,
                active_turns,
                shear_modulus,
            ),
            solid_length: coil.solid_length(),
        })
    }

    /// Sets the paint.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    /// Sets how the wire ends.
    pub const fn with_ends(mut self, ends: HelixEnds) -> Self {
        self.ends = ends;
        self
    }

    /// Sets which way it is wound.
    pub const fn with_handedness(mut self, handedness: Handedness) -> Self {
        self.handedness = handedness;
        self
    }

    /// Its shape at this length, m; of a fitted one, both are in shares.
    pub const fn helix(&self, length: f32) -> Helix {
        Helix {
            radius: self.radius,
            wire_radius: self.wire_radius,
            turns: self.turns,
            length,
            ends: self.ends,
            handedness: self.handedness,
        }
    }

    /// The length at which all turns touch, m; of a fitted one, as a share.
    pub fn solid_length(&self) -> f32 {
        self.helix(1.0).solid_length()
    }
}

/// A length to within 5 %: a power of 1.1.
pub(super) fn rounded(length: f32) -> f32 {
    let step = 1.1_f32.ln();
    ((length.ln() / step).round() * step).exp()
}
