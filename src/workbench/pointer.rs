//! The mouse over the scene: where it points, and whether it is the panel's.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use bevy_egui::PrimaryEguiContext;
use bevy_egui::input::EguiWantsInput;

/// Pixels by which a click may move.
pub(super) const STILL: f32 = 4.0;

/// The pointer, and the camera that it looks through.
#[derive(SystemParam)]
pub(super) struct Pointer<'w, 's> {
    buttons: Res<'w, ButtonInput<MouseButton>>,
    keys: Res<'w, ButtonInput<KeyCode>>,
    egui: Option<Res<'w, EguiWantsInput>>,
    windows: Query<'w, 's, &'static Window, With<PrimaryWindow>>,
    cameras: Query<'w, 's, (&'static Camera, &'static GlobalTransform), With<PrimaryEguiContext>>,
}

impl Pointer<'_, '_> {
    /// Where it is in the window, logical pixels.
    pub fn at(&self) -> Option<Vec2> {
        self.windows.single().ok()?.cursor_position()
    }

    /// The panel has it: what is done now is not done to the scene.
    pub fn is_taken(&self) -> bool {
        let egui = self.egui.as_ref();
        egui.is_some_and(|egui| egui.wants_any_pointer_input())
    }

    /// Where it was put down in the scene in this frame.
    pub fn put_down(&self) -> Option<Vec2> {
        let down = self.buttons.just_pressed(MouseButton::Left);
        self.at().filter(|_| down && !self.is_taken())
    }

    /// It is held down.
    pub fn is_down(&self) -> bool {
        self.buttons.pressed(MouseButton::Left)
    }

    /// It was let go in this frame.
    pub fn is_let_go(&self) -> bool {
        self.buttons.just_released(MouseButton::Left)
    }

    /// A key is held down.
    pub fn is_with(&self, key: Option<KeyCode>) -> bool {
        key.is_some_and(|key| self.keys.pressed(key))
    }

    /// Where a point of the world is in the window.
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let (camera, eye) = self.cameras.iter().next()?;
        camera.world_to_viewport(eye, point).ok()
    }

    /// What lies below a place in the window.
    pub fn ray(&self, at: Vec2) -> Option<Ray3d> {
        let (camera, eye) = self.cameras.iter().next()?;
        camera.viewport_to_world(eye, at).ok()
    }

    /// Where a place in the window is in the plane through a point that faces the camera.
    pub fn in_plane(&self, at: Vec2, through: Vec3) -> Option<Vec3> {
        let (_, eye) = self.cameras.iter().next()?;
        let plane = InfinitePlane3d::new(eye.forward());
        let ray = self.ray(at)?;
        let distance = ray.intersect_plane(through, plane)?;
        Some(ray.get_point(distance)).filter(|point| point.is_finite())
    }
}
