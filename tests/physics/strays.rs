//! Does a component that needs an element, on an entity without one, cause one message, and does nothing else
//! cause any?

use crate::harness::*;
use crate::messages::Log;
use bevy::prelude::*;
use bevy_coilover::prelude::*;

#[test]
fn companions_without_an_element_are_told_once_for_each_entity() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let lone = lab.spawn((
        Preload(3.0),
        Breakable::at_force(1.0),
        Anchors::default(),
        SpringLaw::Cubic,
        DampingLaw::Linear,
        SpringAction::Pull,
        SpringTravel::new(0.1, 1.0, 1.0),
        MaxForce(1.0),
        SpringAxis::World(Vec3::Y),
        SpringTuning::frequency(1.0, 0.1),
    ));
    let other = lab.spawn((HoldPose::new(), Name::new("Lamp")));
    lab.run(0.03);
    assert_eq!(log.take(), Vec::<String>::new(), "too early");
    lab.run(1.0);
    let told = log.take();
    assert_eq!(told.len(), 2, "{told:?}");
    for (who, names) in [
        (
            lone.to_string(),
            &[
                "Preload",
                "Breakable",
                "Anchors",
                "SpringLaw",
                "DampingLaw",
                "SpringAction",
                "SpringTravel",
                "MaxForce",
                "SpringAxis",
                "SpringTuning",
            ][..],
        ),
        (format!("Lamp, {other}"), &["HoldPose"][..]),
    ] {
        let said = told.iter().find(|t| t.starts_with(&format!("{who}: ")));
        let said = said.unwrap_or_else(|| panic!("{told:?} say nothing of {who}"));
        for name in names {
            assert!(said.contains(name), "{said} does not name {name}");
        }
    }
    lab.app.world_mut().entity_mut(other).insert(MaxForce(1.0));
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new(), "told twice");
}

#[test]
fn what_gets_its_element_within_a_few_ticks_or_is_gone_by_then_is_not_told() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let (hook, body) = (lab.point(Vec3::Y), lab.body(1.0, Vec3::ZERO));
    let late = lab.spawn(Preload(1.0));
    let gone = lab.spawn(Preload(1.0));
    lab.tick();
    let world = lab.app.world_mut();
    world.entity_mut(late).insert(Spring::new(hook, body));
    world.despawn(gone);
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new());
}

#[cfg(feature = "visual")]
#[test]
fn looks_without_an_element_and_on_a_torsion_element_are_told() {
    let log = Log::capture();
    let mut lab = crate::visual_data::lab();
    let lone = lab.spawn((Coil::default(), Telescope::default()));
    let (hook, body) = (lab.body(1.0, Vec3::Y), lab.body(1.0, Vec3::ZERO));
    let bar = lab.spawn((TorsionSpring::new(hook, body, Vec3::Y), Coil::default()));
    let linear = lab.spawn((Spring::new(hook, body), Coil::new(0.1, 0.01, 4.0)));
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 2, "{told:?}");
    let of = |e: Entity| told.iter().find(|t| t.starts_with(&format!("{e}: ")));
    assert!(
        of(lone).is_some_and(|t| t.contains("Coil, Telescope") && t.contains("without an element"))
    );
    assert!(of(bar).is_some_and(|t| t.contains("Coil")
        && t.contains("torsion element")
        && t.contains("use a TorsionCoil")));
    assert!(of(linear).is_none());
}

#[cfg(feature = "visual")]
#[test]
fn a_coil_without_the_plugin_that_draws_it_is_told_once() {
    let log = Log::capture();
    let mut lab = Lab::new();
    let (hook, body) = (lab.point(Vec3::Y), lab.body(1.0, Vec3::ZERO));
    lab.spawn((Spring::new(hook, body), Coil::default()));
    lab.spawn((Spring::new(hook, body), Telescope::default()));
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].contains("CoiloverVisualPlugin is missing") && told[0].contains("CoiloverPlugins")
    );
}

#[cfg(feature = "visual")]
#[test]
fn a_skin_below_what_is_no_linear_element_is_told_once_and_drawn_once_that_is_one() {
    let log = Log::capture();
    let mut lab = crate::visual_data::lab();
    let (hook, body) = (lab.point(Vec3::Y), lab.body(1.0, Vec3::ZERO));
    let [folder, other] = [(), ()].map(|()| lab.spawn(Transform::default()));
    let bar = lab.spawn(TorsionSpring::new(hook, body, Vec3::Y));
    let lone = lab.spawn((SpringSkin::default(), ChildOf(folder), Name::new("Band")));
    let twisted = lab.spawn((SpringSkin::default(), ChildOf(bar)));
    lab.run(0.5);
    let told: Vec<_> = log.take();
    let told: Vec<_> = told.iter().filter(|t| t.contains("SpringSkin")).collect();
    assert_eq!(told.len(), 2, "{told:?}");
    for (who, parent) in [
        (format!("Band, {lone}"), folder),
        (twisted.to_string(), bar),
    ] {
        let said = told.iter().find(|t| t.starts_with(&format!("{who}: ")));
        assert!(
            said.is_some_and(|t| t.contains(&format!("its parent {parent} is no Spring"))),
            "{told:?} say nothing of {who}"
        );
    }
    lab.app.world_mut().entity_mut(lone).insert(ChildOf(other));
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new(), "told twice");
    let spring = Spring::new(hook, body);
    lab.app.world_mut().entity_mut(other).insert(spring);
    lab.run(0.1);
    let foot = lab.get::<GlobalTransform>(lone).transform_point(Vec3::ZERO);
    assert!(foot.distance(Vec3::Y) < 1e-5, "{foot}");
}

#[cfg(feature = "visual")]
#[test]
fn a_skin_whose_element_comes_a_little_later_or_is_disabled_is_not_told() {
    let log = Log::capture();
    let mut lab = crate::visual_data::lab();
    let (hook, body) = (lab.point(Vec3::Y), lab.point(Vec3::ZERO));
    let late = lab.spawn(());
    lab.spawn((SpringSkin::default(), ChildOf(late)));
    lab.tick();
    let spring = Spring::new(hook, body);
    lab.app.world_mut().entity_mut(late).insert(spring);
    let pooled = lab.spawn((spring, bevy::ecs::entity_disabling::Disabled));
    lab.spawn((SpringSkin::default(), ChildOf(pooled)));
    let gone = lab.spawn(());
    lab.spawn((SpringSkin::default(), ChildOf(gone)));
    lab.tick();
    lab.app.world_mut().despawn(gone);
    lab.run(0.5);
    assert_eq!(log.take(), Vec::<String>::new());
}
