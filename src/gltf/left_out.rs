//! Collects what an exported file cannot hold, with the entity and the component.

use crate::{MouseSpring, SpringLoad};
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
            Ccd,
            SoftCcd,
            Sleeping,
            AdditionalSolverIterations,
            TransformInterpolation,
            ColliderDisabled,
            SolverGroups,
            ContactSkin,
            ActiveHooks,
            ContactForceEventThreshold,
            KinematicCharacterController,
            MouseSpring
        );
        self.tell_values(entity);
        #[cfg(feature = "visual")]
        {
            use crate::visual::{SpringSkin, TorsionCoil};
            tell!(SpringSkin, TorsionCoil);
        }
        if entity.get() == Some(&RigidBody::KinematicPositionBased) {
            self.tell(
                entity,
                "RigidBody::KinematicPositionBased comes back as KinematicVelocityBased",
            );
        }
    }

    /// Adds a sentence for each component that is lost with some values only.
    fn tell_values(&mut self, entity: EntityRef) {
        let of_trigger = entity.contains::<Sensor>();
        for (is_there, name) in [
            (entity.contains::<Friction>(), "Friction"),
            (entity.contains::<Restitution>(), "Restitution"),
        ] {
            if of_trigger && is_there {
                self.tell(entity, format_args!("{name} of a Sensor is not written"));
            }
        }
        // A trigger comes back with these two.
        let events = entity.get::<ActiveEvents>();
        if events.is_some_and(|e| !of_trigger || *e != ActiveEvents::COLLISION_EVENTS) {
            self.tell(entity, "ActiveEvents is not written");
        }
        let types = entity.get::<ActiveCollisionTypes>();
        if types.is_some_and(|t| !of_trigger || *t != ActiveCollisionTypes::all()) {
            self.tell(entity, "ActiveCollisionTypes is not written");
        }
        // The share of the elements is not lost: they come back.
        let load = entity.get::<SpringLoad>();
        let force = load.map(|load| load.user).or(entity.get().copied());
        if force.is_some_and(|force| force != ExternalForce::default()) {
            self.tell(entity, "ExternalForce is not written");
        }
        let impulse = entity.get::<ExternalImpulse>();
        if impulse.is_some_and(|impulse| *impulse != ExternalImpulse::default()) {
            self.tell(entity, "ExternalImpulse is not written");
        }
    }

    pub(super) fn sentences(self) -> Vec<String> {
        self.0
    }
}
