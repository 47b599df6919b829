//! A simulated user, who sees texts in a window and has mouse and keyboard.

use crate::prelude::*;
use crate::workbench::{CoiloverWorkbench, CoiloverWorkbenchPlugin};
use bevy::asset::AssetPlugin;
use bevy::camera::RenderTargetInfo;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::input::mouse::MouseButtonInput;
use bevy::input::{ButtonState, InputPlugin};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, PrimaryWindow, WindowEvent};
use bevy_egui::egui::{self, Shape};
use bevy_egui::{EguiFullOutput, EguiPostUpdateSet};
use bevy_rapier3d::prelude::*;

const SIZE: UVec2 = UVec2::new(1280, 1200);
pub const EYE: Vec3 = Vec3::new(0.0, 1.0, 8.0);

/// Texts on the screen and their places.
#[derive(Resource, Default)]
struct Seen(Vec<(String, egui::Rect)>);

pub struct Person {
    pub app: App,
    window: Entity,
    /// The camera.
    pub eye: Entity,
    pub lamp: Entity,
    pub bell: Entity,
    pointer: Vec2,
}

/// Reads the texts that egui draws.
fn read(outputs: Query<&EguiFullOutput>, mut seen: ResMut<Seen>) {
    fn find(shape: &Shape, clip: egui::Rect, out: &mut Vec<(String, egui::Rect)>) {
        match shape {
            Shape::Text(text) => {
                let rect = text.visual_bounding_rect().intersect(clip);
                let text = text.galley.text();
                match out.last_mut() {
                    // A text that starts with a space is the unit of the number before it.
                    Some((number, place)) if text.starts_with(' ') => {
                        number.push_str(text);
                        *place = place.union(rect);
                    }
                    _ if rect.is_positive() => out.push((text.to_owned(), rect)),
                    _ => {}
                }
            }
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| find(shape, clip, out)),
            _ => {}
        }
    }
    seen.0.clear();
    for output in outputs.iter().filter_map(|output| output.0.as_ref()) {
        for shape in &output.shapes {
            find(&shape.shape, shape.clip_rect, &mut seen.0);
        }
    }
}

fn lens() -> Projection {
    Projection::Perspective(PerspectiveProjection {
        aspect_ratio: SIZE.x as f32 / SIZE.y as f32,
        ..default()
    })
}

/// Returns the position of a point of the world in the window, logical pixels.
pub fn project(at: Vec3, eye: Vec3) -> Vec2 {
    let to_clip = lens().get_clip_from_view();
    let clip = to_clip.project_point3(at - eye);
    Vec2::new(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y) * SIZE.as_vec2()
}

/// Spawns a camera.
pub fn spawn_eye(world: &mut World) -> Entity {
    let projection = lens();
    let mut camera = Camera::default();
    camera.computed.clip_from_view = projection.get_clip_from_view();
    camera.computed.target_info = Some(RenderTargetInfo {
        physical_size: SIZE,
        scale_factor: 1.0,
    });
    let place = Transform::from_translation(EYE);
    let eye = (Camera3d::default(), camera, projection, place);
    world.spawn(eye).id()
}

