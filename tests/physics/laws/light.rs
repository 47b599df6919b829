//! Light bodies that springs and stops drive up to the engine's limits of speed and spin. The energy that these limits
//! remove never comes back.

use crate::dice::{Dice, in_turn, seeds, span};
use crate::harness::*;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A random network. Every other body has a mass of about `light` kg. Some springs are off centre, and some have stops.
struct Tangle {
    lab: Lab,
    /// Bodies and their masses, kg.
    bodies: Vec<(Entity, f32)>,
    /// Radius of gyration of every body, m.
    gyration: f32,
}

impl Tangle {
    /// `phase` is ω·dt of each spring between its two bodies, and `stretch` in m is the greatest distance from its rest
    /// length. With a radius of gyration of zero no body turns.
    fn new(seed: u64, kind: [f32; 4], plugin: CoiloverPlugin) -> Self {
        let [light, gyration, phase, stretch] = kind;
        let mut dice = Dice(seed);
        let mut lab = Lab::with(plugin, Engine::weightless());
        let mut bodies = Vec::new();
        for i in 0..4 + dice.pick(5) {
            let at = dice.place();
            let mass = if i % 2 == 0 { 1.0 } else { light } * dice.between(0.5, 2.0);
            let inertia = Vec3::splat(gyration * gyration * mass);
            bodies.push((lab.spawn(brick(mass, inertia, at)), mass));
        }
        let hook = (lab.point(Vec3::Y * 5.0), f32::INFINITY);
        for i in 0..bodies.len() + 2 {
            let a = match i {
                0 => hook,
                _ => bodies[dice.pick(bodies.len() as u32) as usize],
            };
            let b = bodies[i % bodies.len()];
            if a == b {
                continue;
            }
            let omega = 60.0 * phase;
            let stiffness = omega * omega / (1.0 / a.1 + 1.0 / b.1);
            let arm = match dice.pick(2) {
                0 => dice.place() * gyration * 0.5,
                _ => Vec3::ZERO,
            };
            let length = (lab.position(b.0) + arm - lab.position(a.0)).length();
            let rest = (length + stretch * dice.between(-1.0, 1.0)).max(0.5 * stretch);
            let spring = Spring::new(a.0, b.0).with_stiffness(stiffness);
            let spring = lab.spawn((spring.with_rest_length(rest), Anchors::new(Vec3::ZERO, arm)));
            if dice.pick(2) == 0 {
                let ends = [rest - 0.3 * stretch, rest + 0.5 * stretch];
                let travel = SpringTravel::new(ends[0], ends[1], 20.0 * stiffness);
                lab.app.world_mut().entity_mut(spring).insert(travel);
            }
        }
        let mut tangle = Self {
            lab,
            bodies,
            gyration,
        };
        // The bodies are fixed until the stored energy has been read.
        tangle.hold(RigidBody::Fixed);
        tangle.lab.tick();
        tangle
    }

    fn hold(&mut self, kind: RigidBody) {
        for (body, _) in &self.bodies {
            self.lab.app.world_mut().entity_mut(*body).insert(kind);
        }
    }

    fn energy(&mut self) -> f64 {
        let mut sum = 0.0;
        for (body, mass) in &self.bodies {
            let now = self.lab.get::<Velocity>(*body);
            let spin = self.gyration * now.angular;
            sum += 0.5 * f64::from(mass * (now.linear.length_squared() + spin.length_squared()));
        }
        let mut readouts = self.lab.app.world_mut().query::<&SpringReadout>();
        let stored = readouts.iter(self.lab.app.world());
        sum + stored.map(|r| f64::from(r.stored_energy)).sum::<f64>()
    }

    /// Lets the network go. Returns the greatest and the last energy over the first, the greatest spin in rad/s and the
    /// greatest speed in m/s.
    fn let_go(mut self, seconds: f64) -> [f64; 4] {
        let first = self.energy();
        self.hold(RigidBody::Dynamic);
        let mut seen = [0.0_f64; 4];
        for _ in 0..self.lab.ticks(seconds) {
            self.lab.tick();
            let now = self.energy() / first;
            assert!(now.is_finite());
            seen = [seen[0].max(now), now, seen[2], seen[3]];
            for (body, _) in &self.bodies {
                let now = self.lab.get::<Velocity>(*body);
                seen[2] = seen[2].max(now.angular.length().into());
                seen[3] = seen[3].max(now.linear.length().into());
            }
        }
        seen
    }
}

/// Parameters with a stretch that gives speeds of about 3 m/s.
fn mild(light: f32, gyration: f32, phase: f32) -> [f32; 4] {
    [light, gyration, phase, (3.0 / (60.0 * phase)).min(0.5)]
}

