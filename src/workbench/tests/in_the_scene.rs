//! Tests of the user's actions in the scene: dragging anchors and pulling bodies.

use super::person::{EYE, Person, project};
use crate::prelude::*;
use crate::workbench::CoiloverWorkbench;
use bevy::input::ButtonState;
use bevy::input::mouse::MouseButtonInput;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

/// Returns end B of an element: the hanging body.
fn body(person: &Person, element: Entity) -> Entity {
    let world = person.app.world();
    let pair = world.get::<SpringDamper>(element);
    pair.expect("an element").body_b
}

fn place(person: &Person, entity: Entity) -> Vec3 {
    let frame = person.app.world().get::<GlobalTransform>(entity);
    frame.expect("a place").translation()
}

fn anchors(person: &Person, element: Entity) -> Option<Anchors> {
    person.app.world().get::<Anchors>(element).copied()
}

fn springs_of_a_hand(person: &mut Person) -> usize {
    let world = person.app.world_mut();
    world.query::<&MouseSpring>().iter(world).count()
}

/// Drags from one point of the world to another, in the plane of the springs.
fn drag(person: &mut Person, from: Vec3, to: Vec3, wait: u32) {
    person.drag_between(project(from, EYE), project(to, EYE), wait);
}

#[test]
fn an_anchor_is_dragged_and_the_drag_undone() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    assert!(person.sees("Drag a ball to move its anchor"));
    assert_eq!(anchors(&person, person.lamp), None);
    let hook = Vec3::new(0.0, 2.0, 0.0);
    let by = Vec3::new(-0.3, -0.2, 0.0);
    drag(&mut person, hook, hook + by, 0);
    let moved = anchors(&person, person.lamp).expect("they were inserted");
    assert!(
        (moved.a - by).length() < 2e-3 && moved.b == Vec3::ZERO,
        "{moved:?}"
    );
    // The drag is one edit. Undo removes the component again.
    person.click("Undo");
    person.run(2);
    assert_eq!(anchors(&person, person.lamp), None);
    person.click("Redo");
    person.run(2);
    assert_eq!(anchors(&person, person.lamp), Some(moved));
}

#[test]
fn two_drags_are_two_edits() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let [first, second] = [Vec3::new(0.2, 2.0, 0.0), Vec3::new(0.2, 2.3, 0.0)];
    drag(&mut person, Vec3::new(0.0, 2.0, 0.0), first, 0);
    let once = anchors(&person, person.lamp).expect("inserted");
    drag(&mut person, first, second, 0);
    let twice = anchors(&person, person.lamp).expect("there");
    assert!(
        (twice.a - Vec3::new(0.2, 0.3, 0.0)).length() < 3e-3,
        "{twice:?}"
    );
    person.click("Undo");
    person.run(2);
    assert_eq!(anchors(&person, person.lamp), Some(once));
}

#[test]
fn an_anchor_on_a_body_that_is_turned_is_dragged_while_paused() {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    // A quarter turn: X of the world is Y of the body.
    let turn = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
    let world = person.app.world_mut();
    let mut entity = world.entity_mut(lamp);
    *entity.get_mut::<Transform>().expect("a body") =
        Transform::from_xyz(0.0, 1.0, 0.0).with_rotation(turn);
    person.click("Lamp spring");
    person.click("Pause");
    person.run(3);
    let from = place(&person, lamp);
    drag(&mut person, from, from + 0.25 * Vec3::X, 0);
    // Like every edit, this one waits for a tick. The panel and the ball already show it.
    assert_eq!(anchors(&person, person.lamp), None);
    person.click("Step");
    person.run(3);
    let moved = anchors(&person, person.lamp).expect("inserted");
    assert!((moved.b - 0.25 * Vec3::Y).length() < 5e-3, "{moved:?}");
    assert_eq!(moved.a, Vec3::ZERO);
}

#[test]
fn an_anchor_on_a_body_that_swings_is_dragged() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let lamp = body(&person, person.lamp);
    let from = place(&person, lamp);
    drag(&mut person, from, from + 0.15 * Vec3::X, 0);
    let moved = anchors(&person, person.lamp).expect("inserted");
    // The anchor has moved as far as the pointer, wherever the lamp was meanwhile.
    assert!((moved.b - 0.15 * Vec3::X).length() < 0.02, "{moved:?}");
    let before = moved;
    // While the pointer stands still, the anchor does not move.
    let at = place(&person, lamp) + moved.b;
    drag(&mut person, at, at + 0.15 * Vec3::X, 40);
    let moved = anchors(&person, person.lamp).expect("there");
    assert!(
        (moved.b - before.b - 0.15 * Vec3::X).length() < 0.02,
        "{moved:?}"
    );
}

