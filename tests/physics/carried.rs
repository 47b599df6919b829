//! A network without changes is not read again in every step. Does it move as one that is read in every step?

use crate::dice::Dice;
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A net of balls that hangs from hooks. The game moves one of the hooks.
struct Net {
    lab: Lab,
    hook: Entity,
    balls: Vec<Entity>,
    springs: Vec<Entity>,
}

impl Net {
    fn new(stiffness: f32, damping: f32) -> Self {
        Self::within(Lab::new(), stiffness, damping)
    }

    fn within(mut lab: Lab, stiffness: f32, damping: f32) -> Self {
        let hook = lab.point(Vec3::new(0.0, 1.0, 0.0));
        let fixed = lab.spawn((RigidBody::Fixed, Transform::from_xyz(4.0, 1.0, 0.0)));
        let at = |i: usize| Vec3::new((i % 5) as f32, -((i / 5) as f32), 0.1 * (i % 3) as f32);
        let balls: Vec<_> = (0..20)
            .map(|i| {
                let ball = lab.body(0.5 + 0.1 * i as f32, at(i));
                let mut ball_at = lab.app.world_mut().entity_mut(ball);
                let nothing = CollisionGroups::new(Group::GROUP_1, Group::NONE);
                ball_at.insert((Collider::ball(0.1), nothing));
                ball
            })
            .collect();
        let mut springs = Vec::new();
        let mut join = |a: Entity, b: Entity| {
            let spring = SpringDamper::new(a, b)
                .with_stiffness(stiffness)
                .with_damping(damping);
            springs.push(lab.spawn(spring));
        };
        join(hook, balls[0]);
        join(fixed, balls[4]);
        for i in 0..20 {
            if i % 5 > 0 {
                join(balls[i - 1], balls[i]);
            }
            if i >= 5 {
                join(balls[i - 5], balls[i]);
            }
        }
        Self {
            lab,
            hook,
            balls,
            springs,
        }
    }

    /// Positions and velocities of the balls, and the readouts of the springs.
    fn state(&self) -> Vec<u32> {
        let mut state = Vec::new();
        for ball in &self.balls {
            state.extend(self.lab.position(*ball).to_array());
            state.extend(self.lab.velocity(*ball).to_array());
        }
        for spring in &self.springs {
            let r = self.lab.readout(*spring);
            state.extend([r.length, r.rate, r.spring_force, r.damper_force]);
            state.extend([r.dissipated_energy, r.work, r.omega_dt, r.effective_mass]);
        }
        state.into_iter().map(f32::to_bits).collect()
    }

    /// Changes that the game and the player make to the net in a tick.
    fn disturb(&mut self, tick: usize) {
        if (40..60).contains(&tick) {
            let t = (tick - 40) as f32 / 20.0;
            self.lab.get_mut::<Transform>(self.hook).translation.x = t * t;
        }
        if tick == 70 {
            self.lab.get_mut::<AdditionalMassProperties>(self.balls[7]);
            let heavy = AdditionalMassProperties::Mass(3.0);
            let world = self.lab.app.world_mut();
            world.entity_mut(self.balls[7]).insert(heavy);
        }
        if tick == 80 {
            self.lab.spawn_force(self.balls[12], Vec3::Z);
        }
        if tick == 90 {
            self.lab.get_mut::<Velocity>(self.balls[18]).linear.z += 2.0;
        }
        if tick == 100 {
            self.lab.get_mut::<Transform>(self.balls[19]).translation.y -= 0.1;
        }
        self.lab.tick();
    }
}

#[test]
fn a_network_left_alone_moves_as_one_that_is_read_anew_bit_for_bit() {
    for (stiffness, damping) in [(60.0, 0.0), (60.0, 0.4), (2e4, 5.0)] {
        let mut alone = Net::new(stiffness, damping);
        let mut touched = Net::new(stiffness, damping);
        for tick in 0..180 {
            alone.disturb(tick);
            // The value does not change, but the crate must read the spring again to know that.
            let spring = touched.springs[tick % 20];
            touched.lab.get_mut::<SpringDamper>(spring).stiffness = stiffness;
            touched.disturb(tick);
            assert!(
                alone.state() == touched.state(),
                "{stiffness} N/m, {damping} N s/m: tick {tick}"
            );
        }
    }
}

#[test]
fn a_hand_that_moves_and_is_put_elsewhere_does_the_same_work_on_a_net_left_alone() {
    let pulled = || {
        let mut net = Net::new(60.0, 0.4);
        let hand = net.lab.spawn((
            RigidBody::KinematicVelocityBased,
            Transform::from_xyz(5.0, -1.0, 0.0),
            Velocity::linear(Vec3::new(0.5, 0.0, 0.2)),
        ));
        let pull = SpringDamper::new(net.balls[9], hand).with_stiffness(60.0);
        net.springs.push(net.lab.spawn(pull));
        (net, hand)
    };
    let [(mut alone, hand), (mut touched, same)] = [pulled(), pulled()];
    for tick in 0..90 {
        if tick == 40 {
            for (net, hand) in [(&mut alone, hand), (&mut touched, same)] {
                net.lab.get_mut::<Transform>(hand).translation.y -= 0.8;
            }
        }
        let spring = touched.springs[tick % 20];
        touched.lab.get_mut::<SpringDamper>(spring).stiffness = 60.0;
        for net in [&mut alone, &mut touched] {
            net.lab.tick();
        }
        assert!(alone.state() == touched.state(), "tick {tick}");
    }
}

