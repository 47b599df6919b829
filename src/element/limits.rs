use bevy::prelude::*;

/// In which directions an element acts: spring, [`Preload`] and damper together, but not the stops of a
/// [`SpringTravel`]. On a torsion element, `Pull` allows only moments that turn towards smaller angles.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone, Hash)]
pub enum SpringAction {
    /// Pulls and pushes.
    #[default]
    Both,
    /// Pulls only, like a rope or a bungee. A slack element has no force and no damping. A [`Preload`] is added before
    /// the force is cut: with a preload P and a stiffness k, the element goes slack at P/k below its rest length.
    Pull,
    /// Pushes only, like a seat or a buffer.
    Push,
}

/// Constant tension that is added to that of the spring, N: the force at the rest length. A negative preload pushes the
/// ends apart.
///
/// It is part of [`SpringReadout::spring_force`](crate::SpringReadout::spring_force). Beside [`SpringAction::Pull`] or
/// [`SpringAction::Push`], spring and preload are added first, and the sum is cut at zero: a slack rope has no force,
/// whatever its preload. [`HoldPose`](crate::HoldPose) computes the preload that holds a load.
///
/// It must be finite and at most 1e12 in magnitude. Otherwise the element gets a [`SpringFault`](crate::SpringFault) and
/// does not act. On a torsion element it is a moment, N m.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Default, Debug, PartialEq, Clone)]
pub struct Preload(pub f32);

/// Greatest magnitude of the force of spring and damper together, N, above zero. A greater sum is cut to this value, as
/// in a clutch that slips. It does not limit the stops of a [`SpringTravel`]. On a torsion element it is a moment, N m. With
/// a value that is not above zero, the element gets a [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct MaxForce(pub f32);

/// Least and greatest length of an element, with an elastic stop at each. At a penetration p, a stop pushes back with
/// the force `stop_stiffness` · p · (1 + `progression` · p), and `stop_damping` takes energy while the stop is pressed.
/// A stop never holds back an end that leaves it.
///
/// `stop_stiffness`, `progression` and `stop_damping` must be from 0 to 1e12, and `max_length` must be above `min_length`. A
/// `min_length` below zero is only for a torsion element and beside a [`SpringAxis`](crate::SpringAxis). Otherwise the element gets a [`SpringFault`](crate::SpringFault) and does not act. On a torsion element, lengths are
/// angles (rad), and forces are moments (N m).
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct SpringTravel {
    /// Length at which the bump stop begins, m: for example the solid length of a coil. 0 for no stop. On a torsion
    /// element or beside a [`SpringAxis`](crate::SpringAxis), 0 is a stop as well, and negative infinity is no stop.
    pub min_length: f32,
    /// Length at which the rebound stop begins, m, above `min_length`. Infinite for no stop.
    pub max_length: f32,
    /// Stiffness of both stops where they begin, N/m.
    pub stop_stiffness: f32,
    /// Growth of the stops' stiffness with penetration, 1/m.
    pub progression: f32,
    /// Damping of both stops, N s/m.
    pub stop_damping: f32,
}

impl SpringTravel {
    /// Between two lengths (m), with stops of a stiffness (N/m), without progression and damping.
    pub const fn new(min_length: f32, max_length: f32, stop_stiffness: f32) -> Self {
        Self {
            min_length,
            max_length,
            stop_stiffness,
            progression: 0.0,
            stop_damping: 0.0,
        }
    }

    /// Sets the growth of the stops' stiffness with penetration, 1/m.
    pub const fn with_progression(mut self, progression: f32) -> Self {
        self.progression = progression;
        self
    }

    /// Sets the stops' damping, N s/m.
    pub const fn with_stop_damping(mut self, damping: f32) -> Self {
        self.stop_damping = damping;
        self
    }
}
