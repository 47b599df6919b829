//! Converts anchors that were given as points of the world into points of the ends, before the step.

use crate::element::{Anchors, WorldAnchors};
use crate::input::named_ends::MOST_LEVELS;
use crate::input::parts::{Acts, Parts, PartsItem};
use crate::input::strays::{GRACE, who};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::system::SystemState;
use bevy::prelude::*;

/// Elements whose points wait for a place of an end, with the number of ticks that they have waited.
type Waiting<'s> = Local<'s, EntityHashMap<u8>>;

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
    Query<'w, 's, &'static Name>,
    Waiting<'s>,
    Commands<'w, 's>,
);

/// Converts [`WorldAnchors`] into [`Anchors`]. If an end does not exist yet, the component waits, and the element
/// itself reports the missing end. It also waits for named ends, because the present ends may be those of earlier names, and
/// for a body without a place, which no other fault tells of: then a warning is logged once.
pub(crate) fn anchor(world: &mut World, sources: &mut SystemState<Sources>) {
    if let Ok((elements, transforms, parents, names, waiting, commands)) = sources.get_mut(world) {
        convert(elements, transforms, parents, names, waiting, commands);
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
    names: Query<&Name>,
    mut waiting: Waiting,
    mut commands: Commands,
) {
    let mut placeless = Vec::new();
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
            // On an end that is scaled to nothing, no point has a place.
            let own = global.affine().inverse().transform_point3(point);
            own.is_finite().then_some(own)
        };
        let [a, b] = parts.parameters().ok()?.ties.ends;
        match (local(a, points.a), local(b, points.b)) {
            (Some(a), Some(b)) => Some((parts.entity, Anchors::new(a, b))),
            (found, _) => {
                let end = if found.is_none() { ("a", a) } else { ("b", b) };
                // A fault of the element tells of an end that is no end at all.
                if !parts.told {
                    placeless.push((parts.entity, end));
                }
                None
            }
        }
    };
    let found: Vec<_> = elements.p0().iter().filter_map(on_ends).collect();
    tell(placeless, &names, &mut waiting);
    for (entity, anchors) in found {
        if let Ok(mut given) = elements.p1().get_mut(entity) {
            given.set_if_neq(anchors);
        }
        commands.entity(entity).try_remove::<WorldAnchors>();
    }
}

/// Warns once about each element whose points still wait for the place of an end.
fn tell(
    placeless: Vec<(Entity, (&str, Entity))>,
    names: &Query<&Name>,
    waiting: &mut EntityHashMap<u8>,
) {
    let before = std::mem::take(waiting);
    for (entity, (field, end)) in placeless {
        let ticks = before
            .get(&entity)
            .map_or(1, |ticks| ticks.saturating_add(1));
        waiting.insert(entity, ticks);
        if ticks != GRACE {
            continue;
        }
        let who = who(entity, names.get(entity).ok());
        log::warn!(
            "{who}: WorldAnchors::{field} cannot be converted, because {end} has no Transform or is scaled to \
             nothing; until that changes, the element acts on its Anchors"
        );
    }
}