#[test]
fn the_anchor_of_an_end_that_is_no_body_is_dragged() {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    let world = person.app.world_mut();
    let nail = Transform::from_xyz(-0.5, 2.2, 0.0).with_scale(Vec3::splat(2.0));
    let nail = world.spawn((Name::new("Nail"), nail)).id();
    let pair = SpringDamper::new(nail, lamp).with_stiffness(10.0);
    let cord = world.spawn((Name::new("Cord"), pair)).id();
    person.run(30);
    person.click("Cord");
    assert!(person.sees("A: Nail (no body)"));
    let at = Vec3::new(-0.5, 2.2, 0.0);
    drag(&mut person, at, at + 0.2 * Vec3::Y, 0);
    // In the frame of the end, which is scaled by 2.
    let moved = anchors(&person, cord).expect("inserted");
    assert!((moved.a - 0.1 * Vec3::Y).length() < 3e-3, "{moved:?}");
}

#[test]
fn a_click_on_a_handle_moves_nothing() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let hook = project(Vec3::new(0.0, 2.0, 0.0), EYE);
    person.drag_between(hook, hook + 2.0 * Vec2::X, 0);
    assert_eq!(anchors(&person, person.lamp), None);
    let selected = person.app.world().resource::<CoiloverWorkbench>().selected;
    assert_eq!(selected, Some(person.lamp));
}

#[test]
fn an_end_without_extent_is_left_as_it_is() {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    let world = person.app.world_mut();
    let nail = Transform::from_xyz(-0.5, 2.2, 0.0).with_scale(Vec3::ZERO);
    let nail = world.spawn(nail).id();
    let cord = (Name::new("Cord"), SpringDamper::new(nail, lamp));
    let cord = world.spawn(cord).id();
    person.run(30);
    person.click("Cord");
    let at = Vec3::new(-0.5, 2.2, 0.0);
    drag(&mut person, at, at + Vec3::Y, 0);
    assert_eq!(anchors(&person, cord), None);
}

#[test]
fn a_body_is_pulled_with_the_mouse() {
    let mut person = Person::at_the_bench();
    assert!(person.sees("left Shift + drag pulls a body"));
    let (lamp, bell) = (body(&person, person.lamp), body(&person, person.bell));
    // The lamp gets a collider; the bell has none.
    let collider = (Collider::ball(0.2), ColliderMassProperties::Mass(0.1));
    person.app.world_mut().entity_mut(lamp).insert(collider);
    person.run(300);
    for (body, pull) in [
        (lamp, Vec3::new(-0.5, -0.3, 0.0)),
        (bell, 0.4 * Vec3::NEG_Y),
    ] {
        person.hold(KeyCode::ShiftLeft, ButtonState::Pressed);
        let before = place(&person, body);
        person.drag_between(project(before, EYE), project(before + pull, EYE), 0);
        let after = place(&person, body);
        let way = (after - before).dot(pull.normalize());
        assert!(way > 0.02, "it went {way} m");
        person.hold(KeyCode::ShiftLeft, ButtonState::Released);
        assert_eq!(springs_of_a_hand(&mut person), 0);
        person.run(30);
    }
    // Neither was an element chosen, nor anything edited.
    let selected = person.app.world().resource::<CoiloverWorkbench>().selected;
    assert_eq!(selected, None);
}

#[test]
fn what_is_pulled_comes_to_the_pointer() {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    person.hold(KeyCode::ShiftLeft, ButtonState::Pressed);
    let from = place(&person, lamp);
    let to = from + Vec3::new(-0.4, 0.0, 0.0);
    let [start, end] = [from, to].map(|at| project(at, EYE));
    person.press_at(start);
    person.move_to(end);
    person.run(180);
    assert_eq!(springs_of_a_hand(&mut person), 1);
    let there = place(&person, lamp);
    // The lamp's own spring, which is softer than the spring of the hand, and its weight still pull: centimetres
    // remain.
    assert!((there - to).length() < 0.2, "{there} for {to}");
    // Closing the workbench lets go.
    person.key(KeyCode::F9);
    person.run(2);
    assert_eq!(springs_of_a_hand(&mut person), 0);
}

