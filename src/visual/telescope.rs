use super::place::Placement;
use bevy::prelude::*;

/// Draws a telescoping damper between the ends of the element on the same entity: a tube fixed to end A
/// and a rod fixed to end B that slides into it.
///
/// Both keep their lengths as long as the ends stay within the stroke. Pulled or pushed beyond it, the rod
/// or the tube is drawn longer or shorter than it is, rather than apart or through the other end.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
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
}

impl Default for Telescope {
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
