//! Parameters of extreme size: every state stays finite, and the rest of the world goes on.

use crate::harness::*;
use crate::messages::Log;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// Uniform random numbers from 0 to 1, by the linear congruential generator of Numerical Recipes.
struct Dice(u32);

impl Dice {
    fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    /// A random number of any size up to the largest of an `f32`, or of a usual size.
    fn size(&mut self) -> f32 {
        match (4.0 * self.roll()) as u32 {
            0 => 10.0_f32.powf(38.0 * self.roll()),
            1 => 10.0_f32.powf(-38.0 * self.roll()),
            2 => 3.0e38,
            _ => 100.0 * self.roll(),
        }
    }

    fn place(&mut self) -> Vec3 {
        4.0 * Vec3::new(self.roll(), self.roll(), self.roll())
    }
}

/// Four bodies, some of which can touch the ground, and four elements between random pairs. Returns the lab, bodies and elements.
fn scene(dice: &mut Dice) -> (Lab, Vec<Entity>, Vec<Entity>) {
    let mut lab = Lab::new();
    lab.spawn((
        Collider::halfspace(Vec3::Y).expect("up"),
        Transform::default(),
    ));
    let (mut bodies, mut elements) = (Vec::new(), Vec::new());
    for _ in 0..4 {
        let at = dice.place() + Vec3::Y * 0.5;
        let body = lab.body(0.1 + dice.roll(), at);
        if dice.roll() < 0.5 {
            lab.app
                .world_mut()
                .entity_mut(body)
                .insert(Collider::ball(0.2));
        }
        if dice.roll() < 0.3 {
            let locks = LockedAxes::ROTATION_LOCKED;
            lab.app.world_mut().entity_mut(body).insert(locks);
        }
        bodies.push(body);
    }
    for _ in 0..4 {
        let a = bodies[(3.99 * dice.roll()) as usize];
        let b = bodies[(3.99 * dice.roll()) as usize];
        let (stiffness, damping, rest) = (dice.size(), dice.size(), dice.size());
        let element = if dice.roll() < 0.3 {
            lab.spawn(
                TorsionSpringDamper::new(a, b, dice.place())
                    .with_stiffness(stiffness)
                    .with_damping(damping)
                    .with_rest_angle(rest),
            )
        } else {
            lab.spawn(
                SpringDamper::new(a, b)
                    .with_stiffness(stiffness)
                    .with_damping(damping)
                    .with_rest_length(rest),
            )
        };
        elements.push(element);
        let mut element = lab.app.world_mut().entity_mut(element);
        if dice.roll() < 0.2 {
            element.insert(Preload(dice.size()));
        }
        if dice.roll() < 0.2 {
            element.insert(Anchors::new(dice.place(), dice.size() * Vec3::X));
        }
    }
    (lab, bodies, elements)
}

#[test]
fn parameters_of_any_size_give_the_engine_finite_numbers() {
    for seed in 0..500 {
        let mut dice = Dice(seed);
        let (mut lab, bodies, elements) = scene(&mut dice);
        for tick in 0..30 {
            lab.tick();
            for body in &bodies {
                let velocity = lab.get::<Velocity>(*body);
                let sound = lab.position(*body).is_finite()
                    && velocity.linear.is_finite()
                    && velocity.angular.is_finite();
                assert!(sound, "seed {seed}, tick {tick}: {velocity:?}");
                if let Some(force) = lab.app.world().get::<ExternalForce>(*body) {
                    let sound = force.force.is_finite() && force.torque.is_finite();
                    assert!(sound, "seed {seed}, tick {tick}: {force:?}");
                }
            }
            for element in &elements {
                let r = lab.readout(*element);
                let sound = [
                    r.length,
                    r.rate,
                    r.spring_force,
                    r.damper_force,
                    r.stored_energy,
                ];
                let sound = sound.into_iter().all(f32::is_finite);
                assert!(sound, "seed {seed}, tick {tick}: {r:?}");
            }
        }
    }
}

#[test]
fn a_torsion_spring_on_bodies_that_cannot_turn_says_so_once() {
    let mut lab = Lab::weightless();
    let locked = |lab: &mut Lab, at: Vec3| {
        let body = lab.body(1.0, at);
        let mut entity = lab.app.world_mut().entity_mut(body);
        entity.insert(LockedAxes::ROTATION_LOCKED);
        body
    };
    let (a, b) = (locked(&mut lab, Vec3::ZERO), locked(&mut lab, Vec3::X));
    let torsion = lab.spawn(
        TorsionSpring::new(a, b, Vec3::Y)
            .with_stiffness(5.0)
            .with_rest_angle(1.0),
    );
    lab.spawn(Spring::new(a, b).with_stiffness(40.0).with_rest_length(0.8));
    let log = Log::capture();
    lab.run(0.5);
    let naming = format!("{torsion}: ");
    let said = log.take().iter().filter(|m| m.starts_with(&naming)).count();
    assert_eq!(said, 1);
    let fault = lab.app.world().get::<SpringFault>(torsion).cloned();
    let fault = fault.expect("it is told");
    assert!(fault.reason.contains("turned"), "{fault}");
    assert!(lab.velocity(b).length() > 0.01, "its neighbour swings");
    // The element acts as soon as one of the bodies can turn.
    let world = lab.app.world_mut();
    world.entity_mut(b).insert(LockedAxes::empty());
    lab.run(0.5);
    assert!(lab.app.world().get::<SpringFault>(torsion).is_none());
    assert!(lab.get::<Velocity>(b).angular.length() > 0.1);
}

/// A joint holds the body, so that the engine solves the element.
#[test]
fn a_cubic_torsion_spring_wound_beyond_all_numbers_does_no_harm_beside_it() {
    let mut lab = Lab::new();
    let still = (RigidBody::KinematicPositionBased, Velocity::default());
    let post = lab.spawn((still, Transform::default()));
    let rest = lab.spawn((still, Transform::from_xyz(0.0, 3.0, 0.0)));
    let wheel = lab.spawn((
        brick(2.0, Vec3::splat(0.1), Vec3::X),
        ImpulseJoint::new(post, SphericalJointBuilder::new().local_anchor1(Vec3::X)),
    ));
    lab.spawn((
        TorsionSpringDamper::new(post, wheel, Vec3::Y)
            .with_stiffness(7.5e4)
            .with_damping(7.6)
            .with_rest_angle(1e12),
        SpringLaw::Cubic,
    ));
    lab.spawn((
        SpringDamper::new(rest, wheel)
            .with_stiffness(500.0)
            .with_damping(5.0)
            .with_rest_length(1.0),
        Anchors::new(Vec3::ZERO, Vec3::Z * 0.2),
    ));
    for tick in 0..120 {
        lab.tick();
        for body in [post, rest, wheel] {
            let now = lab.get::<Velocity>(body);
            let sound = now.linear.is_finite() && now.angular.is_finite();
            assert!(
                sound && lab.position(body).is_finite(),
                "tick {tick}: {now:?}"
            );
        }
    }
}
