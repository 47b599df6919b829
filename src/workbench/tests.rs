//! Tests of the workbench through its user interface: a game without a renderer gets window events.

mod edits;
mod in_the_scene;
mod person;
mod tuning;
mod what_is_told;

use super::CoiloverWorkbench;
use super::bench::{Bench, Plots};
use super::model::record::Quantity;
use crate::prelude::*;
use bevy::prelude::*;
use person::Person;

#[test]
fn it_opens_with_its_key_and_closes_again() {
    let mut person = Person::new();
    person.look();
    assert!(!person.sees("Sort by"));
    person.key(KeyCode::F9);
    assert!(person.sees("Sort by") && person.sees("Lamp spring"));
    person.key(KeyCode::F9);
    assert!(!person.sees("Sort by"));
}

#[test]
fn an_element_is_chosen_in_the_list_and_its_numbers_are_shown() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    assert!(person.sees("80 N/m") && person.sees("1.5 N s/m"));
    // The verdict, the ends and the derived figures.
    assert!(person.sees("Alone on its ends"));
    assert!(person.sees("A: Hook (fixed)") && person.sees("B: Lamp (dynamic)"));
    // √(80/2)/2π.
    assert!(person.sees("1.00658 Hz"), "{:?}", person.texts());
}

#[test]
fn a_number_is_dragged_and_the_drag_undone() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.drag("80 N/m", 100.0);
    person.run(5);
    let stiffness = person.lamp().stiffness;
    // The number grows by 1 % per pixel, compounded. The first few pixels only start the drag.
    assert!(stiffness > 150.0 && stiffness < 300.0, "{stiffness} N/m");
    assert!(!person.sees("80 N/m"));
    person.click("Undo");
    person.run(2);
    assert_eq!(person.lamp().stiffness, 80.0);
    assert!(person.sees("80 N/m"));
    person.click("Redo");
    person.run(2);
    assert_eq!(person.lamp().stiffness, stiffness);
    person.click("Reset");
    person.run(2);
    assert_eq!(person.lamp().stiffness, 80.0);
}

#[test]
fn a_companion_is_added_and_taken_away_by_undo() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.click("preload");
    person.run(2);
    let entity = person.lamp;
    assert_eq!(
        person.app.world().get::<Preload>(entity),
        Some(&Preload(0.0))
    );
    person.click("Undo");
    person.run(2);
    assert_eq!(person.app.world().get::<Preload>(entity), None);
}

#[test]
fn the_plots_have_what_happened() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.run(120);
    let bench = person.app.world().resource::<Bench>();
    let curve = bench.record.curve(Quantity::Length, 400);
    assert!(curve.len() >= 120);
    let readout = *person
        .app
        .world()
        .get::<SpringReadout>(person.lamp)
        .expect("an element");
    let last = curve.last().expect("a point")[1];
    assert_eq!(last, f64::from(readout.length));
    let [low, high] = curve.iter().fold([9.0_f64, 0.0], |[low, high], point| {
        [low.min(point[1]), high.max(point[1])]
    });
    // The lamp falls by twice its sag.
    assert!(high - low > 0.3, "{low} to {high} m");
    assert!(person.sees("length, m") && person.sees("energy, J"));
    // The curve of the law is Hooke's law.
    let bench = person.app.world().resource::<Bench>();
    let subject = bench.subject.as_ref().expect("chosen");
    let curve = subject.facts.curve.as_ref().expect("a law");
    assert!(
        (curve.spring(f64::from(readout.length)) - f64::from(readout.spring_force)).abs() < 1e-3
    );
    person.click("Force laws");
    assert_eq!(person.app.world().resource::<Bench>().plots, Plots::Law);
    assert!(person.sees("law"), "{:?}", person.texts());
}

#[test]
fn the_game_is_paused_and_stepped() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.click("Pause");
    person.run(3);
    let ticks = |person: &Person| {
        let bench = person.app.world().resource::<Bench>();
        bench.record.iter().count()
    };
    let before = ticks(&person);
    person.run(20);
    assert_eq!(ticks(&person), before);
    person.click("Step");
    person.run(20);
    assert_eq!(ticks(&person), before + 1);
    person.click("Run");
    person.run(20);
    assert!(ticks(&person) > before + 10);
}

#[test]
fn the_list_is_searched() {
    let mut person = Person::at_the_bench();
    assert!(person.sees("Bell spring"));
    person.click("Search 2 elements");
    person.type_text("LAMP");
    person.run(2);
    assert!(person.sees("Lamp spring") && !person.sees("Bell spring"));
}

#[test]
fn a_coil_is_clicked_in_the_scene() {
    let mut person = Person::at_the_bench();
    // Half-way between hook and lamp, which are in the middle of the window.
    let hook = person::project(Vec3::new(0.0, 1.5, 0.0), person::EYE);
    person.click_at(hook);
    assert_eq!(
        person.app.world().resource::<CoiloverWorkbench>().selected,
        Some(person.lamp)
    );
    assert!(person.sees("80 N/m"));
}

