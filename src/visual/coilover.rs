use super::coil::Coil;
use super::telescope::Telescope;
use crate::element::{Anchors, SpringDamper};
use bevy::prelude::*;

/// A coil spring around a telescoping damper between two ends: physics and looks, as one bundle.
///
/// It consists of a [`SpringDamper`], [`Anchors`], a [`Coil`] and a [`Telescope`]. Set their values here, and do not
/// add these components to the same bundle: Bevy panics at two components of one type. Other companions, such as
/// [`HoldPose`](crate::HoldPose) or [`SpringTravel`](crate::SpringTravel), go beside it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_coilover::prelude::*;
/// # fn setup(commands: &mut Commands, chassis: Entity, wheel: Entity) {
/// commands.spawn((
///     Coilover::new(chassis, wheel)
///         .with_stiffness(30e3)
///         .with_damping(2e3)
///         .with_anchors(Vec3::new(0.7, 0.2, 1.2), Vec3::ZERO)
///         .with_coil(Coil::new(0.08, 0.01, 7.0)),
///     HoldPose::of_a().with_share(0.25),
/// ));
/// # }
/// ```
#[derive(Bundle, Clone, Copy, Debug, PartialEq)]
pub struct Coilover {
    /// The spring and damper that act.
    pub element: SpringDamper,
    /// Points at which it is attached, in the local frames of the ends.
    pub anchors: Anchors,
    /// How the spring looks.
    pub coil: Coil,
    /// How the damper looks.
    pub telescope: Telescope,
}

impl Coilover {
    /// From end A to end B, with 1000 N/m and 60 N s/m. The rest length is the length in the first step, the anchors
    /// are the origins of the ends, and the default looks have the size of a car's coilover.
    pub fn new(body_a: Entity, body_b: Entity) -> Self {
        Self {
            element: SpringDamper::new(body_a, body_b)
                .with_stiffness(1000.0)
                .with_damping(60.0),
            anchors: Anchors::default(),
            coil: Coil::default(),
            telescope: Telescope::default(),
        }
    }

    /// Sets the stiffness, N/m.
    pub const fn with_stiffness(mut self, stiffness: f32) -> Self {
        self.element.stiffness = stiffness;
        self
    }

    /// Sets the damping, N s/m.
    pub const fn with_damping(mut self, damping: f32) -> Self {
        self.element.damping = damping;
        self
    }

    /// Sets the length without force, m.
    pub const fn with_rest_length(mut self, rest_length: f32) -> Self {
        self.element.rest_length = Some(rest_length);
        self
    }

    /// Sets the points at which it is attached, in the local frames of end A and end B, m.
    pub const fn with_anchors(mut self, a: Vec3, b: Vec3) -> Self {
        self.anchors = Anchors::new(a, b);
        self
    }

    /// Sets how the spring looks.
    pub const fn with_coil(mut self, coil: Coil) -> Self {
        self.coil = coil;
        self
    }

    /// Sets how the damper looks.
    pub const fn with_telescope(mut self, telescope: Telescope) -> Self {
        self.telescope = telescope;
        self
    }

    /// Replaces both looks by ones that scale with the length between the ends: [`Coil::fitted()`] and
    /// [`Telescope::fitted()`].
    pub fn fitted(mut self) -> Self {
        self.coil = Coil::fitted();
        self.telescope = Telescope::fitted();
        self
    }
}

/// Short form of [`Coilover::new`].
pub fn coilover(body_a: Entity, body_b: Entity) -> Coilover {
    Coilover::new(body_a, body_b)
}
