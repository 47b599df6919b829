use bevy::prelude::*;
use std::f32::consts::TAU;

/// Stiffness and damping of an element by what one sees of them. At the first step that the element acts they are
/// worked out with the effective mass that its ends have then, written into its fields, and this component is
/// removed: they stay what they are when masses change, as a real spring does.
///
/// The effective mass is what joints and contacts leave: the arm of a lamp on a hinge counts with its inertia about the
/// hinge, and a wheel that stands on the ground does not move. The engine knows contacts only after a step, so where a
/// body has colliders they are worked out once more before the second step. What falls freely then counts as free: for
/// what will land later, take [`SpringTuning::coefficients`] for the mass that the spring is to carry.
///
/// A sag finds the rest length too, if the element has none: such that the load stays where it was spawned. A rest length
/// that you give is kept, and the load sags from there. Where two ends move, and neither stands on the ground after the
/// first step, nothing says which is the load, and the rest length is the length at the first step, as ever: put a
/// [`HoldPose`](crate::HoldPose) beside it. For several springs under one load take [`SpringTuning::coefficients`] with
/// each spring's share of the mass, and [`HoldPose::share`](crate::HoldPose::share).
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub enum SpringTuning {
    /// Swings so often, and fades so fast.
    Frequency {
        /// Undamped natural frequency, Hz.
        frequency: f32,
        /// c/(2 √(k m)): 0 swings for ever, 1 is critical.
        damping_ratio: f32,
    },
    /// Gives way so far under the weight of its effective mass; sets the rest length too, if it is `None`.
    Sag {
        /// m, above zero.
        sag: f32,
        /// As above.
        damping_ratio: f32,
    },
}

impl SpringTuning {
    /// Natural frequency (Hz) and damping ratio.
    pub const fn frequency(frequency: f32, damping_ratio: f32) -> Self {
        Self::Frequency {
            frequency,
            damping_ratio,
        }
    }

    /// Static sag (m) under the engine's gravity and damping ratio. Without a rest length, the load stays where it was
    /// spawned; with one, it sags.
    pub const fn sag(sag: f32, damping_ratio: f32) -> Self {
        Self::Sag { sag, damping_ratio }
    }

    /// Stiffness (N/m) and damping (N s/m) for a mass (kg) under a gravity (m/s²).
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

/// Stiffness (N/m) of a coil spring of round wire, G d⁴/(8 D³ n): wire diameter d and mean coil diameter D (m),
/// active turns n, shear modulus G (Pa; steel 79.3e9). (A. M. Wahl, "Mechanical Springs", 1944.)
pub fn wire_stiffness(
    wire_diameter: f32,
    coil_diameter: f32,
    active_turns: f32,
    shear_modulus: f32,
) -> f32 {
    shear_modulus * wire_diameter.powi(4) / (8.0 * coil_diameter.powi(3) * active_turns)
}
