//! Places the parts of elements, where [`place`](super::place) has found the elements.

use super::heading::rotation;
use super::layout::{Part, nothing};
use super::parts::Levels;
use super::place::{Due, Placement};
use super::skin::SpringSkin;
use bevy::ecs::entity_disabling::Disabled;
use bevy::math::{Affine3A, Mat3A};
use bevy::mesh::Mesh3d;
use bevy::prelude::*;
use std::sync::Arc;

/// Has elements placed again that were not updated while they or one of their parts were disabled.
pub(super) fn recall(
    mut enabled: RemovedComponents<Disabled>,
    parts: Query<&ChildOf, With<Part>>,
    mut elements: Query<&mut Placement>,
) {
    for entity in enabled.read() {
        let element = parts.get(entity).map_or(entity, ChildOf::parent);
        if let Ok(mut placement) = elements.get_mut(element) {
            placement.recall();
        }
    }
}

/// Places the parts, and chooses their level of detail.
pub(super) fn lay(
    mut parts: Query<(
        &Part,
        Ref<ChildOf>,
        &mut GlobalTransform,
        Option<&ViewVisibility>,
        Option<(&Levels, &mut Mesh3d)>,
    )>,
    mut elements: Query<&mut Placement>,
    disabled: Query<(), (With<Placement>, With<Disabled>)>,
) {
    for (part, parent, mut global, visibility, mut levels) in &mut parts {
        let Ok(mut placement) = elements.get_mut(parent.parent()) else {
            // The parts that the crate made are gone. What users brought along stays, but is not drawn either.
            if disabled.contains(parent.parent()) {
                global.set_if_neq(nothing());
            }
            continue;
        };
        // A change by other code, such as transform propagation, is overwritten.
        let has_changed = || {
            global.is_changed()
                || parent.is_changed()
                || levels.as_ref().is_some_and(|(_, mesh)| mesh.is_changed())
        };
        let shows = || visibility.is_some_and(|v| v.get());
        let is_due = match placement.due {
            Due::Nowhere | Due::Laid => has_changed(),
            Due::Hidden | Due::Visible => {
                if shows() {
                    placement.bypass_change_detection().shows = true;
                }
                shows() || has_changed()
            }
            Due::All => {
                // In the next frame the element may not have its turn.
                if !placement.seen && shows() {
                    placement.bypass_change_detection().shows = true;
                }
                true
            }
        };
        if !is_due {
            continue;
        }
        let placement = &*placement;
        // `GlobalTransform` is written, because propagation has run and rendering reads it. A part that has not moved
        // must not look changed, or it would be sent to the graphics card again.
        global.set_if_neq(world(placement, *part));
        if let Some((levels, mesh)) = &mut levels {
            let wanted = &levels.0[usize::from(placement.level)];
            if !is_same(&mesh.0, wanted) {
                mesh.0 = wanted.clone();
            }
        }
    }
}

/// Takes along what hangs below a skin. Transform propagation has placed it by the skin's own `Transform`.
pub(super) fn carry(
    skins: Query<(&GlobalTransform, &Children), (With<Part>, With<SpringSkin>)>,
    mut below: Query<(&Transform, &mut GlobalTransform, Option<&Children>), Without<Part>>,
    mut waiting: Local<Vec<(Entity, GlobalTransform)>>,
) {
    for (global, children) in &skins {
        waiting.extend(children.into_iter().map(|child| (*child, *global)));
    }
    while let Some((entity, above)) = waiting.pop() {
        if let Ok((own, mut global, children)) = below.get_mut(entity) {
            let here = above * *own;
            global.set_if_neq(here);
            let children = children.into_iter().flatten();
            waiting.extend(children.map(|child| (*child, here)));
        }
    }
}

/// Whether both handles are of the same mesh. Fast where one handle is a clone of the other.
#[inline]
fn is_same(one: &Handle<Mesh>, other: &Handle<Mesh>) -> bool {
    match (one, other) {
        (Handle::Strong(one), Handle::Strong(other)) if Arc::ptr_eq(one, other) => true,
        _ => one == other,
    }
}

/// Transform of a part in the world. A part that never had a place has no size.
#[inline]
fn world(placement: &Placement, part: Part) -> GlobalTransform {
    if !placement.is_known() {
        return nothing();
    }
    let columns = rotation(placement.axis, placement.side);
    let (at, scale) = placement.layout.lay(part, placement.length);
    GlobalTransform::from(Affine3A {
        matrix3: Mat3A::from_cols(
            columns.x_axis * scale.x,
            columns.y_axis * scale.y,
            columns.z_axis * scale.z,
        ),
        translation: placement.ends.from + columns.y_axis * at,
    })
}
