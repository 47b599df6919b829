//! Converts anchors that were given as points of the world into points of the ends, before the step.

use crate::element::{Anchors, WorldAnchors};
use crate::input::named_ends::MOST_LEVELS;
use crate::input::parts::{Acts, Parts, PartsItem};
use bevy::ecs::system::SystemState;
use bevy::prelude::*;

/// What is read and written to convert anchors.
type Sources<'w, 's> = (
    ParamSet<
        'w,
        's,
        (
            Query<'w, 's, (Parts, &'static WorldAnchors), (Acts, With<Anchors>)>,
            Query<'w, 's, &'static mut Anchors>,
        ),
    >,
    Query<'w, 's, &'static Transform>,
    Query<'w, 's, &'static ChildOf>,
    Commands<'w, 's>,
);

/// Converts [`WorldAnchors`] into [`Anchors`]. If an end does not exist yet, the component waits, and the element
/// itself reports the missing end. It also waits for named ends, because the present ends may be those of earlier names.
pub(crate) fn anchor(world: &mut World, sources: &mut SystemState<Sources>) {
    if let Ok((elements, transforms, parents, commands)) = sources.get_mut(world) {
        convert(elements, transforms, parents, commands);
    }
    sources.apply(world);
}

fn convert(
    mut elements: ParamSet<(
        Query<(Parts, &WorldAnchors), (Acts, With<Anchors>)>,
        Query<&mut Anchors>,
    )>,
    transforms: Query<&Transform>,
    parents: Query<&ChildOf>,
    mut commands: Commands,
) {
    let on_ends = |(parts, points): (PartsItem, &WorldAnchors)| {
        // Composed from local transforms: `GlobalTransform` is one frame old here.
        let local = |end: Entity, point: Vec3| {
            // Parents in a circle would hang the game. The element itself reports them.
            if parents.iter_ancestors(end).nth(MOST_LEVELS).is_some() {
                return None;
            }
            let own = GlobalTransform::from(*transforms.get(end).ok()?);
            // A parent without a place is the root, as for the search for ends.
            let above = parents.iter_ancestors(end);
            let above = above.map_while(|parent| transforms.get(parent).ok());
            let global = above.fold(own, |below, parent| *parent * below);
            Some(global.affine().inverse().transform_point3(point))
        };
        let [a, b] = parts.parameters().ok()?.ties.ends;
        let anchors = Anchors::new(local(a, points.a)?, local(b, points.b)?);
        Some((parts.entity, anchors))
    };
    let found: Vec<_> = elements.p0().iter().filter_map(on_ends).collect();
    for (entity, anchors) in found {
        // A point that cannot be converted (on an end scaled to zero) becomes NaN, and is reported like any bad anchor.
        if let Ok(mut given) = elements.p1().get_mut(entity) {
            given.set_if_neq(anchors);
        }
        commands.entity(entity).try_remove::<WorldAnchors>();
    }
}