#[test]
fn what_spins_as_fast_as_it_may_wins_no_energy() {
    let mut fastest = 0.0_f64;
    for (light, phase) in [(1e-2, 0.3), (1e-2, 2.0), (1e-4, 5.0), (1e-4, 20.0)] {
        let mut most = 0.0_f64;
        for seed in seeds(0..24) {
            let tangle = Tangle::new(seed, mild(light, 0.2, phase), CoiloverPlugin::default());
            let [here, _, spin, _] = tangle.let_go(span(10.0));
            most = most.max(here);
            fastest = fastest.max(spin);
        }
        println!(
            "tangles, every other body of {light:e} kg, ω·dt {phase}: at most {most:.3} of the energy"
        );
        assert!(most < 1.05, "{most}");
    }
    // The engine limits spin to an eighth of a turn in a step, which is 47.1 rad/s.
    assert!(fastest > 47.0, "{fastest} rad/s");
}

/// The engine may limit a spin in the very step in which it becomes energy of a spring, so a short excess is allowed.
#[test]
fn at_any_setting_too_much_lasts_no_longer_than_a_moment() {
    let plugin = CoiloverPlugin::default;
    let settings = [
        ("4 micro-steps", plugin().with_microsteps(4)),
        ("extrapolated", plugin().with_extrapolation()),
        ("tolerance 1e-2", plugin().with_tolerance(1e-2)),
    ];
    let mut cases = Vec::new();
    for setting in settings {
        for kind in [(1e-2, 2.0), (1e-4, 0.3), (1e-4, 20.0)] {
            cases.push((setting, kind));
        }
    }
    for ((name, plugin), (light, phase)) in in_turn(cases) {
        let (mut most, mut last) = (0.0_f64, 0.0_f64);
        for seed in seeds(104..120) {
            let tangle = Tangle::new(seed, mild(light, 0.05, phase), plugin);
            let [here, end, ..] = tangle.let_go(3.0);
            (most, last) = (most.max(here), last.max(end));
        }
        println!(
            "tangles, {light:e} kg, ω·dt {phase}, {name}: at most {most:.3} of the energy, {last:.3} in the end"
        );
        assert!(most < 1.25 && last < 1.05, "{most}, {last}");
    }
}

#[test]
fn what_flies_as_fast_as_it_may_wins_no_energy() {
    for microsteps in [1, 4] {
        let (mut most, mut fastest) = (0.0_f64, 0.0_f64);
        for seed in seeds(0..24) {
            let plugin = CoiloverPlugin::default().with_microsteps(microsteps);
            let tangle = Tangle::new(seed, [1e-2, 0.0, 100.0, 3.0], plugin);
            let [here, _, _, speed] = tangle.let_go(3.0);
            (most, fastest) = (most.max(here), fastest.max(speed));
        }
        println!(
            "tangles, {microsteps} micro-steps: {fastest:.0} m/s, at most {most:.3} of the energy"
        );
        assert!(most < 1.05, "{most}");
        assert!(fastest > 399.0, "{fastest} m/s");
    }
}

#[test]
fn a_lone_spring_that_would_fling_its_body_faster_than_it_may_fly_wins_no_energy() {
    for (with_law, microsteps) in [(false, 1), (false, 4), (true, 1), (true, 4)] {
        let (mut most, mut fastest) = (0.0_f64, 0.0_f32);
        for phase in [0.5_f32, 1.0, 2.0, 3.1, 5.0, 20.0] {
            for speed in [410.0, 650.0, 1000.0] {
                let plugin = CoiloverPlugin::default().with_microsteps(microsteps);
                let mut lab = Lab::with(plugin, Engine::weightless());
                let k = (60.0 * phase).powi(2);
                // Stretch that would give this speed at rest length. The engine allows 400 m/s.
                let out = speed / k.sqrt();
                let hook = lab.point(Vec3::ZERO);
                let ball = lab.body(1.0, Vec3::X * (20.0 + out));
                let spring = Spring::new(hook, ball)
                    .with_stiffness(k)
                    .with_rest_length(20.0);
                if with_law {
                    lab.spawn((spring, SpringLaw::polynomial(k, 0.0, 1e-3 * k)));
                } else {
                    lab.spawn(spring);
                }
                let stored = |x: f32| {
                    let x = f64::from(x) - 20.0;
                    let cubic = if with_law { 2.5e-4 } else { 0.0 };
                    f64::from(k) * (0.5 * x * x + cubic * x.powi(4))
                };
                let first = stored(20.0 + out);
                for _ in 0..lab.ticks(span(10.0)) {
                    lab.tick();
                    let speed = lab.get::<Velocity>(ball).linear.length();
                    let motion = 0.5 * f64::from(speed).powi(2);
                    most = most.max((motion + stored(lab.position(ball).length())) / first);
                    fastest = fastest.max(speed);
                }
            }
        }
        println!(
            "lone springs, law {with_law}, {microsteps} micro-steps: {fastest:.0} m/s, at most {most:.3} of the energy"
        );
        assert!(most < 1.05, "{most}");
    }
}
