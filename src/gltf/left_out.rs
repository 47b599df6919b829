//! Collects what an exported file cannot hold, with the entity and the component.

use super::export_element::ends;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::fmt::Display;

/// Sentences about things that are missing from the file, or are written as something else.
#[derive(Default)]
pub(super) struct LeftOut(Vec<String>);

impl LeftOut {
    /// Adds a sentence about an entity, with its name if it has one.
    pub(super) fn tell(&mut self, entity: EntityRef, what: impl Display) {
        let id = entity.id();
        self.0.push(match entity.get::<Name>() {
            Some(name) => format!("{name} ({id}): {what}"),
            None => format!("{id}: {what}"),
        });
    }

    /// Adds a sentence for each component that the file cannot hold, or holds as something else.
    pub(super) fn tell_unwritten(&mut self, entity: EntityRef) {
        macro_rules! tell {
            ($($component:ident),*) => {
                $(if entity.contains::<$component>() {
                    self.tell(entity, concat!(stringify!($component), " is not written"));
                })*
            };
        }
        tell!(
            RigidBodyDisabled,
            Damping,
            Dominance,
            ColliderDisabled,
            SolverGroups,
            ContactSkin
        );
        #[cfg(feature = "visual")]
        {
            use crate::visual::TorsionCoil;
            tell!(TorsionCoil);
        }
        if entity.contains::<Disabled>() && ends(entity).is_none() {
            self.tell(entity, "Disabled is written of elements only");
        }
        if entity.get() == Some(&RigidBody::KinematicPositionBased) {
            self.tell(
                entity,
                "RigidBody::KinematicPositionBased comes back as KinematicVelocityBased",
            );
        }
    }

    pub(super) fn sentences(self) -> Vec<String> {
        self.0
    }
}
