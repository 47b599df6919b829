use bevy::prelude::*;

/// Breaks the element if its force or its length exceeds a limit after a step. On a torsion element, the limits are a
/// moment (N m) and an angle (rad). With a limit that is negative or NaN, the element gets a
/// [`SpringFault`](crate::SpringFault) and does not act.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Breakable {
    /// Greatest magnitude of the force of spring, damper and stops together
    /// ([`SpringReadout::force`](crate::SpringReadout::force)), N. Infinite for no limit.
    pub force: f32,
    /// Greatest magnitude of the length, m, or of the angle of a torsion element, rad. Infinite for no limit.
    pub length: f32,
    /// What happens to the element when it breaks.
    pub then: WhenBroken,
}

/// What happens to an element that broke.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum WhenBroken {
    /// The element is despawned, after the observers of [`SpringBroke`] have run.
    #[default]
    Despawn,
    /// The element gets Bevy's `Disabled` component, and acts again once that is removed.
    Disable,
}

impl Breakable {
    /// Breaks at a force, N, or at a moment of a torsion element, N m. The element is then despawned.
    pub const fn at_force(force: f32) -> Self {
        Self {
            force,
            length: f32::INFINITY,
            then: WhenBroken::Despawn,
        }
    }

    /// Breaks at a length, m, or at an angle of a torsion element, rad. The element is then despawned.
    pub const fn at_length(length: f32) -> Self {
        Self {
            force: f32::INFINITY,
            length,
            then: WhenBroken::Despawn,
        }
    }

    /// Sets the force at which it breaks, N, or the moment of a torsion element, N m.
    pub const fn with_force(mut self, force: f32) -> Self {
        self.force = force;
        self
    }

    /// Sets the length at which it breaks, m, or the angle of a torsion element, rad.
    pub const fn with_length(mut self, length: f32) -> Self {
        self.length = length;
        self
    }

    /// Disables the element instead of despawning it.
    pub const fn disabling(mut self) -> Self {
        self.then = WhenBroken::Disable;
        self
    }
}

/// Event: an element broke; see [`Breakable`].
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct SpringBroke {
    /// The element that broke.
    pub entity: Entity,
    /// Force of spring, damper and stops when it broke, N, tension positive; of a torsion element the moment, N m.
    pub force: f32,
    /// Length of the element when it broke, m; of a torsion element the angle, rad.
    pub length: f32,
}
