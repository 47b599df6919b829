//! Tests of what an edit changes: what a user has edited, and nothing else.

use super::person::{EYE, Person, project};
use crate::prelude::*;
use crate::workbench::CoiloverWorkbench;
use crate::workbench::bench::Bench;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

fn edits(person: &Person) -> [Option<&'static str>; 2] {
    person.app.world().resource::<Bench>().history.next()
}

/// Changes the lamp's spring as the game would.
fn change(person: &mut Person, change: impl FnOnce(&mut SpringDamper)) {
    let lamp = person.lamp;
    let world = person.app.world_mut();
    let mut spring = world.get_mut::<SpringDamper>(lamp).expect("an element");
    change(&mut spring);
}

#[test]
fn what_the_game_changes_during_a_drag_is_not_undone_with_it() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let from = person.place("80 N/m").expect("a number");
    person.press_at(from);
    person.move_to(from + 40.0 * Vec2::X);
    person.run(2);
    let before = person.lamp().stiffness;
    change(&mut person, |lamp| lamp.damping = 9.0);
    let lamp = person.lamp;
    person.app.world_mut().entity_mut(lamp).insert(Preload(3.0));
    person.run(2);
    person.move_to(from + 80.0 * Vec2::X);
    person.let_go();
    let dragged = person.lamp().stiffness;
    assert!(dragged > before && before > 80.0, "{before}, {dragged} N/m");
    person.click("Undo");
    person.run(2);
    let preload = |person: &Person| person.app.world().get::<Preload>(lamp).copied();
    assert_eq!(edits(&person), [None, Some("a number")]);
    assert_eq!(
        (person.lamp().stiffness, person.lamp().damping),
        (80.0, 9.0)
    );
    assert_eq!(preload(&person), Some(Preload(3.0)));
    person.click("Redo");
    person.run(2);
    assert_eq!(
        (person.lamp().stiffness, person.lamp().damping),
        (dragged, 9.0)
    );
    assert_eq!(preload(&person), Some(Preload(3.0)));
}

#[test]
fn a_number_that_is_clicked_but_not_typed_stays_as_it_is() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    // More digits than the panel shows, or outside what can be typed.
    for (number, shown) in [(100.0 / 3.0, "33.3333 N/m"), (-5.0, "-5 N/m")] {
        change(&mut person, |lamp| lamp.stiffness = number);
        person.run(5);
        person.click(shown);
        person.key(KeyCode::Enter);
        person.run(2);
        assert_eq!(person.lamp().stiffness, number);
        // A click elsewhere ends the input too.
        person.click(shown);
        person.click("1.5 N s/m");
        person.key(KeyCode::Enter);
        person.run(2);
        assert_eq!(person.lamp().stiffness, number);
    }
    change(&mut person, |lamp| lamp.stiffness = 100.0 / 3.0);
    person.run(5);
    let texts = person.texts();
    let frequency = texts.into_iter().find(|text| text.ends_with(" Hz"));
    let frequency = frequency.expect("a number").to_owned();
    person.click(&frequency);
    person.key(KeyCode::Enter);
    person.run(2);
    assert_eq!(person.lamp().stiffness, 100.0 / 3.0);
    assert_eq!(edits(&person), [None, None]);
    // What is typed is read, also if it is nearly the same.
    person.enter("33.3333 N/m", "33.33");
    assert_eq!(person.lamp().stiffness, 33.33);
    assert_eq!(edits(&person), [Some("a number"), None]);
}

#[test]
fn a_preset_that_a_person_renamed_is_loaded_by_its_new_name() {
    let mut person = Person::at_the_bench();
    let folder = format!("coilover_renamed_{}", std::process::id());
    let folder = std::env::temp_dir().join(folder);
    let mut settings = person.app.world_mut().resource_mut::<CoiloverWorkbench>();
    settings.folder = folder.clone();
    person.click("Lamp spring");
    person.click("preset name");
    person.type_text("soft");
    person.click("Save");
    let [old, new] = ["soft", "my soft 1.2"].map(|name| {
        let file = format!("{name}.json");
        folder.join("presets").join(file)
    });
    assert!(std::fs::rename(old, new).is_ok());
    // The list of presets is read after a command.
    person.click("Pause");
    person.click("Run");
    person.click("Bell spring");
    person.run(2);
    person.click("Load");
    person.click_last("my soft 1.2");
    person.run(3);
    let bell = person.app.world().get::<SpringDamper>(person.bell);
    let stiffness = bell.map(|bell| bell.stiffness);
    assert_eq!(stiffness, Some(80.0), "{:?}", person.texts());
    assert!(std::fs::remove_dir_all(folder).is_ok());
}

/// Makes the numbers of the bell's spring the same as the lamp's, so that both panels look alike.
fn make_alike(person: &mut Person) {
    let (lamp, bell) = (person.lamp(), person.bell);
    let mut spring = person.app.world_mut().get_mut::<SpringDamper>(bell);
    let spring = spring.as_mut().expect("an element");
    (spring.stiffness, spring.rest_length) = (lamp.stiffness, lamp.rest_length);
    person.run(2);
}

fn stiffness(person: &Person, element: Entity) -> f32 {
    let spring = person.app.world().get::<SpringDamper>(element);
    spring.expect("an element").stiffness
}