impl Net {
    /// Makes a random change to a ball, a spring or the engine.
    fn surprise(&mut self, dice: &mut Dice) {
        let mut pick = |count: usize| dice.pick(count as u32) as usize;
        let (ball, spring) = (pick(20), pick(self.springs.len()));
        let (kind, size) = (pick(18), pick(10) as f32);
        let (ball, spring) = (self.balls[ball], self.springs[spring]);
        let mut at = self.lab.app.world_mut().entity_mut(ball);
        let push = ExternalImpulse {
            impulse: Vec3::Z * 0.1 * size,
            ..default()
        };
        let drag = Damping {
            linear_damping: 0.1 * size,
            angular_damping: 0.0,
        };
        let _ = match kind {
            0 => at.insert(RigidBodyDisabled),
            1 => at.remove::<RigidBodyDisabled>(),
            2 => at.insert(LockedAxes::TRANSLATION_LOCKED_X),
            3 => at.insert(LockedAxes::ROTATION_LOCKED),
            4 => at.insert(LockedAxes::empty()),
            5 => at.insert(GravityScale(0.2 * size)),
            6 => at.insert(push),
            7 => at.insert(RigidBody::KinematicVelocityBased),
            8 => at.insert(RigidBody::Dynamic),
            9 => at.insert(drag),
            10 => at.insert(AdditionalSolverIterations(size as usize % 3)),
            _ => &mut at,
        };
        match kind {
            ..11 => {}
            11 => {
                let dt = 1.0 / (50.0 + 2.0 * size);
                let mut mode = self.lab.app.world_mut().resource_mut::<TimestepMode>();
                *mode = TimestepMode::Fixed { dt, substeps: 1 };
            }
            16 | 17 => self.lab.set_stepping(kind == 16),
            12 => {
                let mut spring = self.lab.get_mut::<SpringDamper>(spring);
                spring.rest_length = Some(0.5 + 0.1 * size);
            }
            13 => {
                let world = self.lab.app.world_mut();
                let off = Anchors::new(Vec3::ZERO, Vec3::Y * 0.05 * size);
                world.entity_mut(spring).insert(off);
            }
            14 => {
                let world = self.lab.app.world_mut();
                world.entity_mut(spring).remove::<Anchors>();
            }
            _ => {
                let mut velocity = self.lab.get_mut::<Velocity>(ball);
                velocity.angular.x += size;
            }
        }
    }
}

#[test]
fn whatever_happens_to_a_network_it_goes_on_as_one_that_is_read_anew() {
    for seed in 1..=40 {
        let (stiffness, damping) = [(60.0, 0.0), (300.0, 1.0), (2e4, 5.0)][seed % 3];
        let mut alone = Net::new(stiffness, damping);
        let mut touched = Net::new(stiffness, damping);
        let mut dice = [Dice(seed as u64), Dice(seed as u64)];
        for tick in 0..120 {
            let spring = touched.springs[0];
            touched.lab.get_mut::<SpringDamper>(spring).damping = damping;
            for (net, dice) in [&mut alone, &mut touched].into_iter().zip(&mut dice) {
                if tick % 4 == 3 {
                    net.surprise(dice);
                }
                net.lab.tick();
            }
            assert!(
                alone.state() == touched.state(),
                "{stiffness} N/m, seed {seed}, tick {tick}"
            );
        }
    }
}

#[test]
fn what_comes_and_goes_elsewhere_changes_nothing_of_a_network() {
    let exact = CoiloverPlugin::default().with_tolerance(1e-3);
    for plugin in [CoiloverPlugin::default(), exact] {
        let net = || Net::within(Lab::with(plugin, Engine::default()), 300.0, 1.0);
        let (mut quiet, mut busy) = (net(), net());
        let mut guest = None;
        for tick in 0..120 {
            if let Some(guest) = guest.take() {
                busy.lab.app.world_mut().despawn(guest);
            }
            if tick % 3 == 0 {
                let at = |x: f32| Vec3::new(x, 50.0, 0.0);
                let (hook, ball) = (
                    busy.lab.point(at(tick as f32)),
                    busy.lab.body(1.0, at(-3.0)),
                );
                guest = Some(busy.lab.spawn(Spring::new(hook, ball)));
            }
            quiet.lab.tick();
            busy.lab.tick();
            assert!(quiet.state() == busy.state(), "{plugin:?}: tick {tick}");
        }
    }
}

#[test]
fn what_is_changed_while_the_engine_rests_holds_when_it_goes_on() {
    let mut net = Net::new(60.0, 0.4);
    net.lab.run(0.2);
    let pause = |net: &mut Net, active: bool| {
        net.lab.set_stepping(active);
        net.lab.run(0.1);
    };
    pause(&mut net, false);
    for spring in net.springs.clone() {
        net.lab.get_mut::<SpringDamper>(spring).stiffness = 600.0;
    }
    net.lab.run(0.1);
    pause(&mut net, true);
    net.lab.run(1.0);
    // With the old stiffness, the whole net would hang metres lower by Hooke's law.
    let lowest = net.balls.iter().map(|b| net.lab.position(*b).y);
    let lowest = lowest.fold(f32::INFINITY, f32::min);
    assert!(lowest > -5.5, "{lowest} m");
}
