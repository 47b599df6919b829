use bevy::prelude::*;

/// Breaks the element when after a step its force or its length is more than this.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Component, Debug, PartialEq, Clone)]
pub struct Breakable {
    /// Size of the force of spring and damper together, N; infinite for no limit.
    pub force: f32,
    /// m; infinite for no limit.
    pub length: f32,
    /// What becomes of the element.
    pub then: WhenBroken,
}

/// What becomes of an element that broke.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[type_path = "bevy_coilover"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[reflect(Default, Debug, PartialEq, Clone, Hash)]
pub enum WhenBroken {
    /// It is despawned, after the observers of [`SpringBroke`] have run.
    #[default]
    Despawn,
    /// It gets Bevy's `Disabled`, and acts again once that is removed.
    Disable,
}

impl Breakable {
    /// Breaks at a force, N.
    pub const fn at_force(force: f32) -> Self {
        Self {
            force,
            length: f32::INFINITY,
            then: WhenBroken::Despawn,
        }
    }

    /// Breaks at a length, m.
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

/// An element has broken; see [`Breakable`].
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq)]
pub struct SpringBroke {
    /// The element.
    pub entity: Entity,
    /// Its force when it broke, N, tension positive.
    pub force: f32,
    /// Its length then, m.
    pub length: f32,
}
