//! Does bad input cause one message with entity and field, while everything else goes on?

use crate::harness::*;
use crate::messages::Log;
use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

struct Bench {
    lab: Lab,
    hook: Entity,
    body: Entity,
    element: Entity,
    neighbour: Entity,
}

/// One element that a test will spoil, and a second body on its own spring that must not be affected.
fn bench() -> Bench {
    let mut lab = Lab::weightless();
    let hook = lab.point(Vec3::ZERO);
    let body = lab.body(1.0, Vec3::X * 1.2);
    let element = lab.spawn((
        SpringDamper::new(hook, body)
            .with_stiffness(40.0)
            .with_damping(0.0)
            .with_rest_length(1.0),
        Anchors::default(),
    ));
    let neighbour = lab.body(1.0, Vec3::new(1.3, 5.0, 0.0));
    let other = lab.point(Vec3::Y * 5.0);
    lab.spawn(
        Spring::new(other, neighbour)
            .with_stiffness(40.0)
            .with_rest_length(1.0),
    );
    Bench {
        lab,
        hook,
        body,
        element,
        neighbour,
    }
}

impl Bench {
    fn pair(&mut self) -> Mut<'_, SpringDamper> {
        self.lab.get_mut::<SpringDamper>(self.element)
    }

    /// Runs with the fault. Checks that there is one message, that the element is inert, and that the second body
    /// still moves.
    fn expect_fault(&mut self, field: &str, reason: &str) {
        let log = Log::capture();
        let before = self.lab.velocity(self.body);
        self.lab.run(0.5);
        let after = self.lab.velocity(self.body);
        assert!(
            before.distance(after) < 1e-6,
            "{field} {reason}: {before} then {after}"
        );
        let fault = self.lab.get::<SpringFault>(self.element).clone();
        assert_eq!(fault.field, field);
        assert!(fault.reason.contains(reason), "{fault}");
        assert_eq!(fault.entity, self.element);
        // The readout must not show a force that does not act.
        assert_eq!(self.lab.readout(self.element), SpringReadout::default());
        let told = log.take();
        let naming = format!("{}: {field}", self.element);
        assert_eq!(
            told.iter().filter(|m| m.starts_with(&naming)).count(),
            1,
            "{told:?}"
        );
        let x = f64::from(self.lab.position(self.neighbour).x) - 1.0;
        assert!(x.is_finite() && x.abs() < 0.301);
        assert!(self.lab.velocity(self.neighbour).length() > 0.0);
    }

    /// After the input is corrected, the element acts again and the fault is gone.
    fn expect_recovery(&mut self) {
        let before = self.lab.velocity(self.body);
        self.lab.run(0.1);
        assert!(self.lab.velocity(self.body).distance(before) > 1e-3);
        assert!(
            self.lab
                .app
                .world()
                .get::<SpringFault>(self.element)
                .is_none()
        );
    }
}

#[test]
fn constants_that_are_no_constants() {
    for (value, reason) in [
        (f32::NAN, "NaN"),
        (f32::INFINITY, "infinite"),
        (-1.0, "negative"),
    ] {
        let mut b = bench();
        b.pair().stiffness = value;
        b.expect_fault("SpringDamper::stiffness", reason);
        b.pair().stiffness = 40.0;
        b.expect_recovery();
        b.pair().damping = value;
        b.expect_fault("SpringDamper::damping", reason);
        b.pair().damping = 0.0;
        b.expect_recovery();
        b.pair().rest_length = Some(value);
        b.expect_fault("SpringDamper::rest_length", reason);
        b.pair().rest_length = Some(1.0);
        b.expect_recovery();
    }
}

#[test]
fn anchors_that_are_nowhere() {
    let mut b = bench();
    b.lab.get_mut::<Anchors>(b.element).b.y = f32::NAN;
    b.expect_fault("Anchors::b", "NaN");
    b.lab.get_mut::<Anchors>(b.element).b.y = f32::NEG_INFINITY;
    b.expect_fault("Anchors::b", "infinite");
    b.lab.get_mut::<Anchors>(b.element).b.y = 1e20;
    b.expect_fault("Anchors::b", "larger than");
    b.lab.get_mut::<Anchors>(b.element).b.y = 0.0;
    b.expect_recovery();
}

