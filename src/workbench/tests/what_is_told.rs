//! Tests of what the panel says about unusual elements: NaN, torsion, other Rapier contexts, disabled elements.

use super::person::Person;
use crate::prelude::*;
use crate::workbench::CoiloverWorkbench;
use crate::workbench::bench::Bench;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;

fn edits(person: &Person) -> [Option<&'static str>; 2] {
    person.app.world().resource::<Bench>().history.next()
}

#[test]
fn a_nan_of_the_games_is_no_edit_and_can_be_typed_over() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    person.drag("80 N/m", 30.0);
    person.click("Undo");
    person.run(3);
    let lamp = person.lamp;
    let world = person.app.world_mut();
    let mut spring = world.get_mut::<SpringDamper>(lamp).expect("an element");
    spring.stiffness = f32::NAN;
    person.run(5);
    assert!(person.sees("SpringDamper::stiffness is NaN"));
    // The undone edit can still be redone.
    assert_eq!(edits(&person), [None, Some("a number")]);
    person.enter("NaN N/m", "90");
    assert_eq!(person.lamp().stiffness, 90.0);
    assert_eq!(edits(&person), [Some("a number"), None]);
}

/// Spawns a wheel on a torsion bar with a rest angle of -2 rad, and chooses the bar.
fn bar(person: &mut Person) -> Entity {
    let world = person.app.world_mut();
    let at = Transform::from_xyz(-1.0, 1.0, 0.0);
    let wall = world.spawn((Name::new("Wall"), RigidBody::Fixed, at)).id();
    let mass = MassProperties {
        mass: 1.0,
        principal_inertia: Vec3::splat(0.5),
        ..default()
    };
    let wheel = (
        Name::new("Wheel"),
        RigidBody::Dynamic,
        AdditionalMassProperties::MassProperties(mass),
        GravityScale(0.0),
        at,
    );
    let wheel = world.spawn(wheel).id();
    let bar = TorsionSpringDamper::new(wall, wheel, Vec3::Z)
        .with_stiffness(40.0)
        .with_damping(5.0)
        .with_rest_angle(-2.0);
    let bar = world.spawn((Name::new("Bar"), bar)).id();
    // The list is updated at most four times a second.
    person.run(30);
    person.click("Bar");
    bar
}

#[test]
fn laws_and_stops_of_a_torsion_element_have_its_units() {
    let mut person = Person::at_the_bench();
    let bar = bar(&mut person);
    let mut sees = |change: &dyn Fn(&mut EntityWorldMut), numbers: &[&str]| {
        let mut entity = person.app.world_mut().entity_mut(bar);
        entity.remove::<(SpringLaw, DampingLaw, SpringTravel)>();
        change(&mut entity);
        person.run(3);
        let texts = person.texts();
        for number in numbers {
            assert!(texts.contains(number), "{number}: {texts:?}");
        }
        for linear in ["N/m", "N s", "m/s", "1/m"] {
            assert!(!person.sees(linear), "{linear}: {texts:?}");
        }
    };
    sees(
        &|bar| {
            bar.insert(SpringLaw::polynomial(30.0, 3.0, 2.0));
        },
        &["30 N m/rad", "3 N m/rad²", "2 N m/rad³"],
    );
    sees(
        &|bar| {
            bar.insert(SpringLaw::table([(-7.0, -11.0), (7.0, 11.0)]));
        },
        &["-7 rad", "11 N m"],
    );
    sees(
        &|bar| {
            bar.insert(DampingLaw::sided(6.0, 7.0));
        },
        &["6 N m s/rad", "7 N m s/rad"],
    );
    sees(
        &|bar| {
            bar.insert(DampingLaw::Quadratic {
                linear: 6.0,
                quadratic: 7.0,
            });
        },
        &["6 N m s/rad", "7 N m s²/rad²"],
    );
    sees(
        &|bar| {
            bar.insert(DampingLaw::BlowOff {
                damping: 6.0,
                knee: 7.0,
                beyond: 1.0,
            });
        },
        &["6 N m s/rad", "7 rad/s", "1 N m s/rad"],
    );
    sees(
        &|bar| {
            let stops = SpringTravel::new(-9.0, 9.0, 60.0);
            bar.insert(stops.with_progression(7.0).with_stop_damping(8.0));
        },
        &["-9 rad", "9 rad", "60 N m/rad", "7 1/rad", "8 N m s/rad"],
    );
}

#[test]
fn stops_are_added_on_either_side_of_a_rest_angle_below_zero_and_dragged_further() {
    let mut person = Person::at_the_bench();
    let bar = bar(&mut person);
    person.click("stops");
    person.run(2);
    let stops = |person: &Person| {
        let stops = person.app.world().get::<SpringTravel>(bar);
        let stops = stops.expect("added");
        (stops.min_length, stops.max_length)
    };
    assert_eq!(stops(&person), (-3.0, -1.0));
    person.drag("-3 rad", -100.0);
    person.run(2);
    let (least, greatest) = stops(&person);
    assert!(least < -3.2 && greatest == -1.0, "{least} to {greatest}");
}