impl Person {
    /// Starts a game with a lamp and a bell on springs. The workbench is closed.
    pub fn new() -> Self {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            TransformPlugin,
            InputPlugin,
            WindowPlugin {
                primary_window: Some(Window {
                    resolution: (SIZE.x, SIZE.y).into(),
                    ..default()
                }),
                exit_condition: ExitCondition::DontExit,
                ..default()
            },
            AssetPlugin::default(),
        ))
        .init_asset::<Image>()
        .init_asset::<bevy::shader::Shader>()
        .add_plugins((
            CoiloverPlugin::at_hz(60.0),
            RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule(),
            CoiloverWorkbenchPlugin,
        ))
        .init_resource::<Seen>()
        .add_systems(
            PostUpdate,
            read.after(EguiPostUpdateSet::EndPass)
                .before(EguiPostUpdateSet::ProcessOutput),
        );
        let tick = app.world().resource::<Time<Fixed>>().timestep();
        app.insert_resource(TimeUpdateStrategy::ManualDuration(tick));

        let eye = spawn_eye(app.world_mut());
        let mut windows = app
            .world_mut()
            .query_filtered::<Entity, With<PrimaryWindow>>();
        let window = windows.single(app.world()).expect("a window");
        app.finish();
        app.cleanup();
        let mut person = Self {
            app,
            window,
            eye,
            lamp: window,
            bell: window,
            pointer: Vec2::ZERO,
        };
        person.lamp = person.hang("Lamp", 0.0, 80.0);
        person.bell = person.hang("Bell", 1.0, 500.0);
        person
    }

    /// Spawns a body of 2 kg on a spring, 1 m below a hook at the given `x` (m). Returns the spring.
    pub fn hang(&mut self, name: &'static str, x: f32, stiffness: f32) -> Entity {
        let world = self.app.world_mut();
        let hook = (
            Name::new("Hook"),
            RigidBody::Fixed,
            Transform::from_xyz(x, 2.0, 0.0),
        );
        let hook = world.spawn(hook).id();
        let body = world
            .spawn((
                Name::new(name),
                RigidBody::Dynamic,
                AdditionalMassProperties::Mass(2.0),
                Transform::from_xyz(x, 1.0, 0.0),
            ))
            .id();
        let spring = SpringDamper::new(hook, body)
            .with_stiffness(stiffness)
            .with_damping(1.5);
        let name = Name::new(format!("{name} spring"));
        world.spawn((name, spring)).id()
    }

    /// Starts the game with the workbench open.
    pub fn at_the_bench() -> Self {
        let mut person = Self::new();
        person
            .app
            .world_mut()
            .resource_mut::<CoiloverWorkbench>()
            .open = true;
        person.run(4);
        person
    }

    pub fn lamp(&self) -> SpringDamper {
        *self.app.world().get(self.lamp).expect("an element")
    }

    pub fn run(&mut self, frames: u32) {
        for _ in 0..frames {
            self.app.update();
        }
    }

    pub fn look(&mut self) {
        self.run(2);
    }

    pub fn texts(&self) -> Vec<&str> {
        let seen = &self.app.world().resource::<Seen>().0;
        seen.iter().map(|(text, _)| text.as_str()).collect()
    }

    pub fn sees(&self, text: &str) -> bool {
        self.texts().iter().any(|seen| seen.contains(text))
    }

    pub fn place(&self, text: &str) -> Option<Vec2> {
        let seen = &self.app.world().resource::<Seen>().0;
        let exactly = seen.iter().find(|(seen, _)| seen == text);
        let about = || seen.iter().find(|(seen, _)| seen.contains(text));
        let (_, rect) = exactly.or_else(about)?;
        let center = rect.center();
        Some(Vec2::new(center.x, center.y))
    }

    fn find(&self, text: &str) -> Vec2 {
        self.place(text)
            .unwrap_or_else(|| panic!("nobody sees {text:?} among {:?}", self.texts()))
    }

    fn point_at(&mut self, at: Vec2) {
        let delta = Some(at - self.pointer);
        self.pointer = at;
        let window = self.window;
        let mut entity = self.app.world_mut().entity_mut(window);
        if let Some(mut window) = entity.get_mut::<Window>() {
            window.set_cursor_position(Some(at));
        }
        let moved = CursorMoved {
            window,
            position: at,
            delta,
        };
        self.app.world_mut().write_message(moved.clone());
        self.app
            .world_mut()
            .write_message(WindowEvent::CursorMoved(moved));
        self.run(1);
    }

    fn button(&mut self, state: ButtonState) {
        let input = MouseButtonInput {
            button: MouseButton::Left,
            state,
            window: self.window,
        };
        self.app.world_mut().write_message(input);
        self.app
            .world_mut()
            .write_message(WindowEvent::MouseButtonInput(input));
        self.run(1);
    }

    /// Drags from one position to another in ten steps, and holds the button for `wait` more frames.
    pub fn drag_between(&mut self, from: Vec2, to: Vec2, wait: u32) {
        self.press_at(from);
        self.move_to(to);
        self.run(wait);
        self.let_go();
    }

    /// Presses the mouse button at a position.
    pub fn press_at(&mut self, at: Vec2) {
        self.point_at(at);
        self.button(ButtonState::Pressed);
    }

    /// Moves the pointer to a position in ten steps.
    pub fn move_to(&mut self, to: Vec2) {
        let from = self.pointer;
        for i in 1..=10 {
            self.point_at(from.lerp(to, 0.1 * i as f32));
        }
    }

    /// Releases the mouse button.
    pub fn let_go(&mut self) {
        self.button(ButtonState::Released);
        self.run(3);
    }

    /// Presses or releases a key.
    pub fn hold(&mut self, key_code: KeyCode, state: ButtonState) {
        self.app.world_mut().write_message(KeyboardInput {
            key_code,
            logical_key: Key::Shift,
            state,
            text: None,
            repeat: false,
            window: self.window,
        });
        self.run(1);
    }

    pub fn click_at(&mut self, at: Vec2) {
        self.point_at(at);
        self.button(ButtonState::Pressed);
        self.button(ButtonState::Released);
        self.run(3);
    }

    pub fn click(&mut self, text: &str) {
        self.click_at(self.find(text));
    }

    /// Clicks the text that was drawn last among several equal texts: a menu covers the texts behind it.
    pub fn click_last(&mut self, text: &str) {
        let seen = &self.app.world().resource::<Seen>().0;
        let last = seen.iter().rfind(|(seen, _)| seen == text);
        let at = last.map(|(_, rect)| rect.center()).expect(text);
        self.click_at(Vec2::new(at.x, at.y));
    }

    /// Drags a text to the right by a number of pixels.
    pub fn drag(&mut self, text: &str, pixels: f32) {
        let from = self.find(text);
        self.drag_between(from, from + pixels * Vec2::X, 0);
    }

    fn press(&mut self, key_code: KeyCode, logical_key: Key, text: Option<&str>) {
        for state in [ButtonState::Pressed, ButtonState::Released] {
            let input = KeyboardInput {
                key_code,
                logical_key: logical_key.clone(),
                state,
                text: text.map(Into::into),
                repeat: false,
                window: self.window,
            };
            self.app.world_mut().write_message(input.clone());
            self.app
                .world_mut()
                .write_message(WindowEvent::KeyboardInput(input));
            self.run(1);
        }
        self.run(2);
    }

    pub fn key(&mut self, key: KeyCode) {
        let logical = match key {
            KeyCode::F9 => Key::F9,
            KeyCode::Enter => Key::Enter,
            KeyCode::ArrowDown => Key::ArrowDown,
            other => panic!("no such key: {other:?}"),
        };
        self.press(key, logical, None);
    }

    /// Clicks a number, types another one, and waits until it acts.
    pub fn enter(&mut self, number: &str, text: &str) {
        self.click(number);
        self.type_text(text);
        self.key(KeyCode::Enter);
        self.run(2);
    }

    pub fn type_text(&mut self, text: &str) {
        for letter in text.chars() {
            let letter = letter.to_string();
            self.press(
                KeyCode::F24,
                Key::Character(letter.as_str().into()),
                Some(&letter),
            );
        }
    }
}
