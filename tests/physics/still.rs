//! A sleeping world is not examined. Does everything that wakes a part of it still act in the same step as in a
//! world that a flying body keeps under observation?

use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A weight on a hook that the game can move, a floating pair, and a chain that hangs from a fixed body.
struct Bedroom {
    lab: Lab,
    hook: Entity,
    post: Entity,
    bodies: Vec<Entity>,
    springs: Vec<Entity>,
}

impl Bedroom {
    fn new(watched: bool) -> Self {
        let mut lab = Lab::new();
        let hook = lab.point(Vec3::ZERO);
        let post = lab.spawn((RigidBody::Fixed, Transform::from_xyz(10.0, 0.0, 0.0)));
        let mut bodies = vec![lab.body(1.0, Vec3::NEG_Y)];
        for x in [3.0, 4.0] {
            let body = lab.body(1.0, Vec3::X * x);
            let floats = GravityScale(0.0);
            lab.app.world_mut().entity_mut(body).insert(floats);
            bodies.push(body);
        }
        for i in 1..=3 {
            bodies.push(lab.body(1.0, Vec3::new(10.0, -i as f32, 0.0)));
        }
        for body in &bodies {
            let mut body = lab.app.world_mut().entity_mut(*body);
            body.insert((Collider::ball(0.1), ColliderMassProperties::Mass(0.0)));
        }
        let joints = [
            (hook, bodies[0]),
            (bodies[1], bodies[2]),
            (post, bodies[3]),
            (bodies[3], bodies[4]),
            (bodies[4], bodies[5]),
        ];
        let springs = joints.map(|(a, b)| {
            let spring = SpringDamper::new(a, b)
                .with_stiffness(200.0)
                .with_damping(25.0);
            lab.spawn(spring.with_rest_length(1.0))
        });
        if watched {
            let far = lab.body(1.0, Vec3::Z * 1e3);
            let flies = (GravityScale(0.0), Velocity::linear(Vec3::Z));
            lab.app.world_mut().entity_mut(far).insert(flies);
        }
        lab.run(12.0);
        assert!(bodies.iter().all(|body| lab.is_sleeping(*body)));
        Self {
            lab,
            hook,
            post,
            bodies,
            springs: springs.into(),
        }
    }

    fn state(&self) -> Vec<u32> {
        let mut state = Vec::new();
        for body in &self.bodies {
            state.extend(self.lab.position(*body).to_array());
            state.extend(self.lab.velocity(*body).to_array());
        }
        for spring in &self.springs {
            let r = self.lab.readout(*spring);
            state.extend([r.length, r.rate, r.spring_force, r.dissipated_energy]);
        }
        state.into_iter().map(f32::to_bits).collect()
    }

    /// Changes a body directly in the engine, without any component.
    fn in_the_engine(
        &mut self,
        body: usize,
        act: fn(&mut bevy_rapier3d::rapier::dynamics::RigidBody),
    ) {
        let handle = self.lab.get::<RapierRigidBodyHandle>(self.bodies[body]).0;
        let world = self.lab.app.world_mut();
        let mut sets = world.query::<&mut RapierRigidBodySet>();
        for mut set in sets.iter_mut(world) {
            act(set.bodies.get_mut(handle).expect("it is there"));
        }
    }

    fn disturb(&mut self, how: usize) {
        let [weight, left, .., last] = self.bodies[..] else {
            return;
        };
        match how {
            0 => self.lab.get_mut::<Velocity>(left).linear.x = 1.0,
            1 => self.lab.get_mut::<Transform>(left).translation.x -= 0.2,
            2 => {
                let push = ExternalImpulse {
                    impulse: Vec3::Z,
                    ..default()
                };
                self.lab.app.world_mut().entity_mut(last).insert(push);
            }
            3 => self.in_the_engine(1, |body| body.apply_impulse(Vec3::Y, true)),
            4 => self.in_the_engine(5, |body| body.apply_impulse(Vec3::Y, true)),
            5 => self.lab.get_mut::<Transform>(self.hook).translation.x = 0.1,
            6 => self.lab.get_mut::<Transform>(self.post).translation.x += 0.1,
            7 => self.lab.get_mut::<SpringDamper>(self.springs[0]).stiffness = 300.0,
            8 => {
                self.lab
                    .get_mut::<SpringDamper>(self.springs[3])
                    .rest_length = Some(0.8)
            }
            9 => self.lab.spawn_force(weight, Vec3::X),
            10 => {
                let mut weight = self.lab.app.world_mut().entity_mut(weight);
                weight.insert(RigidBodyDisabled);
                self.lab.get_mut::<Velocity>(last).linear.y = 1.0;
            }
            11 => {
                let world = self.lab.app.world_mut();
                world.despawn(self.springs.remove(0));
            }
            _ => {
                // A heavy ball falls on the last body.
                let above = self.lab.position(last) + Vec3::new(0.05, 0.6, 0.0);
                let ball = self.lab.body(5.0, above);
                let round = (Collider::ball(0.1), ColliderMassProperties::Mass(0.0));
                self.lab.app.world_mut().entity_mut(ball).insert(round);
            }
        }
    }
}

#[test]
fn what_sleeps_unwatched_wakes_as_what_is_watched() {
    for how in 0..13 {
        let [mut alone, mut watched] = [false, true].map(Bedroom::new);
        let before = alone.state();
        assert!(before == watched.state());
        for bedroom in [&mut alone, &mut watched] {
            bedroom.disturb(how);
        }
        for tick in 0..90 {
            alone.lab.tick();
            watched.lab.tick();
            assert!(alone.state() == watched.state(), "{how}: tick {tick}");
        }
        assert!(alone.state() != before, "{how}: something moves");
        let awake = |b: &Bedroom| b.bodies.iter().any(|body| !b.lab.is_sleeping(*body));
        assert!(awake(&alone), "{how}: something wakes");
    }
}