#[test]
fn nothing_is_pulled_below_the_panel_or_without_the_key() {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    let from = place(&person, lamp);
    person.press_at(project(from, EYE));
    person.run(3);
    assert_eq!(springs_of_a_hand(&mut person), 0);
    person.let_go();
    person.hold(KeyCode::ShiftLeft, ButtonState::Pressed);
    // Without a key in the settings.
    let mut settings = person.app.world_mut().resource_mut::<CoiloverWorkbench>();
    settings.grab = None;
    person.press_at(project(place(&person, lamp), EYE));
    person.run(3);
    assert_eq!(springs_of_a_hand(&mut person), 0);
    assert!(!person.sees("pulls a body"));
}

/// A person who holds the lamp. Returns the lamp too.
fn holding_the_lamp() -> (Person, Entity) {
    let mut person = Person::at_the_bench();
    let lamp = body(&person, person.lamp);
    person.hold(KeyCode::ShiftLeft, ButtonState::Pressed);
    person.press_at(project(place(&person, lamp), EYE));
    person.run(5);
    assert_eq!(springs_of_a_hand(&mut person), 1);
    (person, lamp)
}

#[test]
fn a_body_that_is_gone_is_let_go() {
    let (mut person, lamp) = holding_the_lamp();
    person.app.world_mut().entity_mut(lamp).despawn();
    person.run(5);
    assert_eq!(springs_of_a_hand(&mut person), 0);
    person.let_go();
}

/// Spawns a hook, a body and a spring between them in the plane of the other springs. The body is seen at a place of the window.
fn behind(person: &mut Person, at: Vec2) -> Entity {
    // Pixels per metre, and the place of the origin in the window.
    let origin = project(Vec3::ZERO, EYE);
    let metre = project(Vec3::X, EYE).x - origin.x;
    let by = (at - origin) / metre;
    let place = Vec3::new(by.x, -by.y, 0.0);
    assert!((project(place, EYE) - at).length() < 0.1);
    let world = person.app.world_mut();
    let hook = world.spawn(Transform::from_translation(place + Vec3::X));
    let hook = hook.id();
    let body = (
        RigidBody::Dynamic,
        AdditionalMassProperties::Mass(2.0),
        GravityScale(0.0),
        Transform::from_translation(place),
    );
    let body = world.spawn(body).id();
    // Last in the list, so that the rows above it stay where they are.
    let name = Name::new("Zither string");
    world.spawn((name, SpringDamper::new(hook, body))).id()
}

/// What the game's own code sees of the mouse.
#[derive(Resource, Default, Debug, PartialEq)]
struct Game {
    presses: u32,
    messages: u32,
}

fn play(
    buttons: Res<ButtonInput<MouseButton>>,
    mut messages: MessageReader<MouseButtonInput>,
    mut game: ResMut<Game>,
) {
    game.presses += u32::from(buttons.just_pressed(MouseButton::Left));
    game.messages += messages.read().count() as u32;
}

/// Below the list's rows, on a row, and in the bar right of the buttons there is a body behind the panel.
#[test]
fn a_press_on_the_panel_reaches_neither_the_scene_nor_the_game() {
    let mut person = Person::at_the_bench();
    person.app.init_resource::<Game>().add_systems(Update, play);
    let row = person.place("Lamp spring").expect("in the list");
    for at in [
        row + 60.0 * Vec2::X,
        row + 300.0 * Vec2::Y,
        Vec2::new(620.0, 12.0),
    ] {
        let element = behind(&mut person, at);
        person.run(20);
        let before = person.app.world().resource::<CoiloverWorkbench>().selected;
        person.hold(KeyCode::ShiftLeft, ButtonState::Pressed);
        person.press_at(at);
        person.run(3);
        assert_eq!(springs_of_a_hand(&mut person), 0, "{at}");
        person.let_go();
        person.hold(KeyCode::ShiftLeft, ButtonState::Released);
        person.click_at(at + 8.0 * Vec2::X);
        let after = person.app.world().resource::<CoiloverWorkbench>().selected;
        assert!(
            after == before || after == Some(person.lamp),
            "{at}: {after:?}"
        );
        assert_ne!(after, Some(element), "{at}");
    }
    assert_eq!(*person.app.world().resource::<Game>(), Game::default());
    // In the scene, it sees them.
    person.click_at(project(Vec3::new(0.5, 0.2, 0.0), EYE));
    let seen = person.app.world().resource::<Game>();
    assert_eq!(
        *seen,
        Game {
            presses: 1,
            messages: 2
        }
    );
}

#[test]
fn a_drag_that_reaches_the_panel_ends_there() {
    let (mut person, _) = holding_the_lamp();
    let list = person.place("Lamp spring").expect("in the list");
    person.move_to(list);
    person.run(3);
    assert_eq!(springs_of_a_hand(&mut person), 0);
    person.let_go();
}
