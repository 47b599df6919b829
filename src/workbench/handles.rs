//! Handles in the scene that drag the anchors of the chosen element.

use super::bench::Bench;
use super::pointer::{Pointer, STILL};
use crate::element::WorldAnchors;
use bevy::prelude::*;

/// Greatest distance from the pointer to an anchor, pixels, at which its handle is picked.
const NEAR: f32 = 10.0;

/// The handle under the pointer (0 for end A, 1 for end B), and the drag in progress.
#[derive(Resource, Default, Debug)]
pub(super) struct Handles {
    over: Option<usize>,
    drag: Option<Drag>,
}

/// A drag of a handle.
#[derive(Clone, Copy, Debug)]
struct Drag {
    entity: Entity,
    end: usize,
    /// Position of the pointer in the window when the anchor was last moved, logical pixels.
    from: Vec2,
    /// Whether the pointer has moved further than a click may.
    begun: bool,
}

impl Handles {
    /// Whether the handle of an end is highlighted.
    pub fn is_lit(&self, end: usize) -> bool {
        self.drag.map_or(self.over, |drag| Some(drag.end)) == Some(end)
    }
}

/// Picks the handle under the pointer, and moves its anchor with the pointer.
///
/// The anchor moves by as much as the pointer, relative to its body. If the pointer stands still while the body
/// swings, nothing is edited.
pub(super) fn drag(
    pointer: Pointer,
    mut handles: ResMut<Handles>,
    mut bench: ResMut<Bench>,
    settings: Res<super::CoiloverWorkbench>,
    globals: Query<&GlobalTransform>,
    // `WorldAnchors` that wait for a step would overwrite the dragged anchors.
    waiting: Query<(), With<WorldAnchors>>,
) {
    let shown = bench
        .subject
        .as_ref()
        .filter(|subject| !subject.now.part.is_torsion() && !waiting.contains(subject.entity));
    let (Some(subject), Some(at)) = (shown, pointer.at()) else {
        *handles = Handles::default();
        return;
    };
    let entity = subject.entity;
    let distance = |end: usize| {
        let anchor = pointer.project(subject.facts.ends[end].at?)?;
        Some((end, anchor.distance(at)))
    };
    let nearest = [0, 1]
        .into_iter()
        .filter_map(distance)
        .filter(|(_, distance)| *distance <= NEAR)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    handles.over = nearest.map(|(end, _)| end).filter(|_| !pointer.is_taken());

    if pointer.put_down().is_some() && !pointer.is_with(settings.grab) {
        handles.drag = handles.over.map(|end| Drag {
            entity,
            end,
            from: at,
            begun: false,
        });
    }
    let Some(mut drag) = handles.drag.take() else {
        return;
    };
    let ends = subject.now.part.ends();
    if drag.entity != entity || !(pointer.is_down() || pointer.is_let_go()) {
        bench.history.close();
        return;
    }
    if !drag.begun && at.distance(drag.from) > STILL {
        drag.begun = true;
        // A number that was typed before is a separate edit.
        bench.history.close();
    }
    if drag.begun && at != drag.from {
        let end = globals.get(ends[drag.end]).ok();
        if end.is_some_and(|end| shift(&mut bench, &pointer, end, drag, at)) {
            drag.from = at;
        }
    }
    if pointer.is_down() {
        handles.drag = Some(drag);
    } else {
        bench.history.close();
    }
}

/// Moves an anchor by as much as the pointer has moved in the plane through the anchor that faces the camera. Returns
/// whether it could.
fn shift(
    bench: &mut Bench,
    pointer: &Pointer,
    end: &GlobalTransform,
    drag: Drag,
    to: Vec2,
) -> bool {
    let Some(subject) = &bench.subject else {
        return false;
    };
    let mut after = subject.now.clone();
    let anchors = after.anchors.get_or_insert_default();
    let anchor = match drag.end {
        0 => &mut anchors.a,
        _ => &mut anchors.b,
    };
    let here = end.transform_point(*anchor);
    let plane = |at| pointer.in_plane(at, here);
    let (Some(from), Some(to)) = (plane(drag.from), plane(to)) else {
        return false;
    };
    let local = end.affine().inverse().transform_point3(here + (to - from));
    // An end with a scale of zero has no local points.
    if !local.is_finite() {
        return false;
    }
    *anchor = local;
    bench.edit("an anchor", after);
    true
}