#[test]
fn both_ends_the_same_entity() {
    let mut b = bench();
    let body = b.body;
    b.pair().body_a = body;
    b.expect_fault("SpringDamper::body_b", "same entity");
    let hook = b.hook;
    b.pair().body_a = hook;
    b.expect_recovery();
}

#[test]
fn an_end_that_is_gone_or_has_no_place() {
    let mut b = bench();
    b.lab.app.world_mut().despawn(b.hook);
    b.expect_fault("SpringDamper::body_a", "does not exist");
    let nowhere = b.lab.spawn(Name::new("no transform"));
    b.pair().body_a = nowhere;
    b.expect_fault("SpringDamper::body_a", "neither");
    b.lab
        .app
        .world_mut()
        .entity_mut(nowhere)
        .insert(Transform::default());
    b.expect_recovery();
}

#[test]
fn a_placeholder_end() {
    let mut b = bench();
    b.pair().body_a = Entity::PLACEHOLDER;
    b.expect_fault("SpringDamper::body_a", "does not exist");
}

#[test]
fn a_transform_that_is_not_finite() {
    let mut b = bench();
    b.lab.get_mut::<Transform>(b.hook).translation.x = f32::NAN;
    b.expect_fault("SpringDamper::body_a", "not finite");
    b.lab.get_mut::<Transform>(b.hook).translation.x = 0.0;
    b.expect_recovery();
}

#[test]
fn a_point_that_is_farther_than_the_engine_can_compute() {
    let mut b = bench();
    // Rapier's f32 cannot hold the square of this distance.
    b.lab.get_mut::<Transform>(b.hook).translation.x = 1e30;
    b.expect_fault("SpringDamper::body_a", "farther than");
    b.lab.get_mut::<Transform>(b.hook).translation.x = 0.0;
    b.expect_recovery();
}

#[test]
fn a_dynamic_body_without_mass() {
    let mut b = bench();
    let empty = b
        .lab
        .spawn((RigidBody::Dynamic, Transform::from_xyz(0.0, 1.0, 0.0)));
    b.pair().body_a = empty;
    b.expect_fault("SpringDamper::body_a", "without mass");
    b.lab
        .app
        .world_mut()
        .entity_mut(empty)
        .insert(AdditionalMassProperties::Mass(1.0));
    b.expect_recovery();
}

#[test]
fn two_elements_on_one_entity() {
    let mut b = bench();
    let (hook, body) = (b.hook, b.body);
    b.lab
        .app
        .world_mut()
        .entity_mut(b.element)
        .insert(Damper::new(hook, body));
    b.expect_fault("Spring, Damper, SpringDamper", "together on one entity");
    b.lab
        .app
        .world_mut()
        .entity_mut(b.element)
        .remove::<Damper>();
    b.expect_recovery();
}

#[test]
fn ends_that_coincide_where_the_direction_matters() {
    let mut b = bench();
    let body = b.body;
    b.lab.get_mut::<Transform>(body).translation = Vec3::ZERO;
    let (hook, body) = (b.hook, b.body);
    // A new element has no earlier direction to use.
    b.lab.app.world_mut().despawn(b.element);
    b.element = b.lab.spawn((
        SpringDamper::new(hook, body)
            .with_stiffness(40.0)
            .with_damping(0.0)
            .with_rest_length(1.0),
        Anchors::default(),
    ));
    b.expect_fault("SpringDamper::body_b", "coincides");
    b.lab.get_mut::<Transform>(body).translation = Vec3::X * 0.5;
    b.expect_recovery();
}

#[test]
fn a_body_that_the_engine_has_quarantined_takes_no_one_with_it() {
    let mut b = bench();
    b.lab.get_mut::<Velocity>(b.body).linear.x = f32::NAN;
    b.lab.run(0.5);
    let x = b.lab.position(b.neighbour).x;
    assert!(x.is_finite() && (x - 1.0).abs() < 0.301, "{x}");
}

