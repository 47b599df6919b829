// Code of the tests that differs between versions of Bevy and Rapier. `bevy-0.20/tests/physics/compat.rs` is its
// counterpart.

use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::IntegrationParameters;

/// Initialises the default Rapier context.
pub fn begin(parameters: IntegrationParameters, gravity: Vec3) -> RapierContextInitialization {
    RapierContextInitialization::InitializeDefaultRapierContext {
        integration_parameters: parameters,
        rapier_configuration: RapierConfiguration {
            gravity,
            ..RapierConfiguration::new(1.0)
        },
    }
}

/// A weight of 1 kg on a spring of 100 N/m below a hook.
pub fn rig() -> impl Scene {
    use bevy::scene::template_value;
    bsn! {
        Children [
            #Hook Transform { translation: Vec3 { x: 0.0, y: 2.0, z: 0.0 } },
            #Weight Transform template_value(RigidBody::Dynamic) template_value(AdditionalMassProperties::Mass(1.0)),
            SpringDamper { body_a: #Hook, body_b: #Weight, stiffness: 100.0, damping: 1.0 },
        ]
    }
}
