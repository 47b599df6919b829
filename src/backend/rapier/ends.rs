//! Finds where an end is: on a body, on a descendant of a body, or at a point that the game moves.

use super::body::id;
use crate::backend::Place;
use crate::input::check::{Fault, MOST};
use crate::input::named_ends::MOST_LEVELS;
use bevy::ecs::system::SystemParam;
use bevy::math::{DAffine3, DVec3};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Finds the ends of elements.
#[derive(SystemParam)]
pub(crate) struct Ends<'w, 's> {
    bodies: Query<
        'w,
        's,
        (
            &'static RapierRigidBodyHandle,
            &'static RapierContextEntityLink,
            Option<&'static GlobalTransform>,
        ),
    >,
    places: Query<'w, 's, (Option<&'static Transform>, Option<&'static ChildOf>)>,
}

impl Ends<'_, '_> {
    /// Walks up the hierarchy from the entity `end` to the first body, or to the root.
    ///
    /// It composes local transforms instead of reading `GlobalTransform`, which is out of date for children within a fixed tick
    /// and interpolated for bodies.
    pub(crate) fn find(
        &self,
        end: Entity,
        anchor: Vec3,
        field: &'static str,
        scale: &mut Option<Vec3>,
    ) -> Result<Place, Fault> {
        let mut point = anchor.as_dvec3();
        let mut current = end;
        let mut levels = 0;
        let body = loop {
            levels += 1;
            if levels > MOST_LEVELS {
                return Err(Fault::new(field, "has parents in a circle"));
            }
            if let Ok((handle, link, global)) = self.bodies.get(current) {
                if point != DVec3::ZERO {
                    point *= steady_scale(global, scale);
                }
                break Some((id(handle.0), link.0));
            }
            let (transform, parent) = self.places.get(current).map_err(|_| {
                Fault::new(field, "is an entity that does not exist or is disabled")
            })?;
            let Some(transform) = transform else {
                if current == end {
                    return Err(Fault::new(
                        field,
                        "has neither a rigid body (on itself or above it) nor a Transform",
                    ));
                }
                break None;
            };
            point = DAffine3::from_scale_rotation_translation(
                transform.scale.as_dvec3(),
                transform.rotation.as_dquat(),
                transform.translation.as_dvec3(),
            )
            .transform_point3(point);
            match parent {
                Some(parent) => current = parent.parent(),
                None => break None,
            }
        };
        check(point, field)?;
        Ok(match body {
            Some((body, context)) => Place::OnBody {
                entity: current,
                body,
                context,
                local: point,
            },
            None => Place::Point(point),
        })
    }
}

/// Returns a fault if a point is not finite or too far away for the engine.
fn check(point: DVec3, field: &'static str) -> Result<(), Fault> {
    // NaN is not within any bound.
    if point.abs().cmple(DVec3::splat(f64::from(MOST))).all() {
        return Ok(());
    }
    let reason = if point.is_finite() {
        "is farther than 1e12 m from the origin, or from its body"
    } else {
        "has a Transform that is not finite"
    };
    Err(Fault::new(field, reason))
}

/// Relative change of a scale up to which it is rounding. Pinned by `anchoring`.
const STEADY: f64 = 1e-4;

/// The body's global scale. The scale of a rotating transform changes in its last bits, which would make the anchor tremble.
/// So changes up to [`STEADY`] are ignored.
fn steady_scale(global: Option<&GlobalTransform>, last: &mut Option<Vec3>) -> DVec3 {
    let now = global.map_or(Vec3::ONE, GlobalTransform::scale);
    let known = last.unwrap_or(Vec3::ONE);
    let [from, to] = [known, now].map(|scale| scale.as_dvec3());
    let same = (to - from).abs().cmple(from.abs() * STEADY).all();
    let scale = if same { known } else { now };
    *last = Some(scale);
    scale.as_dvec3()
}
