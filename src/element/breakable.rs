use bevy::prelude::*;

/// Breaks the element if its force or its length exceeds a limit after a step. On a torsion element, the limits are a
/// moment (N m) and an angle (rad). A limit that is negative or NaN is a [`SpringFault`](crate::SpringFault).
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
    /// Breaks at a force, N. The element is then despawned.
    pub const fn at_force(force: f32) -> Self {
        Self {
            force,
            length: f32::INFINITY,
            then: WhenBroken::Despawn,
        }
    }

    /// Breaks at a length, m. The element is then despawned.
    pub const fn at_length(length: f32) -> Self {
        Self {
            force: f32::INFINITY,
            length,
            then: WhenBroken::Despawn,
        }
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
    /// Force of the element when it broke, N, tension positive.
    pub force: f32,
    /// Length of the element when it broke, m.
    pub length: f32,
}
