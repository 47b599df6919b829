//! Anchors that were given as points of the world become points of the ends.

use crate::element::{Anchors, WorldAnchors};
use crate::input::parts::{IsElement, Parts, PartsItem};
use bevy::prelude::*;

/// Turns [`WorldAnchors`] into [`Anchors`]. Where an end is not there yet, it waits; the element says so itself.
pub(crate) fn anchor(
    mut elements: ParamSet<(
        Query<(Parts, &WorldAnchors), (IsElement, With<Anchors>)>,
        Query<&mut Anchors>,
    )>,
    transforms: TransformHelper,
    mut commands: Commands,
) {
    let on_ends = |(parts, points): (PartsItem, &WorldAnchors)| {
        // Composed from local transforms: the global ones are a frame old here.
        let local = |end: Entity, point: Vec3| {
            let global = transforms.compute_global_transform(end).ok()?;
            Some(global.affine().inverse().transform_point3(point))
        };
        let [a, b] = parts.parameters().ok()?.ties.ends;
        let anchors = Anchors::new(local(a, points.a)?, local(b, points.b)?);
        Some((parts.entity, anchors))
    };
    let found: Vec<_> = elements.p0().iter().filter_map(on_ends).collect();
    for (entity, anchors) in found {
        // What cannot be turned (an end that is scaled to nothing) is no number, and that is told as any bad anchor is.
        if let Ok(mut given) = elements.p1().get_mut(entity) {
            given.set_if_neq(anchors);
        }
        commands.entity(entity).try_remove::<WorldAnchors>();
    }
}
