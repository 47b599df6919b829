//! The solver with an engine of a few lines in place of Rapier: bodies in single precision that fly in equal substeps under
//! the velocity and the force that they are given. What it needs of an engine is no more than that.

use super::delivery::{Schedule, force_for};
use super::element::{End, Path};
use super::step::Component;
use super::tests::{element, point};
use super::tolerance::Accuracy;
use bevy::math::{DVec3, Vec3};
use bevy::prelude::default;

const DT: f64 = 1.0 / 60.0;
const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

struct Ball {
    mass: f32,
    position: Vec3,
    velocity: Vec3,
}

/// An engine: what it is to be told is a velocity for the start of a step, and a force over it.
struct OwnEngine {
    balls: Vec<Ball>,
    substeps: u32,
}

impl OwnEngine {
    fn step(&mut self, orders: &[(Vec3, Vec3)]) {
        let h = DT as f32 / self.substeps as f32;
        for (ball, (velocity, force)) in self.balls.iter_mut().zip(orders) {
            ball.velocity = *velocity;
            for _ in 0..self.substeps {
                ball.velocity += h * (GRAVITY.as_vec3() + force / ball.mass);
                ball.position += h * ball.velocity;
            }
        }
    }
}

/// Reads the engine's bodies, solves, and tells the engine; then it steps.
fn tick(engine: &mut OwnEngine, component: &mut Component, accuracy: Accuracy) {
    let read = engine.balls.iter().map(|ball| {
        let mut body = point(f64::from(ball.mass), ball.position.as_dvec3(), GRAVITY);
        body.velocity = ball.velocity.as_dvec3();
        body
    });
    let start: Vec<_> = read.collect();
    component.bodies.clone_from(&start);
    component.advance(DT, accuracy);
    let schedule = Schedule::new(DT, engine.substeps);
    let orders = start.iter().zip(&component.bodies).map(|(start, end)| {
        let displacement = end.position - start.position - DT * start.velocity;
        let delivery = schedule.reach(displacement, end.velocity - start.velocity);
        let force = force_for(delivery.rate - start.acceleration, start.inverse_mass);
        let velocity = start.velocity + delivery.jump;
        (velocity.as_vec3(), force.as_vec3())
    });
    let orders: Vec<_> = orders.collect();
    engine.step(&orders);
}

fn ball(mass: f32, position: Vec3) -> Ball {
    Ball {
        mass,
        position,
        velocity: Vec3::ZERO,
    }
}

fn plain(microsteps: u32) -> Accuracy {
    Accuracy {
        microsteps,
        resolve: 1,
        extrapolate: false,
        tolerance: None,
        max_microsteps: 256,
        max_iterations: 200,
    }
}

/// Rows of a reference file at every tick after the first.
fn reference(text: &str) -> impl Iterator<Item = Vec<f64>> + '_ {
    let row = |line: &str| {
        line.split(',')
            .map(|x| x.parse().expect("a number"))
            .collect()
    };
    text.lines().skip(2).step_by(4).skip(1).map(row)
}

const ORIGIN: End = End::Path(Path::straight(DVec3::ZERO, DVec3::ZERO));

fn body(index: usize) -> End {
    End::Body {
        index,
        arm: DVec3::ZERO,
    }
}

#[test]
fn an_elastic_pendulum_swings_in_any_engine_as_in_rapier() {
    let text = include_str!("../../tests/data/pendulum_k50.csv");
    for substeps in [2, 4, 7] {
        let mut engine = OwnEngine {
            balls: vec![ball(1.0, Vec3::X)],
            substeps,
        };
        let mut component = Component {
            elements: vec![element(ORIGIN, body(0), 50.0, 0.0, 1.0)],
            ..default()
        };
        let mut worst = 0.0_f64;
        for row in reference(text) {
            tick(&mut engine, &mut component, plain(16));
            let wanted = DVec3::new(row[1], row[2], 0.0);
            worst = worst.max(engine.balls[0].position.as_dvec3().distance(wanted));
        }
        // As `elastic_pendulum` asks of Rapier.
        assert!(worst < 5e-5, "{substeps} substeps: {worst} m");
    }
}

#[test]
fn a_chain_swings_in_any_engine_as_in_rapier() {
    let text = include_str!("../../tests/data/chain10_k100_c0.5.csv");
    let mut engine = OwnEngine {
        balls: (1..=10)
            .map(|i| ball(0.1, Vec3::X * 0.2 * i as f32))
            .collect(),
        substeps: 4,
    };
    let mut ends = vec![ORIGIN];
    ends.extend((0..10).map(body));
    let pairs = ends.windows(2);
    let mut component = Component {
        elements: pairs
            .map(|pair| element(pair[0], pair[1], 100.0, 0.5, 0.2))
            .collect(),
        ..default()
    };
    let mut worst = 0.0_f64;
    for row in reference(text).take(60) {
        tick(&mut engine, &mut component, plain(1));
        for (index, at) in [(4, 1), (9, 3)] {
            let wanted = DVec3::new(row[at], row[at + 1], 0.0);
            worst = worst.max(engine.balls[index].position.as_dvec3().distance(wanted));
        }
    }
    assert!(worst < 3.5e-3, "{worst} m");
}
