//! What a file cannot hold is told, with the entity and the component.

use super::export_element::ends;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use std::fmt::Display;

/// One sentence for each thing that is not in the file, or is there as something else.
#[derive(Default)]
pub(super) struct LeftOut(Vec<String>);

impl LeftOut {
    /// Tells something of an entity, with its name where it has one.
    pub(super) fn tell(&mut self, entity: EntityRef, what: impl Display) {
        let id = entity.id();
        self.0.push(match entity.get::<Name>() {
            Some(name) => format!("{name} ({id}): {what}"),
            None => format!("{id}: {what}"),
        });
    }

    /// Tells of an entity's components for which the file has no word.
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
