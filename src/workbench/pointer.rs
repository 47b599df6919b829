//! The mouse in the scene: its position, and whether the panel uses it.
//!
//! egui draws the workbench around the middle of the window, in its background. It does not take the pointer for its own there
//! before a widget is pressed. So the workbench itself knows which part of the window it covers.

use bevy::ecs::system::SystemParam;
use bevy::input::mouse::{MouseButtonInput, MouseWheel};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::PrimaryEguiContext;
use bevy_egui::input::EguiWantsInput;

/// Greatest movement of the pointer during a click, pixels.
pub(super) const STILL: f32 = 4.0;

/// The part of the window that the workbench leaves free, logical pixels. `None` before it is drawn.
#[derive(Resource, Default, Debug)]
pub(super) struct Free(pub Option<Rect>);

/// Hides the mouse from the game while the pointer is over the workbench.
pub(super) fn absorb(
    free: Res<Free>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut buttons: ResMut<ButtonInput<MouseButton>>,
    mut pressed: ResMut<Messages<MouseButtonInput>>,
    mut turned: ResMut<Messages<MouseWheel>>,
) {
    let at = windows.iter().find_map(Window::cursor_position);
    if free.covers(at) {
        buttons.reset_all();
        pressed.clear();
        turned.clear();
    }
}

impl Free {
    /// Whether the workbench covers a position in the window.
    fn covers(&self, at: Option<Vec2>) -> bool {
        let covered = self.0.zip(at).map(|(free, at)| !free.contains(at));
        covered.unwrap_or(false)
    }
}

/// The pointer, and the camera of the workbench.
#[derive(SystemParam)]
pub(super) struct Pointer<'w, 's> {
    free: Res<'w, Free>,
    buttons: Res<'w, ButtonInput<MouseButton>>,
    keys: Res<'w, ButtonInput<KeyCode>>,
    egui: Option<Res<'w, EguiWantsInput>>,
    windows: Query<'w, 's, &'static Window, With<PrimaryWindow>>,
    cameras: Query<'w, 's, (&'static Camera, &'static GlobalTransform), With<PrimaryEguiContext>>,
}

impl Pointer<'_, '_> {
    /// Returns the position in the window, logical pixels.
    pub fn at(&self) -> Option<Vec2> {
        self.windows.single().ok()?.cursor_position()
    }

    /// Whether the panel uses the pointer, so that clicks and drags do not affect the scene.
    pub fn is_taken(&self) -> bool {
        let egui = self.egui.as_ref();
        self.free.covers(self.at()) || egui.is_some_and(|egui| egui.wants_any_pointer_input())
    }

    /// Returns the position if the left button was pressed over the scene in this frame.
    pub fn put_down(&self) -> Option<Vec2> {
        let down = self.buttons.just_pressed(MouseButton::Left);
        self.at().filter(|_| down && !self.is_taken())
    }

    /// Whether the left button is down.
    pub fn is_down(&self) -> bool {
        self.buttons.pressed(MouseButton::Left)
    }

    /// Whether the left button was released in this frame.
    pub fn is_let_go(&self) -> bool {
        self.buttons.just_released(MouseButton::Left)
    }

    /// Whether a key is down; `false` for no key.
    pub fn is_with(&self, key: Option<KeyCode>) -> bool {
        key.is_some_and(|key| self.keys.pressed(key))
    }

    /// Returns the position of a point of the world in the window, logical pixels.
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let (camera, eye) = self.cameras.iter().next()?;
        camera.world_to_viewport(eye, point).ok()
    }

    /// Returns the ray from the camera through a position in the window.
    pub fn ray(&self, at: Vec2) -> Option<Ray3d> {
        let (camera, eye) = self.cameras.iter().next()?;
        camera.viewport_to_world(eye, at).ok()
    }

    /// Projects a position in the window onto the plane through a point of the world that faces the camera.
    pub fn in_plane(&self, at: Vec2, through: Vec3) -> Option<Vec3> {
        let (_, eye) = self.cameras.iter().next()?;
        let plane = InfinitePlane3d::new(eye.forward());
        let ray = self.ray(at)?;
        let distance = ray.intersect_plane(through, plane)?;
        Some(ray.get_point(distance)).filter(|point| point.is_finite())
    }
}
