//! Are world anchors and rates applied exactly as given?

use crate::harness::*;
use crate::messages::Log;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

#[test]
fn points_of_the_world_become_points_of_the_ends_at_the_first_step() {
    let mut lab = Lab::weightless();
    // An end with a translation, rotation and scale in the world, below another entity.
    let root =
        lab.spawn(Transform::from_xyz(1.0, 0.0, 2.0).with_rotation(Quat::from_rotation_y(0.7)));
    let hook = lab.spawn((
        Transform::from_xyz(0.0, 3.0, 0.0).with_scale(Vec3::splat(2.0)),
        ChildOf(root),
    ));
    let load = lab.body(1.0, Vec3::new(1.0, 1.0, 2.0));
    lab.get_mut::<Transform>(load).rotation = Quat::from_rotation_z(0.5);
    let points = WorldAnchors::new(Vec3::new(1.5, 2.5, 2.0), Vec3::new(1.2, 1.1, 2.3));
    let element = lab.spawn((Spring::new(hook, load).with_stiffness(5.0), points));
    lab.tick();
    let length = lab.readout(element).length;
    assert!(
        (length - points.a.distance(points.b)).abs() < 1e-5,
        "{length}"
    );
    assert!(lab.app.world().get::<WorldAnchors>(element).is_none());
    let anchors = *lab.get::<Anchors>(element);
    let at = |e: Entity, anchor: Vec3| lab.get::<GlobalTransform>(e).transform_point(anchor);
    assert!(at(hook, anchors.a).distance(points.a) < 1e-5);
    assert!(at(load, anchors.b).distance(points.b) < 1e-5);
}

#[test]
fn points_of_the_world_can_be_given_again() {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::Y);
    let load = lab.body(1.0, Vec3::ZERO);
    let element = lab.spawn((
        Spring::new(hook, load),
        WorldAnchors::new(Vec3::Y, Vec3::ZERO),
    ));
    lab.run(0.1);
    assert_eq!(
        *lab.get::<Anchors>(element),
        Anchors::new(Vec3::ZERO, Vec3::ZERO)
    );
    let again = WorldAnchors::new(Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.5, 0.0, 0.0));
    lab.app.world_mut().entity_mut(element).insert(again);
    lab.run(0.1);
    assert_eq!(
        *lab.get::<Anchors>(element),
        Anchors::new(Vec3::X * 0.5, Vec3::X * 0.5)
    );
}

#[test]
fn an_end_below_an_entity_without_a_place_has_its_own_place_in_the_world() {
    let mut lab = Lab::weightless();
    let folder = lab.spawn(Name::new("Hooks"));
    let hook = lab.spawn((Transform::from_xyz(0.0, 3.0, 0.0), ChildOf(folder)));
    let load = lab.body(1.0, Vec3::Y);
    let points = WorldAnchors::new(Vec3::new(0.5, 3.0, 0.0), Vec3::new(0.5, 1.0, 0.0));
    let element = lab.spawn((Spring::new(hook, load), points));
    lab.tick();
    assert!(lab.app.world().get::<WorldAnchors>(element).is_none());
    let anchors = *lab.get::<Anchors>(element);
    assert!(anchors.a.distance(Vec3::X * 0.5) < 1e-6, "{anchors:?}");
    let length = lab.readout(element).length;
    assert!((length - 2.0).abs() < 1e-5, "{length} m");
}

#[test]
fn points_on_an_end_that_grows_from_nothing_wait_until_it_has_a_size() {
    let mut lab = Lab::weightless();
    let hook = lab.spawn(Transform::from_scale(Vec3::ZERO));
    let load = lab.body(1.0, Vec3::ZERO);
    let points = WorldAnchors::new(Vec3::Y, Vec3::X);
    let element = lab.spawn((Spring::new(hook, load), points));
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    lab.get_mut::<Transform>(hook).scale = Vec3::splat(0.5);
    lab.tick();
    assert!(lab.app.world().get::<WorldAnchors>(element).is_none());
    assert_eq!(lab.get::<Anchors>(element).a, 2.0 * Vec3::Y);
}

#[test]
fn points_on_a_body_without_a_place_are_told_once_and_wait_until_it_has_one() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::Y);
    let [load, late] = [(), ()].map(|()| {
        let mass = AdditionalMassProperties::Mass(1.0);
        lab.spawn((RigidBody::Dynamic, mass))
    });
    let points = WorldAnchors::new(Vec3::new(0.5, 1.0, 0.0), Vec3::new(0.5, 0.0, 0.0));
    let [on_b, on_a] = [Spring::new(hook, load), Spring::new(load, hook)]
        .map(|spring| lab.spawn((spring, points)));
    let in_time = lab.spawn((Spring::new(hook, late), points));
    lab.tick();
    let place = Transform::default();
    lab.app.world_mut().entity_mut(late).insert(place);
    lab.run(0.5);
    let told = log.take();
    assert_eq!(told.len(), 2, "{told:?}");
    for (element, field) in [(on_b, "b"), (on_a, "a")] {
        let wanted = format!(
            "{element}: WorldAnchors::{field} cannot be converted, because {load} has no Transform "
        );
        assert!(
            told.iter().any(|t| t.starts_with(&wanted)),
            "{told:?} say nothing of {element}"
        );
    }
    let waits = |lab: &Lab, element: Entity| lab.app.world().get::<WorldAnchors>(element).is_some();
    assert!(waits(&lab, on_b) && waits(&lab, on_a) && !waits(&lab, in_time));
    lab.app.world_mut().entity_mut(load).insert(place);
    lab.tick();
    assert!(!waits(&lab, on_b) && !waits(&lab, on_a));
    let anchors = lab.get::<Anchors>(on_b);
    assert!(anchors.a.distance(Vec3::X * 0.5) < 1e-5, "{anchors:?}");
    assert!(anchors.b.distance(points.b) < 1e-5, "{anchors:?}");
    lab.run(0.1);
    assert_eq!(log.take(), Vec::<String>::new());
}

