use super::coil::rounded;
use super::helix::{SIZES, is_size};
use super::place::Placement;
use bevy::prelude::*;

/// Draws a telescoping damper between the ends of the element on the same entity: a tube fixed to end A, and a rod
/// fixed to end B that slides into the tube.
///
/// Tube and rod keep their lengths while the ends stay within the stroke, as far as two pieces can: with fittings, and where the
/// stroke is more than about half of the length, there is not room for both. Then, and beyond the stroke, the tube or the rod is
/// drawn longer or shorter than it is, so that they do not come apart or pass through the other end.
///
/// While an end does not exist or is disabled, the telescope stays where it was: despawn the element with its end.
///
/// If a size is not from 1e-12 to 1e12, or the rod is not thinner than the tube, a warning is logged and the telescope
/// is not drawn until that is corrected. The element acts all the same.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Telescope {
    /// Radius of the tube, m; a share of the length if the telescope is [fitted](Self::fitted()).
    pub tube_radius: f32,
    /// Radius of the rod, less than that of the tube, m; a share of the length if the telescope is
    /// [fitted](Self::fitted()).
    pub rod_radius: f32,
    /// Distance from end A to the tube's mouth, m; `None` for what the stroke allows.
    pub tube_length: Option<f32>,
    /// Distance from end B to the rod's tip in the tube, m; `None` for what the stroke needs.
    pub rod_length: Option<f32>,
    /// Distance from the shortest to the longest length, m, half of it on either side of the length when first drawn.
    /// `None` for half of that length. At most 1.9 times that length is drawn.
    pub stroke: Option<f32>,
    /// Whether an eye is drawn at each end.
    pub eyes: bool,
    /// Whether a rubber is drawn on the rod, which stops the tube's mouth.
    pub bump_rubber: bool,
    /// Colour of the tube.
    pub color: Color,
    /// Whether radii and lengths are shares of the length between the ends when first drawn, and not metres; see
    /// [`Telescope::fitted()`].
    pub fitted: bool,
}

impl Default for Telescope {
    /// A telescope of the size of a car's damper, whatever the size of the scene; [`Telescope::fitted()`] is one that
    /// fits.
    fn default() -> Self {
        Self {
            tube_radius: 0.062,
            rod_radius: 0.026,
            tube_length: None,
            rod_length: None,
            stroke: None,
            eyes: false,
            bump_rubber: false,
            color: Color::srgb(0.10, 0.11, 0.13),
            fitted: false,
        }
    }
}

impl Telescope {
    /// Returns a telescope with these radii of tube and rod, m.
    pub fn new(tube_radius: f32, rod_radius: f32) -> Self {
        Self {
            tube_radius,
            rod_radius,
            ..default()
        }
    }

    /// Returns a telescope that fits its scene. The radius of its tube is 4.8 %, and that of its rod 2 %, of the length
    /// between the ends when first drawn. Lengths that you set are shares as well: `with_stroke(0.5)` is half of that
    /// length.
    pub fn fitted() -> Self {
        Self {
            tube_radius: 0.048,
            rod_radius: 0.02,
            fitted: true,
            ..default()
        }
    }

    /// Returns the telescope in metres, for ends that are `first` metres apart when first drawn.
    pub(super) fn at(self, first: f32) -> Self {
        let scale = if self.fitted { rounded(first) } else { 1.0 };
        Self {
            tube_radius: scale * self.tube_radius,
            rod_radius: scale * self.rod_radius,
            tube_length: self.tube_length.map(|length| scale * length),
            rod_length: self.rod_length.map(|length| scale * length),
            stroke: self.stroke.map(|length| scale * length),
            fitted: false,
            ..self
        }
    }

    /// Sets the stroke, the distance from the shortest to the longest length, m.
    pub const fn with_stroke(mut self, stroke: f32) -> Self {
        self.stroke = Some(stroke);
        self
    }

    /// Draws eyes and a bump rubber as well.
    pub const fn with_fittings(mut self) -> Self {
        self.eyes = true;
        self.bump_rubber = true;
        self
    }

    /// Sets the colour of the tube.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    /// Checks whether it can be drawn. The error says which field is wrong, and how.
    pub(super) fn check(&self) -> Result<(), String> {
        for (field, value) in [
            ("tube_radius", Some(self.tube_radius)),
            ("rod_radius", Some(self.rod_radius)),
            ("tube_length", self.tube_length),
            ("rod_length", self.rod_length),
            ("stroke", self.stroke),
        ] {
            if let Some(value) = value
                && !is_size(value)
            {
                return Err(format!("{field} is {value}, and must be {SIZES}"));
            }
        }
        if self.rod_radius >= self.tube_radius {
            return Err(format!(
                "rod_radius is {} m, and must be less than the tube's of {} m",
                self.rod_radius, self.tube_radius
            ));
        }
        Ok(())
    }
}
