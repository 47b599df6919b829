//! Sample elements for tests, with every companion on some of them.

use super::preset;
use super::snapshot::{Part, Snapshot};
use crate::element::*;
use bevy::prelude::*;

fn ends() -> [Entity; 2] {
    [1, 2].map(|i| Entity::from_raw_u32(i).expect("a number of an entity"))
}

/// Returns the samples, each with the name of the function that spawns it.
pub(crate) fn samples() -> Vec<(&'static str, Snapshot)> {
    let [a, b] = ends();
    let plain = Snapshot::new(Part::SpringDamper(
        SpringDamper::new(a, b)
            .with_stiffness(29_430.0)
            .with_damping(1_783.5)
            .with_rest_length(0.3),
    ));
    let rope = Snapshot {
        anchors: Some(Anchors::new(Vec3::ZERO, Vec3::new(0.1, -0.25, 1e-7))),
        action: Some(SpringAction::Pull),
        breakable: Some(Breakable::at_force(900.0).disabling()),
        ..Snapshot::new(Part::Spring(Spring::new(a, b).with_stiffness(1e5)))
    };
    let progressive = Snapshot {
        spring_law: Some(SpringLaw::sided(
            Polynomial::new(10.0, 0.0, 3.0),
            Polynomial::new(1.0, 2.0, 0.5),
        )),
        damping_law: Some(DampingLaw::sided(500.0, 1500.0)),
        travel: Some(
            SpringTravel::new(0.1, f32::INFINITY, 1e6)
                .with_progression(2.0)
                .with_stop_damping(30.0),
        ),
        axis: Some(SpringAxis::BodyA(Vec3::Y)),
        preload: Some(Preload(-120.0)),
        max_force: Some(MaxForce(5_000.0)),
        breakable: Some(Breakable::at_length(2.0)),
        ..plain.clone()
    };
    let measured = Snapshot {
        spring_law: Some(SpringLaw::table([(-0.1, -5.0), (0.0, 0.0), (0.2, 30.0)])),
        damping_law: Some(DampingLaw::BlowOff {
            damping: 100.0,
            knee: 0.2,
            beyond: 10.0,
        }),
        axis: Some(SpringAxis::World(Vec3::new(1.0, 1.0, 0.0))),
        ..plain.clone()
    };
    let orifice = Snapshot {
        damping_law: Some(DampingLaw::Quadratic {
            linear: 1.0,
            quadratic: 20.0,
        }),
        ..Snapshot::new(Part::Damper(Damper::new(a, b).with_damping(3.0)))
    };
    let bar = Snapshot::new(Part::TorsionSpringDamper(
        TorsionSpringDamper::new(a, b, Vec3::Z)
            .with_stiffness(40.0)
            .with_damping(0.5)
            .with_rest_angle(-1.0),
    ));
    let clock = Snapshot::new(Part::TorsionSpring(
        TorsionSpring::new(a, b, Vec3::new(0.0, 0.6, 0.8)).with_stiffness(0.02),
    ));
    let brake = Snapshot {
        damping_law: Some(DampingLaw::table([(-1.0, -2.0), (0.0, 0.0), (1.0, 3.0)])),
        ..Snapshot::new(Part::TorsionDamper(TorsionDamper::new(a, b, Vec3::X)))
    };
    vec![
        ("spawn_plain", plain),
        ("spawn_rope", rope),
        ("spawn_progressive", progressive),
        ("spawn_measured", measured),
        ("spawn_orifice", orifice),
        ("spawn_bar", bar),
        ("spawn_clock", clock),
        ("spawn_brake", brake),
    ]
}

#[test]
fn a_preset_is_read_as_it_was_written() {
    for (name, sample) in samples() {
        for written in [preset::json, preset::ron] {
            let text = written(&sample).expect("a preset");
            let mut other = Snapshot::new(sample.part);
            other.preload = Some(Preload(1.0));
            if let Some(stiffness) = other.part.stiffness_mut() {
                *stiffness = 7.0;
            }
            if let Some(rest) = other.part.rest_mut() {
                *rest = Some(0.125);
            }
            let read = preset::apply(&text, &other);
            assert_eq!(read.as_ref(), Ok(&sample), "{name}: {text}");
        }
    }
}

#[test]
fn a_stop_at_the_longer_end_alone_is_read_as_it_was_written() {
    let (_, plain) = samples().remove(0);
    let slide = Snapshot {
        travel: Some(SpringTravel::new(f32::NEG_INFINITY, 0.2, 1e6)),
        axis: Some(SpringAxis::BodyA(Vec3::Y)),
        ..plain
    };
    for written in [preset::json, preset::ron] {
        let text = written(&slide).expect("a preset");
        let read = preset::apply(&text, &Snapshot::new(slide.part));
        assert_eq!(read.as_ref(), Ok(&slide), "{text}");
    }
}