#[test]
fn points_on_an_end_that_is_nowhere_are_told_by_the_fault_of_their_element_alone() {
    let log = Log::capture();
    let mut lab = Lab::weightless();
    let (nowhere, load) = (lab.spawn(()), lab.body(1.0, Vec3::ZERO));
    let points = WorldAnchors::new(Vec3::Y, Vec3::ZERO);
    let element = lab.spawn((Spring::new(nowhere, load), points));
    lab.run(0.5);
    assert_eq!(lab.get::<SpringFault>(element).field, "Spring::body_a");
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    let place = Transform::from_xyz(0.0, 1.0, 0.0);
    lab.app.world_mut().entity_mut(nowhere).insert(place);
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    assert!(lab.app.world().get::<WorldAnchors>(element).is_none());
    assert_eq!(log.take(), Vec::<String>::new());
}

fn rates(app: &App) -> (f32, f32) {
    let tick = app.world().resource::<Time<Fixed>>().timestep();
    let step = match *app.world().resource::<TimestepMode>() {
        TimestepMode::Fixed { dt, substeps: 1 } => dt,
        other => panic!("{other:?}"),
    };
    (tick.as_secs_f32(), step)
}

#[test]
fn one_call_sets_the_rates_of_physics_and_schedule_in_either_order_of_plugins() {
    let log = Log::capture();
    let rapier = || RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule();
    for ours_first in [true, false] {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin));
        if ours_first {
            app.add_plugins((CoiloverPlugin::at_hz(90.0), rapier()));
        } else {
            app.add_plugins((rapier(), CoiloverPlugin::at_hz(90.0)));
        }
        single_threaded(&mut app);
        app.update();
        assert_eq!(rates(&app), (1.0 / 90.0, 1.0 / 90.0));
    }
    assert_eq!(log.take(), Vec::<String>::new());
}

#[test]
fn a_rate_that_is_none_is_told_and_changes_nothing() {
    for hertz in [0.0, -60.0, f64::NAN, f64::INFINITY, 4e9, 1e-7] {
        let log = Log::capture();
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, CoiloverPlugin::at_hz(hertz)));
        let told = log.take();
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].contains("at_hz"));
        assert!(app.world().get_resource::<TimestepMode>().is_none());
    }
}

#[test]
fn a_bar_that_loses_the_weight_at_one_end_hangs_askew() {
    // The engine moves the centre of mass of the bar without a word. The spring still holds the middle of the bar.
    for bodies_above in [0, 1] {
        let mut lab = Lab::new();
        let mut last = lab.point(Vec3::Y * 2.0);
        let pair = |a, b| {
            SpringDamper::new(a, b)
                .with_stiffness(2000.0)
                .with_damping(60.0)
                .with_rest_length(1.0)
        };
        if bodies_above > 0 {
            let next = lab.body(1.0, Vec3::Y);
            lab.spawn(pair(last, next));
            last = next;
        }
        let bar = lab.spawn((RigidBody::Dynamic, Transform::default()));
        let [lost, _] = [-0.5, 0.5].map(|x| {
            let weight = (Collider::ball(0.1), ColliderMassProperties::Mass(1.0));
            lab.spawn((weight, Transform::from_xyz(x, 0.0, 0.0), ChildOf(bar)))
        });
        let spring = lab.spawn(pair(last, bar));
        lab.run(1.0);
        let turned = |lab: &Lab| {
            lab.get::<Transform>(bar)
                .rotation
                .angle_between(Quat::IDENTITY)
        };
        assert!(turned(&lab) < 1e-3, "it hangs level");
        lab.app
            .world_mut()
            .entity_mut(lost)
            .insert(ColliderDisabled);
        lab.run(0.3);
        assert!(turned(&lab) > 0.2, "{bodies_above}: {} rad", turned(&lab));
        let above = if bodies_above > 0 {
            lab.position(last)
        } else {
            Vec3::Y * 2.0
        };
        let length = above.distance(lab.position(bar));
        let told = lab.readout(spring).length;
        assert!(
            (told - length).abs() < 1e-4,
            "{bodies_above}: {told}, not {length}"
        );
    }
}
