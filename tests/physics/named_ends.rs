//! Do elements find their ends by name, and does a message say which name is wrong?

use crate::harness::*;
use crate::messages::Log;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

pub fn hook(name: &str) -> impl Bundle {
    (
        Name::new(name.to_owned()),
        Transform::from_xyz(0.0, 2.0, 0.0),
    )
}

pub fn weight(name: &str) -> impl Bundle {
    (Name::new(name.to_owned()), body(1.0, Vec3::ZERO))
}

pub fn spring(a: &str, b: &str) -> impl Bundle {
    (
        SpringDamper::default().with_stiffness(100.0),
        EndNames::new(a, b),
    )
}

pub fn ends(lab: &Lab, element: Entity) -> [Entity; 2] {
    let pair = lab.get::<SpringDamper>(element);
    [pair.body_a, pair.body_b]
}

pub fn fault(lab: &Lab, element: Entity) -> Option<String> {
    let fault = lab.app.world().get::<SpringFault>(element)?;
    Some(format!("{} {}", fault.field, fault.reason))
}

#[test]
fn a_spring_with_names_acts_from_the_first_step() {
    let mut lab = Lab::new();
    let element = lab.spawn(spring("Hook", "Weight"));
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Weight"));
    let twin = {
        let a = lab.point(Vec3::Y * 2.0);
        let b = lab.body(1.0, Vec3::ZERO);
        lab.spawn(SpringDamper::new(a, b).with_stiffness(100.0))
    };
    lab.tick();
    assert_eq!(ends(&lab, element), [a, b]);
    assert_eq!(fault(&lab, element), None);
    lab.run(0.5);
    let (named, given) = (lab.readout(element), lab.readout(twin));
    assert!(named.force() > 1.0, "{named:?}");
    assert_eq!(named, given);
}

#[test]
fn every_element_takes_names() {
    let mut lab = Lab::new();
    let a = lab.spawn(weight("A"));
    let b = lab.spawn((Name::new("B"), body(1.0, Vec3::X)));
    let names = EndNames::new("A", "B");
    macro_rules! check {
        ($($element:ty),*) => {$(
            let element = lab.spawn((<$element>::default(), names.clone()));
            lab.tick();
            let now = lab.get::<$element>(element);
            assert_eq!([now.body_a, now.body_b], [a, b], stringify!($element));
            assert_eq!(fault(&lab, element), None, stringify!($element));
        )*};
    }
    check!(
        Spring,
        Damper,
        SpringDamper,
        TorsionSpring,
        TorsionDamper,
        TorsionSpringDamper
    );
}

#[test]
fn two_instances_of_one_scene_do_not_mix() {
    let mut lab = Lab::new();
    let mut made = Vec::new();
    let stage = lab.spawn((Name::new("Stage"), Transform::default()));
    for x in 0..3 {
        let root = lab.spawn((Transform::from_xyz(x as f32, 0.0, 0.0), ChildOf(stage)));
        let frame = lab.spawn((Transform::default(), ChildOf(root)));
        let a = lab.spawn((hook("Hook"), ChildOf(root)));
        let b = lab.spawn((weight("Weight"), ChildOf(frame)));
        let element = lab.spawn((spring("Hook", "Weight"), ChildOf(frame)));
        made.push((element, [a, b]));
    }
    // Entities with the same names outside the scenes must not be chosen.
    lab.spawn(hook("Hook"));
    lab.spawn(weight("Weight"));
    lab.tick();
    for (element, wanted) in made {
        assert_eq!(ends(&lab, element), wanted);
    }
}

#[test]
fn what_the_scene_has_not_is_found_in_the_world() {
    let mut lab = Lab::new();
    let root = lab.spawn(Transform::default());
    let b = lab.spawn((weight("Weight"), ChildOf(root)));
    let element = lab.spawn((spring("Sky hook", "Weight"), ChildOf(root)));
    let a = lab.spawn(hook("Sky hook"));
    lab.tick();
    assert_eq!(ends(&lab, element), [a, b]);
}

