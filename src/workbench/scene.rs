//! Places the panel in the window, and draws and picks elements in the scene.

use super::bench::Bench;
use super::grab::Hand;
use super::handles::Handles;
use super::model::snapshot::Snapshot;
use super::pointer::{Free, Pointer, STILL};
use super::{CoiloverWorkbench, commands, is_open, view};
use crate::input::parts::IsElement;
use bevy::camera::RenderTarget;
use bevy::gizmos::AppGizmoBuilder;
use bevy::gizmos::config::{GizmoConfigGroup, GizmoConfigStore};
use bevy::gizmos::gizmos::Gizmos;
use bevy::prelude::*;
use bevy::window::WindowRef;
use bevy_egui::egui::{Align2, Color32, FontId, LayerId, Pos2, Ui, UiBuilder, pos2};
use bevy_egui::{EguiContext, EguiContexts, PrimaryEguiContext};

/// Greatest distance from the pointer to an element, pixels, at which a click picks it.
const NEAR: f32 = 12.0;

const COLOR: Color = Color::srgb(1.0, 0.9, 0.2);

/// Colour of a highlighted handle, and of the line that pulls a body.
const LIT: Color = Color::WHITE;

/// Radius of a handle as a fraction of its distance from the camera: about 7 pixels in a window 720 pixels high.
const BALL: f32 = 0.008;

/// Gizmos that mark the chosen element.
#[derive(GizmoConfigGroup, Reflect, Clone, Debug, Default)]
#[type_path = "bevy_coilover"]
pub(super) struct Mark;

/// Adds the gizmos that mark the chosen element, if the app has gizmos.
pub(super) fn add_gizmos(app: &mut App) {
    if !app.world().contains_resource::<GizmoConfigStore>() {
        return;
    }
    app.init_gizmo_group::<Mark>().add_systems(
        PostUpdate,
        mark.run_if(is_open).after(super::gather::gather),
    );
    let mut store = app.world_mut().resource_mut::<GizmoConfigStore>();
    let (config, _) = store.config_mut::<Mark>();
    // Drawn in front of solid objects.
    config.depth_bias = -1.0;
    config.line.width = 3.0;
}

/// Draws a line between the anchors, a ball at each anchor, and a line from a pulled body to the pointer.
fn mark(
    bench: Res<Bench>,
    handles: Res<Handles>,
    hand: Res<Hand>,
    globals: Query<&GlobalTransform>,
    cameras: Query<&GlobalTransform, With<PrimaryEguiContext>>,
    mut gizmos: Gizmos<Mark>,
) {
    let Some(eye) = cameras.iter().next() else {
        return;
    };
    let ball = |at: Vec3| BALL * eye.translation().distance(at);
    if let Some([held, to]) = hand.line(&globals) {
        gizmos.line(held, to, LIT);
        gizmos.sphere(to, ball(to), LIT);
    }
    let Some(subject) = &bench.subject else {
        return;
    };
    let [Some(a), Some(b)] = [0, 1].map(|end: usize| subject.facts.ends[end].at) else {
        return;
    };
    gizmos.line(a, b, COLOR);
    for (end, at) in [a, b].into_iter().enumerate() {
        let (size, color) = if handles.is_lit(end) {
            (1.4, LIT)
        } else {
            (1.0, COLOR)
        };
        gizmos.sphere(at, size * ball(at), color);
    }
}

/// Puts the panel on the uppermost camera that draws into the primary window, if the camera that had it is gone: egui chooses
/// only the first camera of an app.
pub(super) fn find_camera(
    holders: Query<(), With<PrimaryEguiContext>>,
    cameras: Query<(Entity, &Camera, &RenderTarget)>,
    mut commands: Commands,
) {
    if !holders.is_empty() {
        return;
    }
    let is_seen = |(_, camera, target): &(Entity, &Camera, &RenderTarget)| {
        camera.is_active && matches!(target, RenderTarget::Window(WindowRef::Primary))
    };
    let uppermost = cameras
        .iter()
        .filter(is_seen)
        .max_by_key(|(.., camera, _)| camera.order);
    if let Some((entity, ..)) = uppermost {
        commands
            .entity(entity)
            .insert((EguiContext::default(), PrimaryEguiContext));
    }
}

