//! Simulates an hour without damping with the integrator alone. Measures how much energy it conserves by itself, and how
//! much an engine's single precision costs. `COILOVER_HOURS=1 cargo test --release --lib undamped -- --nocapture`
//! simulates the hour; without the variable it is two minutes.

use super::body::{Body, Spin};
use super::element::{End, Path};
use super::energy::Energy;
use super::step::Component;
use super::tests::{element, point, turning};
use super::tolerance::Accuracy;
use bevy::math::DVec3;
use bevy::prelude::default;

const DT: f64 = 1.0 / 60.0;
const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// A box of 12 kg on four springs of 900 N/m from its corners to hooks above, as in the test of the same name with
/// Rapier.
fn box_on_four() -> Component {
    let half = DVec3::new(0.5, 0.2, 0.3);
    let inertia = 4.0 * DVec3::new(0.04 + 0.09, 0.25 + 0.09, 0.25 + 0.04);
    let place = DVec3::NEG_Y * (0.8 + 9.81 * 12.0 / 3600.0 + half.y);
    let mut body = point(12.0, place, GRAVITY);
    body.velocity = DVec3::new(0.2, 0.5, 0.1);
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
    Component {
        bodies: vec![turning(body, inertia, DVec3::new(0.8, 0.5, 0.6))],
        elements: elements.to_vec(),
        ..default()
    }
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
fn means(mut component: Component, accuracy: Accuracy, rounded: bool, parts: usize) -> Vec<f64> {
    let mut still = component.clone();
    still.bodies[0].velocity = DVec3::ZERO;
    still.bodies[0].set_angular_velocity(DVec3::ZERO);
    let rest = energy(&still);
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

#[test]
fn the_solver_alone_keeps_the_energy_of_a_box_on_four_springs() {
    let accuracy = |microsteps, extrapolate| Accuracy {
        resolve: 1024,
        extrapolate,
        ..Accuracy::exactly(microsteps)
    };
    for (title, accuracy, rounded, bar) in [
        ("by default", accuracy(1, false), false, 1e-4),
        ("by default, rounded", accuracy(1, false), true, 2e-3),
        ("with four micro-steps", accuracy(4, false), false, 1e-4),
        // Richardson extrapolation is not symplectic: it loses 0.8 % in an hour.
        ("extrapolated", accuracy(1, true), false, 1e-2),
    ] {
        let means = means(box_on_four(), accuracy, rounded, 6);
        println!("{title}, {} s: {means:.5?}", seconds());
        for mean in &means {
            assert!((mean - 1.0).abs() < bar, "{title}: {means:?}");
        }
    }
}