#[test]
fn the_record_is_scrubbed() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.run(300);
    person.click("Pause");
    assert!(!person.sees("Now"));
    person.drag("0.00 s", -60.0);
    let bench = person.app.world().resource::<Bench>();
    let time = bench.scrub.expect("a time of the past");
    let sample = bench.sample().expect("a sample");
    assert!((sample.time - time).abs() < 0.02);
    let [_, last] = bench.record.span().expect("samples");
    assert!(time < last - 0.1, "{time} s of {last} s");
    person.click("Now");
    assert_eq!(person.app.world().resource::<Bench>().scrub, None);
}

#[test]
fn what_is_chosen_and_despawned_is_gone() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.drag("80 N/m", 30.0);
    let lamp = person.lamp;
    person.app.world_mut().entity_mut(lamp).despawn();
    person.run(30);
    assert!(person.sees("the element is gone") && !person.sees("Lamp spring"));
    person.click("Undo");
    person.run(3);
}

#[test]
fn a_preset_is_saved_and_loaded() {
    let mut person = Person::at_the_bench();
    let folder = std::env::temp_dir().join(format!("coilover_workbench_{}", std::process::id()));
    person
        .app
        .world_mut()
        .resource_mut::<CoiloverWorkbench>()
        .folder = folder.clone();
    person.click("Lamp spring");
    person.click("preset name");
    person.type_text("soft");
    person.click("Save");
    assert!(person.sees("saved"), "{:?}", person.texts());
    person.click("Bell spring");
    person.run(2);
    person.click("Load");
    person.click_last("soft");
    person.run(3);
    let bell = person
        .app
        .world()
        .get::<SpringDamper>(person.bell)
        .expect("an element");
    assert_eq!((bell.stiffness, bell.damping), (80.0, 1.5));
    // A name that ends with `.ron` saves the preset as RON.
    let behind = person.place("soft").expect("the name") + 50.0 * Vec2::X;
    person.click_at(behind);
    person.type_text(".ron");
    person.click("Save");
    let text = std::fs::read_to_string(folder.join("presets/soft.ron")).expect("a file");
    assert!(text.contains("stiffness: 80.0,"), "{text}");
    person.drag("80 N/m", 50.0);
    person.click("Load");
    person.click_last("soft.ron");
    person.run(3);
    let bell = *person
        .app
        .world()
        .get::<SpringDamper>(person.bell)
        .expect("an element");
    assert_eq!((bell.stiffness, bell.damping), (80.0, 1.5));
    assert!(std::fs::remove_dir_all(folder).is_ok());
}

#[test]
fn an_element_is_copied_and_pasted() {
    for format in ["JSON", "RON"] {
        let mut person = Person::at_the_bench();
        person.click("Lamp spring");
        person.click("preload");
        person.run(2);
        person.click(format);
        assert!(
            person.sees(&format!("copied as {format}")),
            "{:?}",
            person.texts()
        );
        person.click("Bell spring");
        person.run(2);
        person.click("Paste");
        person.run(3);
        assert!(person.sees("loaded what was copied"));
        let world = person.app.world();
        let [lamp, bell] = [person.lamp, person.bell].map(|element| {
            let pair = *world.get::<SpringDamper>(element).expect("an element");
            let numbers = (pair.stiffness, pair.damping, pair.rest_length);
            (numbers, world.get::<Preload>(element).copied())
        });
        assert_eq!(lamp, bell);
        assert_eq!(lamp.1, Some(Preload(0.0)));
        person.click("Undo");
        person.run(2);
        let world = person.app.world();
        let bell = world.get::<SpringDamper>(person.bell).expect("an element");
        assert_eq!(bell.stiffness, 500.0);
        assert_eq!(world.get::<Preload>(person.bell), None);
    }
}

#[test]
fn what_is_no_preset_is_told_when_it_is_pasted() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.click("Paste");
    assert!(person.sees("nothing to paste"), "{:?}", person.texts());
    person.click("Rust");
    person.click("Paste");
    person.run(3);
    assert!(person.sees("neither JSON nor RON"));
    assert_eq!(person.lamp().stiffness, 80.0);
}

/// The camera of a menu, which is despawned when the level starts.
#[test]
fn it_opens_on_another_camera_when_the_first_one_is_gone() {
    let mut person = Person::new();
    person.look();
    let eye = person.eye;
    person.app.world_mut().despawn(eye);
    person.look();
    person.eye = person::spawn_eye(person.app.world_mut());
    person.look();
    person.key(KeyCode::F9);
    person.look();
    assert!(person.sees("Sort by"));
}

#[test]
fn nothing_is_read_while_it_is_closed() {
    let mut person = Person::new();
    person.run(10);
    let bench = person.app.world().resource::<Bench>();
    assert_eq!(bench.rows.total(), 0);
    assert!(bench.subject.is_none() && bench.record.span().is_none());
}
