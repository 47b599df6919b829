//! Simulates an hour without damping with the integrator alone. Measures how much energy it conserves by itself, and how
//! much an engine's single precision costs. `COILOVER_HOURS=1 cargo test --release --lib undamped -- --nocapture`
//! simulates the hour; without the variable it is two minutes.

use super::body::{Body, Spin};
use super::element::{End, Path};
use super::energy::Energy;
use super::step::Component;
use super::tests::{DT, element, held, point, turning};
use super::tolerance::Accuracy;
use bevy::math::DVec3;
use bevy::prelude::default;

const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// A component, and its energy at rest, J.
type Scene = (Component, f64);

/// A box of 12 kg on four springs of 900 N/m from its corners to hooks above, as in the test of the same name with
/// Rapier.
fn box_on_four() -> Scene {
    let half = DVec3::new(0.5, 0.2, 0.3);
    let inertia = 4.0 * DVec3::new(0.04 + 0.09, 0.25 + 0.09, 0.25 + 0.04);
    let place = DVec3::NEG_Y * (0.8 + 9.81 * 12.0 / 3600.0 + half.y);
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let elements = corners.map(|(x, z)| {
        let arm = half * DVec3::new(x, 1.0, z);
        let hook = Path::straight(DVec3::new(arm.x, 0.0, arm.z), DVec3::ZERO);
        element(
            End::Path(hook),
            End::Body { index: 0, arm },
            900.0,
            0.0,
            0.8,
        )
    });
    let mut component = Component {
        bodies: vec![turning(point(12.0, place, GRAVITY), inertia, DVec3::ZERO)],
        elements: elements.to_vec(),
        ..default()
    };
    let still = energy(&component);
    component.bodies[0].velocity = DVec3::new(0.2, 0.5, 0.1);
    component.bodies[0].set_angular_velocity(DVec3::new(0.8, 0.5, 0.6));
    (component, still)
}

/// Two tumbling bricks of 1 kg with one spring of 100 N/m between their corners, as in the test of the same name with
/// Rapier.
fn dumbbell() -> Scene {
    let brick = |x: f64, velocity: DVec3, spin: DVec3| {
        let mut body = point(1.0, DVec3::X * x, DVec3::ZERO);
        body.velocity = velocity;
        turning(body, DVec3::new(0.02, 0.03, 0.04), spin)
    };
    let arm = DVec3::new(0.1, 0.05, 0.02);
    let moving = Component {
        bodies: vec![
            brick(-0.5, DVec3::Y, DVec3::new(1.0, 2.0, 0.5)),
            brick(0.5, DVec3::NEG_Y, DVec3::new(-0.5, 1.0, 2.0)),
        ],
        elements: vec![element(held(0, arm), held(1, -arm), 100.0, 0.0, 0.6)],
        ..default()
    };
    (moving, 0.0)
}

fn energy(component: &Component) -> f64 {
    Energy::of(&component.elements, &component.bodies).sum()
}

/// Rounds a body to single precision and back, as an engine stores it.
fn round(body: &mut Body) {
    let rotation = body.rotation.as_quat().normalize().as_dquat().normalize();
    let spin = body.angular_velocity().as_vec3().as_dvec3();
    body.position = body.position.as_vec3().as_dvec3();
    body.velocity = body.velocity.as_vec3().as_dvec3();
    body.rotation = rotation;
    body.turned = None;
    if body.spin != Spin::Ignored {
        body.set_angular_velocity(spin);
    }
}

/// Mean energy above rest in each of `parts` equal periods, divided by that in the first.
fn means(scene: Scene, accuracy: Accuracy, rounded: bool, parts: usize) -> Vec<f64> {
    let (mut component, rest) = scene;
    let ticks = (seconds() / DT) as usize / parts;
    let mut means = Vec::new();
    for _ in 0..parts {
        let mut sum = 0.0;
        for _ in 0..ticks {
            for body in &mut component.bodies {
                body.given = default();
                body.torque_work = 0.0;
            }
            component.advance(DT, accuracy);
            if rounded {
                component.bodies.iter_mut().for_each(round);
            }
            sum += energy(&component) - rest;
        }
        means.push(sum / ticks as f64);
    }
    means.iter().map(|mean| mean / means[0]).collect()
}

fn seconds() -> f64 {
    let hours = std::env::var("COILOVER_HOURS")
        .ok()
        .and_then(|text| text.parse::<f64>().ok());
    hours.map_or(120.0, |hours| 3600.0 * hours)
}

fn accuracy(microsteps: u32, extrapolate: bool) -> Accuracy {
    Accuracy {
        resolve: 1024,
        extrapolate,
        ..Accuracy::exactly(microsteps)
    }
}

/// Prints the means of a scene, and checks that none differs from one by more than the bar of its accuracy.
fn keeps_its_energy(scene: fn() -> Scene, bars: [f64; 4]) {
    let cases = [
        ("by default", accuracy(1, false), false),
        ("by default, rounded", accuracy(1, false), true),
        ("with four micro-steps", accuracy(4, false), false),
        ("extrapolated", accuracy(1, true), false),
    ];
    for ((title, accuracy, rounded), bar) in cases.into_iter().zip(bars) {
        let means = means(scene(), accuracy, rounded, 6);
        println!("{title}, {} s: {means:.5?}", seconds());
        for mean in &means {
            assert!((mean - 1.0).abs() < bar, "{title}: {means:?}");
        }
    }
}

#[test]
fn the_solver_alone_keeps_the_energy_of_a_box_on_four_springs() {
    // Richardson extrapolation is not symplectic: it loses 0.8 % in an hour.
    keeps_its_energy(box_on_four, [1e-4, 2e-3, 1e-4, 1e-2]);
}

#[test]
fn the_solver_alone_keeps_the_energy_of_a_tumbling_dumbbell() {
    keeps_its_energy(dumbbell, [5e-3, 5e-3, 1e-3, 1e-3]);
}

/// A lone kick on turning bodies is exact along the line, but it is not symplectic: its correction for the turning of the line
/// depends on velocities, and its stiffness on the inertia that the line meets. Chaotic motion makes a random walk of that.
#[test]
fn the_energy_of_a_dumbbell_that_tumbles_chaotically_wanders_little() {
    let wander = |start: u32| {
        let (mut moving, rest) = dumbbell();
        moving.bodies[0].velocity.x += 1e-7 * f64::from(start);
        let means = means((moving, rest), accuracy(1, false), false, 30);
        let far = means.iter().map(|mean| (mean - 1.0).abs());
        far.fold(0.0, f64::max)
    };
    let mut wanders: Vec<f64> = (0..32).map(wander).collect();
    wanders.sort_by(f64::total_cmp);
    let [median, most] = [wanders[16], wanders[31]];
    let few = wanders.iter().filter(|far| **far < 0.01).count();
    println!(
        "{} s, 32 starts: {few} within 1 %, median {median:.5}, most {most:.5}",
        seconds()
    );
    assert!(most < 0.005, "{wanders:?}");
}
