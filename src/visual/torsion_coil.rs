use super::helix::{Handedness, SIZES, is_size};
use super::twist::Twist;
use crate::input::check::MOST;
use bevy::prelude::*;

/// Draws a spiral spring, as in a clock, for the [`TorsionSpring`](crate::TorsionSpring),
/// [`TorsionDamper`](crate::TorsionDamper) or [`TorsionSpringDamper`](crate::TorsionSpringDamper) on the same entity.
///
/// The strip lies in the plane perpendicular to the element's axis. Its inner end is fixed to an arbor, a pin on body
/// A. Its outer end is fixed to body B and moves around with it. So the spiral has its [`turns`](Self::turns) at the
/// rest angle, and more or fewer of them when it is twisted.
///
/// If a size is not from 1e-12 to 1e12, if there are more than 100 turns, or if the turns do not fit between the two
/// radii, a warning is logged and the spiral is not drawn until that is corrected. The element acts all the same.
///
/// While an end does not exist or is disabled, the spiral stays where it was: despawn the element with its end.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn setup(commands: &mut Commands, frame: Entity, door: Entity) {
/// commands.spawn((
///     TorsionSpringDamper::new(frame, door, Vec3::Y).with_stiffness(20.0),
///     // On the hinge, above the door.
///     TorsionCoil::default().with_center(Vec3::new(-0.45, 1.05, 0.0)),
/// ));
/// # }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
#[require(Transform, Visibility, Twist)]
pub struct TorsionCoil {
    /// Middle of the spiral, a point on the axis of the hinge, m. It is in the frame of the entity that is end A, as an
    /// anchor is.
    pub center: Vec3,
    /// Radius from the axis to the outer end, m; a share if the spiral is [fitted](Self::fitted).
    pub radius: f32,
    /// Radius from the axis to the inner end, which is the arbor's radius, m; a share if the spiral is
    /// [fitted](Self::fitted).
    pub arbor_radius: f32,
    /// Size of the strip along the axis, m; a share if the spiral is [fitted](Self::fitted).
    pub width: f32,
    /// Size of the strip across the axis, m; a share if the spiral is [fitted](Self::fitted).
    pub thickness: f32,
    /// Number of turns of the strip at the rest angle.
    pub turns: f32,
    /// `Right`: a positive angle winds it up. `Left`: a positive angle unwinds it.
    pub handedness: Handedness,
    /// Colour of the strip.
    pub color: Color,
    /// Whether the sizes are shares of the size of what the spring turns, and not metres. The size of what it turns is
    /// the distance from the centre to body B, or to the farthest point of the bounding spheres of body B's colliders, when
    /// first drawn. It is 0.5 m if that is less than 1 mm, as of a body at the centre without colliders.
    pub fitted: bool,
}

impl Default for TorsionCoil {
    /// A spiral that fits its scene: a quarter as large as what it turns. See [`fitted`](Self::fitted).
    fn default() -> Self {
        Self {
            center: Vec3::ZERO,
            radius: 0.25,
            arbor_radius: 0.05,
            width: 0.05,
            thickness: 0.012,
            turns: 4.0,
            handedness: Handedness::default(),
            color: Color::srgb(0.22, 0.32, 0.55),
            fitted: true,
        }
    }
}

/// Most turns of a spiral. With more, the mesh gets too large to draw.
const MOST_TURNS: f32 = 100.0;

impl TorsionCoil {
    /// Returns a spiral of this radius (m) and number of turns. The sizes of arbor and strip follow from the radius;
    /// set them yourself if that does not suit.
    pub fn new(radius: f32, turns: f32) -> Self {
        let shares = Self::default();
        let scale = radius / shares.radius;
        Self {
            turns,
            fitted: false,
            ..shares.times(scale)
        }
    }

    /// Sets the middle of the spiral, in the frame of the entity that is end A, m.
    pub const fn with_center(mut self, center: Vec3) -> Self {
        self.center = center;
        self
    }

    /// Sets the number of turns at the rest angle.
    pub const fn with_turns(mut self, turns: f32) -> Self {
        self.turns = turns;
        self
    }

    /// Sets the direction in which the strip is wound.
    pub const fn with_handedness(mut self, handedness: Handedness) -> Self {
        self.handedness = handedness;
        self
    }

    /// Sets the colour of the strip.
    pub const fn with_color(mut self, color: Color) -> Self {
        self.color = color;
        self
    }

    fn times(self, scale: f32) -> Self {
        Self {
            radius: scale * self.radius,
            arbor_radius: scale * self.arbor_radius,
            width: scale * self.width,
            thickness: scale * self.thickness,
            ..self
        }
    }

    /// Returns the spiral in metres, where what it turns has this size (m).
    pub(super) fn at(self, size: f32) -> Self {
        if !self.fitted {
            return self;
        }
        Self {
            fitted: false,
            ..self.times(super::coil::rounded(size))
        }
    }

    /// Checks whether it can be drawn. The error says which field is wrong, and how.
    pub(super) fn check(&self) -> Result<(), String> {
        for (field, value) in [
            ("radius", self.radius),
            ("arbor_radius", self.arbor_radius),
            ("width", self.width),
            ("thickness", self.thickness),
            ("turns", self.turns),
        ] {
            if !is_size(value) {
                return Err(format!("{field} is {value}, and must be {SIZES}"));
            }
        }
        if !self.center.abs().cmple(Vec3::splat(MOST)).all() {
            return Err(format!(
                "center is {}, and must be at most {MOST} m away",
                self.center
            ));
        }
        if self.turns > MOST_TURNS {
            return Err(format!(
                "turns is {}, and must be at most {MOST_TURNS}",
                self.turns
            ));
        }
        let room = self.radius - self.arbor_radius;
        if self.turns * self.thickness >= room {
            return Err(format!(
                "{} turns of thickness {} m do not go between arbor_radius {} m and radius {} m",
                self.turns, self.thickness, self.arbor_radius, self.radius
            ));
        }
        Ok(())
    }
}