#[test]
fn a_mount_below_a_body_whose_transform_is_not_finite() {
    let mut b = bench();
    let mount = b.lab.spawn((Transform::default(), ChildOf(b.body)));
    b.pair().body_b = mount;
    b.lab.tick();
    b.lab.get_mut::<Transform>(mount).translation.x = f32::NAN;
    b.expect_fault("SpringDamper::body_b", "not finite");
    b.lab.get_mut::<Transform>(mount).translation.x = 0.0;
    b.expect_recovery();
}

#[test]
fn two_points_of_one_body() {
    let mut b = bench();
    let mount = b.lab.spawn((Transform::default(), ChildOf(b.body)));
    let body = b.body;
    *b.pair() = SpringDamper {
        body_a: body,
        body_b: mount,
        ..*b.pair()
    };
    b.expect_fault("SpringDamper::body_b", "same rigid body");
}

#[test]
fn what_coincided_acts_again_in_what_it_shows_once_nothing_can_be_moved() {
    let mut lab = Lab::weightless();
    let (hook, body) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::ZERO));
    let spring = Spring::new(hook, body)
        .with_stiffness(40.0)
        .with_rest_length(1.0);
    let element = lab.spawn(spring);
    lab.run(0.1);
    assert!(lab.get::<SpringFault>(element).reason.contains("coincides"));
    lab.app
        .world_mut()
        .entity_mut(body)
        .insert((RigidBody::Fixed, Transform::from_xyz(1.5, 0.0, 0.0)));
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
    assert!((lab.readout(element).spring_force - 20.0).abs() < 1e-3);
}

#[test]
fn two_torsion_elements_or_both_kinds_on_one_entity() {
    let mut lab = Lab::weightless();
    let (hook, body) = (lab.body(1.0, Vec3::ZERO), lab.body(1.0, Vec3::X));
    let damper = || TorsionDamper::new(hook, body, Vec3::X);
    let both = lab.spawn((TorsionSpring::new(hook, body, Vec3::X), damper()));
    let mixed = lab.spawn((Spring::new(hook, body), damper()));
    lab.run(0.1);
    let fault = lab.get::<SpringFault>(both);
    assert!(fault.field.contains("TorsionSpring,") && fault.reason.contains("TorsionSpringDamper"));
    let fault = lab.get::<SpringFault>(mixed);
    assert!(fault.reason.contains("an entity of its own"), "{fault}");
}

/// A spring of unknown stiffness, which has a fault.
fn faulty() -> (Lab, Entity) {
    let mut lab = Lab::weightless();
    let (hook, body) = (lab.point(Vec3::ZERO), lab.body(1.0, Vec3::X * 1.5));
    let spring = Spring::new(hook, body)
        .with_stiffness(f32::NAN)
        .with_rest_length(1.0);
    let element = lab.spawn(spring);
    lab.run(0.1);
    assert_eq!(lab.get::<SpringFault>(element).field, "Spring::stiffness");
    (lab, element)
}

#[test]
fn a_fault_that_is_mended_while_its_element_is_disabled_is_gone_when_that_acts_again() {
    let log = Log::capture();
    let (mut lab, element) = faulty();
    let told = log.take();
    assert_eq!(told.len(), 1, "{told:?}");
    for mended in [false, true] {
        lab.app.world_mut().entity_mut(element).insert(Disabled);
        lab.run(0.1);
        if mended {
            lab.get_mut::<Spring>(element).stiffness = 40.0;
        }
        lab.app.world_mut().entity_mut(element).remove::<Disabled>();
        lab.run(0.1);
        let fault = lab.app.world().get::<SpringFault>(element);
        assert_eq!(fault.is_none(), mended, "{fault:?}");
    }
    assert!(lab.readout(element).spring_force > 10.0);
    assert_eq!(log.take(), Vec::<String>::new(), "it was told before");
}

#[test]
fn a_fault_goes_with_the_element_that_had_it() {
    let (mut lab, element) = faulty();
    lab.app.world_mut().entity_mut(element).remove::<Spring>();
    lab.run(0.1);
    assert!(lab.app.world().get::<SpringFault>(element).is_none());
}
