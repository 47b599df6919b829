use super::helix::{Handedness, Helix, HelixEnds, HelixError};
use super::place::Placement;
use bevy::prelude::*;

/// Draws a coil spring between the ends of the [`Spring`](crate::Spring), [`Damper`](crate::Damper) or
/// [`SpringDamper`](crate::SpringDamper) on the same entity. Its wire stays round at any length.
///
/// Beside a [`Telescope`](crate::Telescope) the coil is wound around the telescope, between spring seats: a coilover.
///
/// If [`Helix::check`] finds a fault in its sizes, a warning is logged and the coil is not drawn until
/// that is corrected. The element acts all the same.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Coil {
    /// Radius from the axis to the centre of the wire, m; a share of the length if the coil is
    /// [fitted](Self::fitted()).
    pub radius: f32,
    /// Radius of the wire, m; a share of the length if the coil is [fitted](Self::fitted()).
    pub wire_radius: f32,
    /// Number of turns from end to end, with the closed ones at the ends.
    pub turns: f32,
    /// How the wire ends.
    pub ends: HelixEnds,
    /// Direction in which the wire is wound.
    pub handedness: Handedness,
    /// Colour of the coil.
    pub color: Color,
    /// Whether the radii are shares of the length between the ends when first drawn, and not metres; see
    /// [`Coil::fitted()`].
    pub fitted: bool,
}

impl Default for Coil {
    /// A coil of the size of a car's coilover, whatever the size of the scene; [`Coil::fitted()`] is one that fits.
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

/// Result of [`Coil::from_wire`]: a spring of round wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WoundCoil {
    /// The coil to draw.
    pub coil: Coil,
    /// Stiffness of the active turns, N/m.
    pub stiffness: f32,
    /// Length at which all turns touch, m.
    pub solid_length: f32,
}

impl Coil {
    /// Returns a coil of this radius (from the axis to the centre of the wire, m), wire radius (m) and number of turns.
    pub fn new(radius: f32, wire_radius: f32, turns: f32) -> Self {
        Self {
            radius,
            wire_radius,
            turns,
            ..default()
        }
    }

    /// Returns a coil that fits its scene. Its radius is a tenth of the length between the ends when first drawn, and
    /// its wire is 2.4 % of that length thick.
    ///
    /// The length is measured once and rounded to within 5 %, so that springs of nearly the same length share a mesh. A
    /// [`Telescope`] beside it should be [fitted](crate::Telescope::fitted()) too.
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

    /// Returns the coil in metres, for ends that are `first` metres apart when first drawn.
    pub(super) fn at(self, first: f32) -> Self {
        let scale = if self.fitted { rounded(first) } else { 1.0 };
        Self {
            radius: scale * self.radius,
            wire_radius: scale * self.wire_radius,
            fitted: false,
            ..self
        }
    }

    /// Returns a compression spring of real wire with closed and ground ends. `wire_diameter` and `coil_diameter` (at
    /// the middle of the wire) are in m. `active_turns` is the number of turns that act. `shear_modulus` is that of the
    /// wire, Pa (steel: about 79e9). The stiffness is G d⁴ / (8 D³ n), see [`wire_stiffness`](crate::wire_stiffness).
    ///
    /// Returns an error if an argument is not finite and above zero, if the wire would cross the axis, or if there are
    /// more than 1000 turns with the two closed ones.
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

    /// Sets the colour.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
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

    /// Returns the shape of the coil at a length, m. If the coil is fitted, the length and the shape are in shares.
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

    /// Length at which all turns touch, m; a share if the coil is fitted.
    pub fn solid_length(&self) -> f32 {
        self.helix(1.0).solid_length()
    }
}

/// Rounds a length to a power of 1.1, so to within 5 %.
pub(super) fn rounded(length: f32) -> f32 {
    let step = 1.1_f32.ln();
    ((length.ln() / step).round() * step).exp()
}