#[test]
fn the_table_of_a_torsion_element_has_angles_and_moments() {
    let mut person = Person::at_the_bench();
    let folder = std::env::temp_dir().join(format!("coilover_torsion_{}", std::process::id()));
    let mut settings = person.app.world_mut().resource_mut::<CoiloverWorkbench>();
    settings.folder = folder.clone();
    bar(&mut person);
    person.run(10);
    person.click("Save CSV");
    person.run(2);
    let table = std::fs::read_to_string(folder.join("Bar_1.csv")).expect("a file");
    assert!(
        table.starts_with("time_s,angle_rad,rate_rad_per_s,spring_moment_N_m,"),
        "{table}"
    );
    assert!(std::fs::remove_dir_all(folder).is_ok());
}

#[test]
fn a_sag_is_that_under_the_gravity_where_the_load_is() {
    let mut person = Person::at_the_bench();
    let world = person.app.world_mut();
    let engine = RapierConfiguration {
        gravity: 1.6 * Vec3::NEG_Y,
        ..RapierConfiguration::new(1.0)
    };
    let moon = world
        .spawn((RapierContextSimulation::default(), engine))
        .id();
    person.run(1);
    let probe = person.hang("Probe", -1.0, 80.0);
    let world = person.app.world_mut();
    let spring = *world.get::<SpringDamper>(probe).expect("an element");
    for end in [spring.body_a, spring.body_b] {
        world.entity_mut(end).insert(RapierContextEntityLink(moon));
    }
    person.run(30);
    person.click("Probe spring");
    // 2 · 1.6/80
    let texts = person.texts();
    assert!(texts.contains(&"0.04 m"), "{texts:?}");
    person.click("Lamp spring");
    person.run(2);
    // 2 · 9.81/80
    let texts = person.texts();
    assert!(texts.contains(&"0.24525 m"), "{texts:?}");
}

#[test]
fn a_disabled_element_is_told_to_be_disabled_and_keeps_its_name() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    assert!(person.sees("Alone on its ends"));
    let lamp = person.lamp;
    person.app.world_mut().entity_mut(lamp).insert(Disabled);
    person.run(30);
    assert!(person.sees("It is disabled"), "{:?}", person.texts());
    assert!(!person.sees("took no part") && !person.sees("Alone on its ends"));
    // A disabled element is not in the list, but the title still shows its name.
    assert!(person.sees("Lamp spring"));
    person.app.world_mut().entity_mut(lamp).remove::<Disabled>();
    person.run(30);
    assert!(person.sees("Alone on its ends") && !person.sees("It is disabled"));
}

#[test]
fn the_slope_of_an_axis_of_a_is_that_of_the_body_that_a_belongs_to() {
    let mut person = Person::at_the_bench();
    let (lamp, hook) = (person.lamp, person.lamp().body_a);
    let world = person.app.world_mut();
    let turned = Transform::from_rotation(Quat::from_rotation_z(1.0));
    let eye = world.spawn((turned, ChildOf(hook))).id();
    let mut spring = world.get_mut::<SpringDamper>(lamp).expect("an element");
    spring.body_a = eye;
    let down = SpringAxis::BodyA(Vec3::NEG_Y);
    world.entity_mut(lamp).insert(down);
    person.run(3);
    person.click("Lamp spring");
    assert!(person.sees("A: Hook (fixed)"), "{:?}", person.texts());
    let bench = person.app.world().resource::<Bench>();
    let slope = bench.subject.as_ref().expect("chosen").facts.slope;
    // The load hangs, as the physics sees it.
    let is_one = slope.is_some_and(|slope| (slope - 1.0).abs() < 1e-5);
    assert!(is_one, "{slope:?}");
}

#[test]
fn the_sag_is_that_of_a_body_with_its_gravity_scale() {
    let mut person = Person::at_the_bench();
    person.click("Lamp spring");
    let body = person.lamp().body_b;
    // 2 kg at 9.81 m/s² on 80 N/m, and twice that.
    for (scale, sag) in [(1.0, "0.24525 m"), (2.0, "0.4905 m")] {
        let scale = GravityScale(scale);
        person.app.world_mut().entity_mut(body).insert(scale);
        person.run(20);
        assert!(person.sees(sag), "{:?}", person.texts());
    }
    let none = GravityScale(0.0);
    person.app.world_mut().entity_mut(body).insert(none);
    person.run(20);
    assert!(!person.sees("sag"));
}
