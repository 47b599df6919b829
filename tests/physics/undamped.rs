//! Do undamped motions keep their energy for long? `COILOVER_HOURS=1 cargo test --test physics undamped --
//! --nocapture` simulates an hour. Without the variable, it is a minute.

use crate::harness::*;
use bevy::math::DMat3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;

/// A body, its mass, kg, and its principal inertia, kg m².
type Part = (Entity, f32, Vec3);

struct Scene {
    lab: Lab,
    bodies: Vec<Part>,
    springs: Vec<Entity>,
    gravity: f64,
    /// Energy at rest, J.
    rest: f64,
}

impl Scene {
    fn energy(&self) -> f64 {
        let lab = &self.lab;
        let stored = |spring: &Entity| f64::from(lab.readout(*spring).stored_energy);
        let of = |&(body, mass, inertia): &Part| {
            let at = lab.get::<Transform>(body);
            let velocity = lab.get::<Velocity>(body);
            let turn = DMat3::from_quat(at.rotation.as_dquat().normalize());
            let spin = turn.transpose() * velocity.angular.as_dvec3();
            let turning = 0.5 * (inertia.as_dvec3() * spin).dot(spin);
            let mass = f64::from(mass);
            let moving = 0.5 * mass * velocity.linear.as_dvec3().length_squared();
            moving + turning + mass * self.gravity * f64::from(at.translation.y)
        };
        self.springs.iter().map(stored).sum::<f64>() + self.bodies.iter().map(of).sum::<f64>()
            - self.rest
    }

    /// Averages the energy of motion over intervals of two seconds. Returns the last average and the one that
    /// deviates most, as a fraction of the energy after the first tick.
    fn watch(&mut self, seconds: f64) -> (f64, f64) {
        self.lab.tick();
        let first = self.energy();
        let mut means = Vec::new();
        for _ in 0..(seconds / 2.0) as usize {
            let mut sum = 0.0;
            for _ in 0..120 {
                self.lab.tick();
                sum += self.energy();
            }
            means.push(sum / 120.0);
        }
        let mut relative = means.iter().map(|mean| mean / first);
        let far = |a: f64, b: f64| {
            if (b - 1.0).abs() > (a - 1.0).abs() {
                b
            } else {
                a
            }
        };
        let farthest = relative.clone().fold(1.0, far);
        (relative.next_back().unwrap_or(1.0), farthest)
    }
}

fn spring(lab: &mut Lab, a: Entity, b: Entity, anchors: [Vec3; 2], k: f32, rest: f32) -> Entity {
    lab.spawn((
        Spring::new(a, b).with_stiffness(k).with_rest_length(rest),
        Anchors::new(anchors[0], anchors[1]),
    ))
}

/// A weight of 1 kg on 50 N/m, released from the side.
fn pendulum(plugin: CoiloverPlugin) -> Scene {
    let mut lab = Lab::with(plugin, Engine::default());
    let hook = lab.point(Vec3::ZERO);
    let bob = lab.body(1.0, Vec3::new(0.6, -1.0, 0.0));
    let springs = vec![spring(&mut lab, hook, bob, [Vec3::ZERO; 2], 50.0, 1.0)];
    let sag = GRAVITY / 50.0;
    let rest = 0.5 * GRAVITY * sag - GRAVITY * (1.0 + sag);
    Scene {
        lab,
        bodies: vec![(bob, 1.0, Vec3::splat(0.4))],
        springs,
        gravity: GRAVITY,
        rest,
    }
}

/// A box of 12 kg on four springs of 900 N/m from its corners to hooks above. Its initial velocity makes it
/// bounce, roll and yaw.
fn box_on_four(plugin: CoiloverPlugin) -> Scene {
    let mut lab = Lab::with(plugin, Engine::default());
    let half = Vec3::new(0.5, 0.2, 0.3);
    let mass = 12.0;
    let inertia = mass / 3.0 * Vec3::new(0.04 + 0.09, 0.25 + 0.09, 0.25 + 0.04);
    let sag = GRAVITY * f64::from(mass) / 3600.0;
    let below = 0.8 + sag as f32;
    let place = Vec3::NEG_Y * (below + half.y);
    let velocity = Velocity {
        linear: Vec3::new(0.2, 0.5, 0.1),
        angular: Vec3::new(0.8, 0.5, 0.6),
    };
    let body = lab.moving(brick(mass, inertia, place), velocity);
    let world = lab.point(Vec3::ZERO);
    let springs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, z)| {
        let corner = half * Vec3::new(x, 1.0, z);
        spring(
            &mut lab,
            world,
            body,
            [Vec3::new(corner.x, 0.0, corner.z), corner],
            900.0,
            0.8,
        )
    });
    let rest = 0.5 * GRAVITY * f64::from(mass) * sag + GRAVITY * f64::from(mass * place.y);
    Scene {
        lab,
        bodies: vec![(body, mass, inertia)],
        springs: springs.to_vec(),
        gravity: GRAVITY,
        rest,
    }
}

/// Two tumbling bricks with one spring between their corners.
fn dumbbell(plugin: CoiloverPlugin) -> Scene {
    let mut lab = Lab::with(plugin, Engine::weightless());
    let inertia = Vec3::new(0.02, 0.03, 0.04);
    let mut brick_at = |x: f32, spin: Vec3, v: Vec3| {
        let velocity = Velocity {
            linear: v,
            angular: spin,
        };
        lab.moving(brick(1.0, inertia, Vec3::X * x), velocity)
    };
    let a = brick_at(-0.5, Vec3::new(1.0, 2.0, 0.5), Vec3::Y);
    let b = brick_at(0.5, Vec3::new(-0.5, 1.0, 2.0), Vec3::NEG_Y);
    let corner = Vec3::new(0.1, 0.05, 0.02);
    let springs = vec![spring(&mut lab, a, b, [corner, -corner], 100.0, 0.6)];
    Scene {
        lab,
        bodies: vec![(a, 1.0, inertia), (b, 1.0, inertia)],
        springs,
        gravity: 0.0,
        rest: 0.0,
    }
}

fn seconds() -> f64 {
    let hours = std::env::var("COILOVER_HOURS")
        .ok()
        .and_then(|text| text.parse::<f64>().ok());
    hours.map_or(60.0, |hours| 3600.0 * hours)
}

type Make = fn(CoiloverPlugin) -> Scene;
const SCENES: [(&str, Make); 3] = [
    ("pendulum", pendulum),
    ("box on four springs", box_on_four),
    ("tumbling dumbbell", dumbbell),
];

#[test]
fn what_nothing_brakes_keeps_its_energy() {
    let seconds = seconds();
    let mut lost = Vec::new();
    for (title, make) in SCENES {
        for (how, plugin) in [
            ("by default", CoiloverPlugin::default()),
            (
                "extrapolated",
                CoiloverPlugin::default().with_extrapolation(),
            ),
        ] {
            let mut scene = make(plugin);
            let first = scene.energy();
            let (last, farthest) = scene.watch(seconds);
            println!(
                "{title}, {how}, {seconds} s: {last:.5} of its energy ({first:.3} J), farthest {farthest:.5}"
            );
            if (farthest - 1.0).abs() > 0.01 {
                lost.push(format!("{title}, {how}: {farthest}"));
            }
        }
    }
    assert!(lost.is_empty(), "{lost:?}");
}