#[test]
fn a_name_that_is_missing_is_told_once_and_mended_by_itself() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let b = lab.spawn(weight("Weight"));
    let element = lab.spawn(spring("Hook", "Weight"));
    lab.run(0.2);
    let wanted = "EndNames::a names 'Hook', which no entity has";
    assert_eq!(fault(&lab, element).as_deref(), Some(wanted));
    assert_eq!(lab.readout(element), SpringReadout::default());
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].contains(wanted), "{told:?}");
    // The entity first appears disabled and with another name.
    let a = lab.spawn((hook("Crook"), Disabled));
    lab.tick();
    *lab.app.world_mut().get_mut::<Name>(a).expect("a name") = Name::new("Hook");
    lab.tick();
    assert!(fault(&lab, element).is_some(), "it is disabled");
    lab.app.world_mut().entity_mut(a).remove::<Disabled>();
    lab.tick();
    assert_eq!(fault(&lab, element), None);
    assert_eq!(ends(&lab, element), [a, b]);
    lab.run(0.2);
    assert!(lab.readout(element).force() > 0.0);
    assert!(log.take().is_empty());
}

#[test]
fn a_name_that_several_have_is_told_with_their_number_and_place() {
    let mut lab = Lab::new();
    let root = lab.spawn((Name::new("Car"), Transform::default()));
    let a = lab.spawn((hook("Hook"), ChildOf(root)));
    let [one, two] = [0, 1].map(|_| lab.spawn((weight("Wheel"), ChildOf(root))));
    let element = lab.spawn((spring("Hook", "Wheel"), ChildOf(root)));
    lab.tick();
    let wanted =
        "EndNames::b names 'Wheel', which 2 entities below 'Car' have; give each a name of its own";
    assert_eq!(fault(&lab, element).as_deref(), Some(wanted));
    lab.app.world_mut().despawn(two);
    lab.tick();
    assert_eq!(fault(&lab, element), None);
    assert_eq!(ends(&lab, element), [a, one]);
}

#[test]
fn a_mesh_named_after_its_object_is_no_rival() {
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Cube"));
    lab.spawn((Name::new("Cube"), Transform::default(), ChildOf(b)));
    let element = lab.spawn(spring("Hook", "Cube"));
    lab.tick();
    assert_eq!(ends(&lab, element), [a, b]);
}

#[test]
fn an_element_on_one_of_its_ends_names_itself() {
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn((weight("Lamp"), spring("Hook", "Lamp")));
    let other = lab.spawn((weight("Lamp"), spring("Hook", "Lamp")));
    lab.tick();
    assert_eq!(ends(&lab, b), [a, b]);
    assert_eq!(ends(&lab, other), [a, other]);
}

#[test]
fn an_end_that_is_despawned_is_looked_for_again() {
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Weight"));
    let element = lab.spawn(spring("Hook", "Weight"));
    lab.run(0.1);
    lab.app.world_mut().despawn(a);
    lab.run(0.1);
    assert!(fault(&lab, element).is_some_and(|told| told.contains("'Hook'")));
    let a = lab.spawn(hook("Hook"));
    lab.run(0.1);
    assert_eq!(fault(&lab, element), None);
    assert_eq!(ends(&lab, element), [a, b]);
    assert!(lab.readout(element).force() > 0.0);
}

#[test]
fn names_inserted_again_are_looked_for_again() {
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Weight"));
    let c = lab.spawn((Name::new("Other"), body(1.0, Vec3::X)));
    let element = lab.spawn(spring("Hook", "Weight"));
    lab.tick();
    assert_eq!(ends(&lab, element), [a, b]);
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert(EndNames::new("", "Other"));
    lab.tick();
    assert_eq!(ends(&lab, element), [a, c], "an empty name leaves its end");
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert(EndNames::new("", "Nobody"));
    lab.tick();
    assert!(fault(&lab, element).is_some());
    // Without `EndNames`, the element keeps its current ends.
    lab.app.world_mut().entity_mut(element).remove::<EndNames>();
    lab.run(0.1);
    assert_eq!(fault(&lab, element), None);
    assert_eq!(ends(&lab, element), [a, c]);
    assert!(lab.readout(element).length > 0.0);
}

#[test]
fn an_element_without_any_end_says_how_to_give_it_one() {
    let mut lab = Lab::new();
    let element = lab.spawn(Spring::default());
    lab.tick();
    let told = fault(&lab, element).expect("a fault");
    assert!(told.contains("Spring::body_a does not exist yet"), "{told}");
    assert!(told.contains("EndNames"), "{told}");
}

#[test]
fn names_without_an_element_are_told_and_wait_for_one() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Weight"));
    let element = lab.spawn(EndNames::new("Hook", "Weight"));
    lab.run(0.2);
    assert!(log.take().iter().any(|told| told.contains("EndNames")));
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert(SpringDamper::default());
    lab.tick();
    assert_eq!(ends(&lab, element), [a, b]);
}