/// Presets in RON are readable and look like a scene file.
#[test]
fn ron_is_as_in_a_scene_file() {
    let [a, b] = ends();
    let rope = Spring::new(a, b).with_stiffness(80.0).with_rest_length(1.5);
    let rope = Snapshot {
        anchors: Some(Anchors::new(Vec3::ZERO, Vec3::new(0.0, -0.25, 0.0))),
        breakable: Some(Breakable::at_length(2.0)),
        ..Snapshot::new(Part::Spring(rope))
    };
    let text = r#"{
    "bevy_coilover::Spring": (
        rest_length: Some(1.5),
        stiffness: 80.0,
    ),
    "bevy_coilover::Anchors": (
        a: (0.0, 0.0, 0.0),
        b: (0.0, -0.25, 0.0),
    ),
    "bevy_coilover::Breakable": (
        force: inf,
        length: 2.0,
        then: Despawn,
    ),
}"#;
    assert_eq!(preset::ron(&rope).as_deref(), Ok(text));
    // A scene file has the ends too, and may leave out numbers that stay.
    let scene = r#"{"bevy_coilover::Spring": (body_a: 4294967295, stiffness: 9, body_b: 1)}"#;
    let read = preset::apply(scene, &rope).expect("a preset");
    assert_eq!(read.part.stiffness(), Some(9.0));
    assert_eq!(read.part.rest(), Some(1.5));
    assert_eq!((read.part.ends(), read.breakable), ([a, b], None));
    let none = r#"{"bevy_coilover::Spring": (rest_length: None)}"#;
    let read = preset::apply(none, &rope).expect("a preset");
    assert_eq!(read.part.rest(), None);
}

#[test]
fn bad_presets_are_told() {
    let (_, plain) = samples().remove(0);
    let wrong = |text: &str| preset::apply(text, &plain).expect_err(text);
    assert!(wrong("{").contains("neither JSON nor RON"));
    assert!(wrong("").contains("neither JSON nor RON"));
    assert!(wrong("(((").contains("neither JSON nor RON"));
    assert!(wrong("5").contains("object"));
    // Very deep nesting must not overflow the stack.
    assert!(wrong(&"[".repeat(100_000)).contains("neither"));
    let of_ron = |rest: &str| format!(r#"{{"bevy_coilover::Spring": (stiffness: 1.0), {rest}}}"#);
    assert!(wrong(&of_ron(r#""bevy_coilover::Preload": ("much")"#)).contains("Preload"));
    assert!(wrong(&of_ron(r#""Name": ("Bob")"#)).contains("Name"));
    assert!(wrong(r#"{"bevy_coilover::Spring": (stiffness: inf)}"#).contains("stiffness"));
    assert!(
        wrong(r#"{"bevy_coilover::Spring": (rest_length: Some(NaN))}"#).contains("rest_length")
    );
    assert!(wrong(r#"{"bevy_coilover::TorsionSpring": ()}"#).contains("TorsionSpring"));
    assert!(wrong("[]").contains("object"));
    assert!(wrong("{}").contains("no spring"));
    assert!(wrong(r#"{"bevy_coilover::TorsionSpring": {}}"#).contains("TorsionSpring"));
    let spring =
        |rest: &str| format!(r#"{{"bevy_coilover::Spring": {{"stiffness": 1.0}}, {rest}}}"#);
    assert!(wrong(&spring(r#""bevy_coilover::Preload": "much""#)).contains("Preload"));
    assert!(
        wrong(&spring(
            r#""bevy_coilover::SpringTravel": {"min_length": 1}"#
        ))
        .contains("SpringTravel")
    );
    assert!(wrong(&spring(r#""Name": "Bob""#)).contains("Name"));
    let nan = r#"{"bevy_coilover::Spring": {"stiffness": 1e99}}"#;
    assert!(wrong(nan).contains("number"));
}

mod generated {
    include!("../../../tests/workbench/generated.rs");
}

/// The generated code equals the file that is compiled above, and spawns the samples that it was generated from.
/// `UPDATE_GENERATED=1` writes the file again.
#[test]
fn generated_code_compiles_and_spawns_the_same() {
    let mut text = String::from(
        "// Written by the workbench; compared and compiled by its tests.\nuse bevy::prelude::*;\nuse crate::prelude::*;\n",
    );
    for (name, sample) in samples() {
        text += "\n";
        text += &super::code::rust(&sample, name, &name.replace('_', " "));
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/workbench/generated.rs");
    if std::env::var_os("UPDATE_GENERATED").is_some() {
        std::fs::write(file, &text).expect("a file");
        return;
    }
    assert_eq!(std::fs::read_to_string(file).expect("a file"), text);
    let [a, b] = ends();
    let mut world = World::new();
    let mut commands = world.commands();
    let spawned = [
        generated::spawn_plain(&mut commands, a, b),
        generated::spawn_rope(&mut commands, a, b),
        generated::spawn_progressive(&mut commands, a, b),
        generated::spawn_measured(&mut commands, a, b),
        generated::spawn_orifice(&mut commands, a, b),
        generated::spawn_bar(&mut commands, a, b),
        generated::spawn_clock(&mut commands, a, b),
        generated::spawn_brake(&mut commands, a, b),
    ];
    world.flush();
    for (entity, (name, sample)) in spawned.into_iter().zip(samples()) {
        let read = Snapshot::read(world.entity(entity));
        assert_eq!(read, Some(sample), "{name}");
    }
}
