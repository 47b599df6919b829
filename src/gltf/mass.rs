//! Computes the mass of a loaded body from its `motion` and its colliders.

use super::physics::Motion;
use bevy::prelude::*;
use bevy_rapier3d::prelude::{LockedAxes, MassProperties};
use bevy_rapier3d::rapier::prelude::MassProperties as RapierMass;

/// Density of a body whose mass the file does not give: that of water, kg/m³.
pub(super) const DENSITY: f32 = 1000.0;

/// Replaces a scale of ±1 with rounding errors by exactly ±1. A scale that is extracted from the matrix of a rotated
/// node has such errors.
pub(super) fn steady(scale: Vec3) -> Vec3 {
    let near = |x: f32| {
        if (x.abs() - 1.0).abs() < 1e-5 {
            x.signum()
        } else {
            x
        }
    };
    Vec3::from_array(scale.to_array().map(near))
}

/// Returns the mass properties of a body, and the axes to lock because the mass or the whole inertia is infinite.
/// `shapes` holds the mass properties of its colliders at [`DENSITY`], in the body's frame. `scale` is the scale of
/// its node.
pub(super) fn mass(
    motion: &Motion,
    shapes: RapierMass,
    scale: Vec3,
) -> (MassProperties, LockedAxes) {
    let of_shapes = shapes.mass();
    let inertia = shapes.principal_inertia();
    let sound = of_shapes > 0.0
        && of_shapes.is_finite()
        && inertia.is_finite()
        && inertia.cmpgt(Vec3::ZERO).all()
        && shapes.local_com.is_finite()
        && shapes.principal_inertia_local_frame.is_finite();
    let mut locked = LockedAxes::empty();
    let mass = match motion.mass {
        Some(0.0) => {
            locked = LockedAxes::TRANSLATION_LOCKED;
            let unlocked = motion.unlocked_mass.filter(|mass| *mass > 0.0);
            unlocked.unwrap_or(1.0)
        }
        Some(mass) => mass,
        None if sound => of_shapes,
        None => 1.0,
    };
    let (mut centre, mut inertia, mut frame) = if sound {
        (
            shapes.local_com,
            inertia * (mass / of_shapes),
            shapes.principal_inertia_local_frame,
        )
    } else {
        // The size is unknown: inertia of a cube with edges of 1 m.
        (Vec3::ZERO, Vec3::splat(mass / 6.0), Quat::IDENTITY)
    };
    if let Some(given) = motion.centre_of_mass {
        centre = given * steady(scale);
    }
    if let Some(given) = motion.inertia {
        (inertia, frame) = (given, motion.inertia_frame);
        if given == Vec3::ZERO {
            locked |= LockedAxes::ROTATION_LOCKED;
            inertia = motion.unlocked_inertia.unwrap_or(given);
        }
    }
    let properties = MassProperties {
        local_center_of_mass: centre,
        mass,
        principal_inertia_local_frame: frame,
        principal_inertia: inertia,
    };
    (properties, locked)
}