#[test]
fn world_anchors_wait_for_named_ends() {
    let mut lab = Lab::new();
    let element = lab.spawn((
        spring("Hook", "Weight"),
        WorldAnchors::new(Vec3::new(0.0, 2.5, 0.0), Vec3::new(0.0, 0.25, 0.0)),
    ));
    lab.run(0.1);
    lab.spawn(hook("Hook"));
    lab.spawn(weight("Weight"));
    lab.run(0.1);
    let anchors = *lab.get::<Anchors>(element);
    assert!(anchors.a.distance(Vec3::Y * 0.5) < 1e-3, "{anchors:?}");
    assert!(anchors.b.distance(Vec3::Y * 0.25) < 0.1, "{anchors:?}");
}

#[test]
fn world_anchors_beside_new_names_wait_for_the_ends_of_these() {
    let mut lab = Lab::weightless();
    lab.spawn(hook("Hook"));
    lab.spawn(weight("Weight"));
    let element = lab.spawn(spring("Hook", "Weight"));
    lab.run(0.1);
    let points = WorldAnchors::new(Vec3::Y * 2.5, Vec3::new(3.0, 0.25, 0.0));
    let mut entity = lab.app.world_mut().entity_mut(element);
    entity.insert((EndNames::new("Hook", "Late"), points));
    lab.run(0.1);
    assert!(fault(&lab, element).is_some());
    lab.spawn((Name::new("Late"), body(1.0, Vec3::X * 3.0)));
    lab.run(0.1);
    assert!(lab.app.world().get::<WorldAnchors>(element).is_none());
    let anchors = *lab.get::<Anchors>(element);
    assert!(anchors.a.distance(Vec3::Y * 0.5) < 1e-3, "{anchors:?}");
    assert!(anchors.b.distance(Vec3::Y * 0.25) < 1e-3, "{anchors:?}");
}

#[test]
fn what_makes_the_search_run_goes_with_the_last_missing_name() {
    let mut lab = Lab::new();
    let a = lab.spawn(hook("Hook"));
    let b = lab.spawn(weight("Weight"));
    let given = lab.spawn(SpringDamper::new(a, b));
    let named = lab.spawn(spring("Hook", "Weight"));
    let late = lab.spawn(spring("Hook", "Late"));
    lab.run(0.1);
    let extra = |lab: &Lab, entity: Entity| {
        let count = |e: Entity| lab.app.world().entity(e).archetype().component_count();
        count(entity) - count(given)
    };
    // `named` has `EndNames` and no marker. `late` also has a fault and a marker.
    assert_eq!((extra(&lab, named), extra(&lab, late)), (1, 3));
    lab.spawn((Name::new("Late"), body(1.0, Vec3::X)));
    lab.run(0.1);
    assert_eq!((extra(&lab, named), extra(&lab, late)), (1, 1));
}

#[test]
fn a_hundred_scenes_of_three_hundred_springs_are_tied_in_no_time() {
    let mut lab = Lab::weightless();
    for _ in 0..100 {
        let root = lab.spawn(Transform::default());
        for i in 0..300 {
            lab.spawn((
                Name::new(format!("P{i}")),
                Transform::from_xyz(i as f32, 0.0, 0.0),
                ChildOf(root),
            ));
        }
        for i in 0..300 {
            let names = EndNames::new(format!("P{i}"), format!("P{}", (i + 1) % 300));
            lab.spawn((Spring::default(), names, ChildOf(root)));
        }
    }
    let started = std::time::Instant::now();
    lab.tick();
    let took = started.elapsed();
    println!("30 000 springs among 60 000 entities: {took:?}");
    let mut faults = lab.app.world_mut().query::<&SpringFault>();
    assert_eq!(faults.iter(lab.app.world()).count(), 0);
    // Comparing every spring with every entity of its name would take a hundred times as long.
    assert!(took.as_secs_f64() < 10.0, "{took:?}");
}

#[test]
fn a_given_end_that_is_gone_stays_a_fault_where_the_other_end_has_a_name() {
    let mut lab = Lab::new();
    let hook = lab.point(Vec3::Y);
    lab.spawn(weight("Weight"));
    let pair = SpringDamper {
        body_a: hook,
        ..default()
    };
    let element = lab.spawn((pair.with_stiffness(100.0), EndNames::new("", "Weight")));
    lab.run(0.1);
    assert_eq!(fault(&lab, element), None);
    lab.app.world_mut().despawn(hook);
    lab.run(0.2);
    let told = fault(&lab, element).expect("a fault");
    assert!(told.contains("does not exist"), "{told}");
}
