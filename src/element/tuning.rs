use bevy::prelude::*;
use std::f32::consts::TAU;

/// Sets stiffness and damping of an element by what one sees of them: a frequency or a sag, and a damping ratio. In the
/// first step in which the element acts, the coefficients are computed from the effective mass of its ends and written
/// into the element's fields, and this component is removed. They stay the same when masses change later, as in a real
/// spring.
///
/// The effective mass includes what joints and contacts hold: the arm of a lamp on a hinge counts with its inertia
/// about the hinge, and a wheel that stands on the ground does not move. The engine knows contacts only after a step.
/// So if a body has colliders, the coefficients are computed once more before the second step. A body that is falling
/// freely then counts as free. For a body that will land later, use [`SpringTuning::coefficients`] with the mass that
/// the spring is to carry.
///
/// On a joint to something that cannot move, and for a torsion element, the sag is that under the load in the present
/// pose, not under the weight of the effective mass: a stiffness of tension/sag. If no weight loads the element there, it
/// gets a [`SpringFault`](crate::SpringFault).
///
/// The numbers are those of the linear laws. A [`SpringLaw`](crate::SpringLaw) or [`DampingLaw`](crate::DampingLaw) beside
/// them may ignore them or give them another meaning.
///
/// A sag also sets the rest length if the element has none, so that the load stays where it was spawned, also beside a
/// [`Preload`](crate::Preload). That is so where the element alone can hold the load: straight above or below it, or on a
/// guide or a hinge. A free load on a slanted element swings. A rest length that you give is kept, and the load sags from
/// there. If both ends move, and neither stands on the ground after the first step, it is not known which end is the load. The
/// rest length is then the length in the first step; put a [`HoldPose`](crate::HoldPose) beside it. For several springs under one
/// load, use [`SpringTuning::coefficients`] with each spring's share of the mass, and
/// [`HoldPose::share`](crate::HoldPose::share).
///
/// On a damper without a spring, with a number that is not valid, where both ends cannot move or coincide, or with a sag
/// that needs a tension which a [`SpringAction`](crate::SpringAction) or [`MaxForce`](crate::MaxForce) does not allow, the
/// element gets a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum SpringTuning {
    /// By a natural frequency and a damping ratio.
    Frequency {
        /// Undamped natural frequency, Hz, above zero.
        frequency: f32,
        /// Damping ratio c/(2 √(k m)), not negative: 0 oscillates for ever, 1 is critical damping.
        damping_ratio: f32,
    },
    /// By the sag under the weight of the effective mass, or under the load on a joint. Also sets the rest length if that is
    /// `None`.
    Sag {
        /// Static sag, m, above zero; for a torsion element rad.
        sag: f32,
        /// Damping ratio c/(2 √(k m)), not negative: 0 oscillates for ever, 1 is critical damping.
        damping_ratio: f32,
    },
}

impl SpringTuning {
    /// From a natural frequency (Hz) and a damping ratio.
    pub const fn frequency(frequency: f32, damping_ratio: f32) -> Self {
        Self::Frequency {
            frequency,
            damping_ratio,
        }
    }

    /// From a static sag (m) under the engine's gravity, multiplied by the body's gravity scale, and a damping ratio.
    /// Without a rest length, the load stays where it was spawned; with one, it sags from there. Without gravity, it is
    /// a fault.
    pub const fn sag(sag: f32, damping_ratio: f32) -> Self {
        Self::Sag { sag, damping_ratio }
    }

    /// Returns stiffness (N/m) and damping (N s/m) for a mass (kg) and a gravity (m/s²): k = m (2π f)² for a frequency
    /// f or k = m g/s for a sag s, and c = 2 ζ √(k m). For a torsion element, give a moment of inertia (kg m²) to get
    /// N m/rad and N m s/rad. The arguments are not checked.
    pub fn coefficients(self, mass: f32, gravity: f32) -> (f32, f32) {
        let (stiffness, ratio) = match self {
            Self::Frequency {
                frequency,
                damping_ratio,
            } => (mass * (TAU * frequency) * (TAU * frequency), damping_ratio),
            Self::Sag { sag, damping_ratio } => (mass * gravity / sag, damping_ratio),
        };
        (stiffness, 2.0 * ratio * (stiffness * mass).sqrt())
    }
}

/// Returns the stiffness (N/m) of a coil spring of round wire, G d⁴/(8 D³ n): wire diameter d and mean coil diameter D
/// (m), number of active turns n, shear modulus G (Pa; steel 79.3e9). Source: A. M. Wahl, "Mechanical Springs", 1944.
/// The arguments are not checked.
pub fn wire_stiffness(
    wire_diameter: f32,
    coil_diameter: f32,
    active_turns: f32,
    shear_modulus: f32,
) -> f32 {
    shear_modulus * wire_diameter.powi(4) / (8.0 * coil_diameter.powi(3) * active_turns)
}