/// Draws the panel, and the names of the ends next to their anchors.
pub(super) fn show(
    mut contexts: EguiContexts,
    mut bench: ResMut<Bench>,
    mut workbench: ResMut<CoiloverWorkbench>,
    mut free: ResMut<Free>,
    cameras: Query<(&Camera, &GlobalTransform), With<PrimaryEguiContext>>,
    mut looked: Local<bool>,
) {
    let Ok(context) = contexts.ctx_mut() else {
        return;
    };
    if !std::mem::replace(&mut *looked, true) {
        bench.presets = commands::presets(&workbench.folder);
    }
    let place = UiBuilder::new()
        .layer_id(LayerId::background())
        .max_rect(context.viewport_rect());
    let mut ui = Ui::new(context.clone(), "coilover_workbench".into(), place);
    // Users zoom egui with Ctrl and plus or minus: then its points are no logical pixels of the window.
    let zoom = context.zoom_factor();
    if let (Some(subject), Some((camera, eye))) = (&bench.subject, cameras.iter().next()) {
        for (letter, end) in ["A", "B"].into_iter().zip(&subject.facts.ends) {
            let on_screen = end.at.and_then(|at| camera.world_to_viewport(eye, at).ok());
            if let Some(at) = on_screen {
                let text = format!("{letter}: {}", end.name);
                let at = pos2(at.x / zoom + 14.0, at.y / zoom);
                let font = FontId::proportional(13.0);
                // A shadow, so that the text is readable on any background.
                let shadow = at + bevy_egui::egui::vec2(1.0, 1.0);
                let painter = ui.painter();
                painter.text(
                    shadow,
                    Align2::LEFT_CENTER,
                    &text,
                    font.clone(),
                    Color32::BLACK,
                );
                painter.text(at, Align2::LEFT_CENTER, &text, font, Color32::YELLOW);
            }
        }
    }
    let middle = view::show(&mut ui, &mut bench);
    let corner = |at: Pos2| zoom * Vec2::new(at.x, at.y);
    free.0 = Some(Rect::from_corners(corner(middle.min), corner(middle.max)));
    if workbench.selected != bench.selected {
        workbench.selected = bench.selected;
    }
}

/// Chooses the element that was clicked.
pub(super) fn pick(
    pointer: Pointer,
    settings: Res<CoiloverWorkbench>,
    elements: Query<EntityRef, IsElement>,
    globals: Query<&GlobalTransform>,
    mut down: Local<Option<Vec2>>,
    mut commands: Commands,
) {
    if let Some(at) = pointer.put_down() {
        // While the key is held, the click is meant for a body.
        *down = Some(at).filter(|_| !pointer.is_with(settings.grab));
    }
    if !pointer.is_let_go() {
        return;
    }
    let (Some(at), Some(from)) = (pointer.at(), down.take()) else {
        return;
    };
    if at.distance(from) > STILL {
        return;
    }
    let on_screen =
        |end: Entity, anchor: Vec3| pointer.project(globals.get(end).ok()?.transform_point(anchor));
    let distance = |element: EntityRef| {
        let now = Snapshot::read(element)?;
        let [a, b] = now.part.ends();
        let anchors = now.anchors.unwrap_or_default();
        let (a, b) = (on_screen(a, anchors.a)?, on_screen(b, anchors.b)?);
        Some((element.id(), to_segment(at, a, b)))
    };
    let nearest = elements
        .iter()
        .filter_map(distance)
        .filter(|(_, distance)| *distance < NEAR)
        .min_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((entity, _)) = nearest {
        commands.queue(move |world: &mut World| {
            world.resource_mut::<Bench>().picked = Some(entity);
        });
    }
}

/// Returns the distance from a point to the line segment from `a` to `b`.
fn to_segment(point: Vec2, a: Vec2, b: Vec2) -> f32 {
    let along = b - a;
    let share = (point - a).dot(along) / along.length_squared();
    // An element seen along its line is a single point on the screen.
    let share = if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(a + share * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_to_a_piece_of_a_line() {
        let (a, b) = (Vec2::ZERO, Vec2::new(10.0, 0.0));
        assert_eq!(to_segment(Vec2::new(5.0, 3.0), a, b), 3.0);
        assert_eq!(to_segment(Vec2::new(-4.0, 3.0), a, b), 5.0);
        assert_eq!(to_segment(Vec2::new(3.0, 4.0), a, a), 5.0);
    }
}
