//! Tests of what an edit changes: what a user has edited, and nothing else.

use super::person::Person;
use crate::prelude::*;
use crate::workbench::CoiloverWorkbench;
use crate::workbench::bench::Bench;
use bevy::prelude::*;

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
    person.click("33.3333 N/m");
    person.type_text("33.33");
    person.key(KeyCode::Enter);
    person.run(2);
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
