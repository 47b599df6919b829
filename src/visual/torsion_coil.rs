use super::helix::Handedness;
use super::twist::Twist;
use bevy::prelude::*;

/// Draws a spiral spring, as in a clock, for the [`TorsionSpring`](crate::TorsionSpring),
/// [`TorsionDamper`](crate::TorsionDamper) or [`TorsionSpringDamper`](crate::TorsionSpringDamper) on the same entity.
///
/// A strip lies in the plane across the element's axis. Its inner end is fixed to an arbor, a pin on body A; its outer
/// end is fixed to body B and goes around with it. So the spiral has its [`turns`](Self::turns) at the rest angle, and
/// more or fewer as it is twisted.
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
    /// Middle of the spiral, in body A's frame, m: a point of the hinge.
    pub center: Vec3,
    /// From the axis to the outer end, m, or a share if it is [fitted](Self::fitted).
    pub radius: f32,
    /// From the axis to the inner end, which is the arbor's radius, m, or a share.
    pub arbor_radius: f32,
    /// Of the strip, along the axis, m, or a share.
    pub width: f32,
    /// Of the strip, across the axis, m, or a share.
    pub thickness: f32,
    /// Turns of the strip where it has no moment.
    pub turns: f32,
    /// `Right`: a positive angle winds it up. `Left`: a positive angle unwinds it.
    pub handedness: Handedness,
    /// Paint of the strip.
    pub color: Color,
    /// Its sizes are shares of the size of what it turns, not metres. That size is how far body B, or the farthest point
    /// of its collider, is from the centre when first drawn; 0.5 m where both are there and B has no collider.
    pub fitted: bool,
}

impl Default for TorsionCoil {
    /// Fits its scene: a quarter as large as what it turns. See [`fitted`](Self::fitted).
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

/// Beyond this a mesh gets too large to draw.
const MOST_TURNS: f32 = 100.0;

impl TorsionCoil {
    /// A spiral of this radius (m) and so many turns. The arbor and the strip follow from the radius; set them otherwise
    /// where that does not suit.
    pub fn new(radius: f32, turns: f32) -> Self {
        let shares = Self::default();
        let scale = radius / shares.radius;
        Self {
            turns,
            fitted: false,
            ..shares.times(scale)
        }
    }

    /// Sets the middle of the spiral, in body A's frame, m.
    pub const fn with_center(mut self, center: Vec3) -> Self {
        self.center = center;
        self
    }

    /// Sets the turns that it has where it has no moment.
    pub const fn with_turns(mut self, turns: f32) -> Self {
        self.turns = turns;
        self
    }

    /// Sets which way it is wound.
    pub const fn with_handedness(mut self, handedness: Handedness) -> Self {
        self.handedness = handedness;
        self
    }

    /// Sets the paint of the strip.
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

    /// In metres, where what it turns is of this size (m).
    pub(super) fn at(self, size: f32) -> Self {
        if !self.fitted {
            return self;
        }
        Self {
            fitted: false,
            ..self.times(super::coil::rounded(size))
        }
    }

    /// Whether it can be drawn, and if not, which field is wrong and how.
    pub(super) fn check(&self) -> Result<(), String> {
        for (field, value) in [
            ("radius", self.radius),
            ("arbor_radius", self.arbor_radius),
            ("width", self.width),
            ("thickness", self.thickness),
            ("turns", self.turns),
        ] {
            if !value.is_finite() || value <= 0.0 {
                return Err(format!(
                    "{field} is {value}, and must be finite and positive"
                ));
            }
        }
        if !self.center.is_finite() {
            return Err(format!("center is {}, and must be finite", self.center));
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