#[test]
fn what_is_typed_counts_for_its_element_though_another_one_is_clicked_then() {
    for in_the_list in [true, false] {
        let mut person = Person::at_the_bench();
        make_alike(&mut person);
        person.click("Lamp spring");
        person.click("80 N/m");
        person.type_text("90");
        if in_the_list {
            person.click("Bell spring");
        } else {
            person.click_at(project(Vec3::new(1.0, 1.5, 0.0), EYE));
        }
        person.run(3);
        let selected = person.app.world().resource::<CoiloverWorkbench>().selected;
        assert_eq!(selected, Some(person.bell));
        let both = [person.lamp, person.bell].map(|element| stiffness(&person, element));
        assert_eq!(both, [90.0, 80.0], "in the list: {in_the_list}");
    }
}

#[test]
fn two_numbers_typed_one_after_the_other_are_two_edits() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.click("80 N/m");
    person.type_text("90");
    person.enter("1.5 N s/m", "2");
    let numbers = |person: &Person| (person.lamp().stiffness, person.lamp().damping);
    assert_eq!(numbers(&person), (90.0, 2.0));
    person.click("Undo");
    person.run(2);
    assert_eq!(numbers(&person), (90.0, 1.5));
    person.click("Undo");
    person.run(2);
    assert_eq!(numbers(&person), (80.0, 1.5));
}

#[test]
fn undo_while_a_number_is_typed_takes_that_number_back() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.enter("1.5 N s/m", "2");
    person.click("80 N/m");
    person.type_text("90");
    person.click("Undo");
    person.run(2);
    assert_eq!(
        (person.lamp().stiffness, person.lamp().damping),
        (80.0, 2.0)
    );
    assert_eq!(edits(&person), [Some("a number"), Some("a number")]);
    assert!(person.sees("Lamp spring: a number is as before"));
}

#[test]
fn reset_takes_back_edits_and_not_what_the_game_has_changed() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.click("80 N/m");
    person.type_text("90");
    person.key(KeyCode::Enter);
    let lamp = person.lamp;
    person.app.world_mut().entity_mut(lamp).insert(Preload(3.0));
    change(&mut person, |lamp| lamp.damping = 9.0);
    person.run(2);
    person.click("Reset");
    person.run(2);
    assert_eq!(
        (person.lamp().stiffness, person.lamp().damping),
        (80.0, 9.0)
    );
    assert_eq!(person.app.world().get(lamp), Some(&Preload(3.0)));
}

#[test]
fn an_arrow_key_does_not_make_a_number_negative_or_nan() {
    let mut person = Person::at_the_bench();
    change(&mut person, |lamp| lamp.damping = 0.0);
    person.click("Lamp spring");
    person.click("0 N s/m");
    person.key(KeyCode::ArrowDown);
    person.run(2);
    assert_eq!(person.lamp().damping, 0.0);
    person.click("breaks");
    person.run(2);
    person.click("inf m");
    person.key(KeyCode::ArrowDown);
    person.run(2);
    let breaks = person.app.world().get::<Breakable>(person.lamp);
    let breaks = breaks.map(|limit| limit.length);
    assert_eq!(breaks, Some(f32::INFINITY));
}

/// The lamp weighs a tonne, so its spring carries 10 kN.
#[test]
fn a_loaded_spring_may_break_without_breaking_at_once() {
    let mut person = Person::at_the_bench();
    let body = person.lamp().body_b;
    let heavy = AdditionalMassProperties::Mass(1_000.0);
    person.app.world_mut().entity_mut(body).insert(heavy);
    change(&mut person, |lamp| {
        (lamp.stiffness, lamp.damping) = (1e5, 1e4);
    });
    person.run(200);
    person.click("Lamp spring");
    person.click("breaks");
    person.click("force limit");
    person.run(30);
    assert!(person.app.world().get::<Breakable>(person.lamp).is_some());
    let readout = person.app.world().get::<SpringReadout>(person.lamp);
    let force = readout.expect("an element").force();
    assert!((force / 9_810.0 - 1.0).abs() < 0.01, "{force} N");
}

/// A body that swings on an anchor beside its centre. Its effective mass differs from tick to tick.
#[test]
fn a_frequency_is_typed_while_the_effective_mass_changes() {
    let mut person = Person::at_the_bench();
    let body = person.lamp().body_b;
    let mass = MassProperties {
        mass: 2.0,
        principal_inertia: Vec3::splat(0.1),
        ..default()
    };
    let (world, lamp) = (person.app.world_mut(), person.lamp);
    let turning = AdditionalMassProperties::MassProperties(mass);
    world.entity_mut(body).insert(turning);
    let beside = Anchors::new(Vec3::ZERO, Vec3::new(0.3, 0.2, 0.0));
    world.entity_mut(lamp).insert(beside);
    person.run(30);
    person.click("Lamp spring");
    let mass = |person: &Person| {
        let readout = person.app.world().get::<SpringReadout>(person.lamp);
        readout.expect("an element").effective_mass
    };
    let before = mass(&person);
    let texts = person.texts();
    let frequency = texts.into_iter().find(|text| text.ends_with(" Hz"));
    let frequency = frequency.expect("a number").to_owned();
    person.click(&frequency);
    person.type_text("2.5");
    assert!((mass(&person) / before - 1.0).abs() > 1e-3, "it swings");
    person.key(KeyCode::Enter);
    person.run(2);
    // k = m (2πf)², with some mass of these ticks.
    let stiffness = person.lamp().stiffness;
    let found = stiffness / (std::f32::consts::TAU * 2.5).powi(2);
    assert!(
        found > 0.1 && found <= 2.0 && stiffness != 80.0,
        "{found} kg"
    );
    assert_eq!(edits(&person), [Some("a number"), None]);
}
