use super::coil::rounded;
use super::place::Placement;
use bevy::prelude::*;

/// Draws a telescoping damper between the ends of the element on the same entity: a tube fixed to end A
/// and a rod fixed to end B that slides into it.
///
/// Both keep their lengths as long as the ends stay within the stroke. Pulled or pushed beyond it, the rod
/// or the tube is drawn longer or shorter than it is, rather than apart or through the other end.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Placement)]
pub struct Telescope {
    /// Of the tube, m.
    pub tube_radius: f32,
    /// Of the rod, m; less than the tube's.
    pub rod_radius: f32,
    /// From end A to the tube's mouth, m; `None` is what the stroke allows.
    pub tube_length: Option<f32>,
    /// From end B to the rod's tip in the tube, m; `None` is what the stroke needs.
    pub rod_length: Option<f32>,
    /// From shortest to longest, half of it either side of the length when first drawn, m; `None` is half
    /// of that length.
    pub stroke: Option<f32>,
    /// Draws an eye at each end.
    pub eyes: bool,
    /// Draws a rubber on the rod that the tube's mouth runs into.
    pub bump_rubber: bool,
    /// Paint of the tube.
    pub color: Color,
    /// Its radii and lengths are shares of the length between the ends when first drawn, not metres; see
    /// [`Telescope::fitted()`].
    pub fitted: bool,
}

impl Default for Telescope {
    /// Of the size of a car's damper, whatever the scene; see [`Telescope::fitted()`].
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
    /// A telescope of these radii, m.
    pub fn new(tube_radius: f32, rod_radius: f32) -> Self {
        Self {
            tube_radius,
            rod_radius,
            ..default()
        }
    }

    /// A telescope that fits its scene: its tube's radius is 4.8 % of the length between the ends when first drawn, its
    /// rod's 2 %. Lengths that are set count in the same measure: `with_stroke(0.5)` is half of that length.
    pub fn fitted() -> Self {
        Self {
            tube_radius: 0.048,
            rod_radius: 0.02,
            fitted: true,
            ..default()
        }
    }

    /// In metres, where the ends are `first` apart when first drawn.
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

    /// Sets the stroke from shortest to longest, m.
    pub const fn with_stroke(mut self, stroke: f32) -> Self {
        self.stroke = Some(stroke);
        self
    }

    /// Draws eyes and a bump rubber too.
    pub const fn with_fittings(mut self) -> Self {
        self.eyes = true;
        self.bump_rubber = true;
        self
    }

    /// Sets the paint of the tube.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    /// Whether it can be drawn, and if not, which field is wrong and how.
    pub(super) fn check(&self) -> Result<(), String> {
        for (field, value) in [
            ("tube_radius", Some(self.tube_radius)),
            ("rod_radius", Some(self.rod_radius)),
            ("tube_length", self.tube_length),
            ("rod_length", self.rod_length),
            ("stroke", self.stroke),
        ] {
            if let Some(value) = value
                && (!value.is_finite() || value <= 0.0)
            {
                return Err(format!(
                    "{field} is {value}, and must be finite and positive"
                ));
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
