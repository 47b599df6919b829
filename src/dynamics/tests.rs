//! Tests the step against reference trajectories and conservation laws, without an engine.

use super::body::{Body, Spin};
use super::delivery::{Delivery, Schedule, Spinning};
use super::element::{Element, End, Path};
use super::guide::Guide;
use super::step::Component;
use super::tolerance::Accuracy;
use crate::backend::rapier::rotation::turn;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::default;
use std::cell::Cell;

/// Time step of a game, s.
pub(super) const DT: f64 = 1.0 / 60.0;

pub(crate) fn point(mass: f64, position: DVec3, gravity: DVec3) -> Body {
    Body {
        position,
        velocity: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        spin: Spin::Ignored,
        inverse_mass: DVec3::splat(1.0 / mass),
        inertia: DVec3::ONE,
        principal: DQuat::IDENTITY,
        rotation_locked: [false; 3],
        farthest_turn: f64::INFINITY,
        acceleration: gravity,
        torque: DVec3::ZERO,
        given: (DVec3::ZERO, DVec3::ZERO),
        torque_work: 0.0,
        turned: None,
    }
}

pub(super) fn turning(mut body: Body, inertia: DVec3, velocity: DVec3) -> Body {
    body.inertia = inertia;
    body.spin = Spin::Free {
        momentum: DVec3::ZERO,
    };
    body.set_angular_velocity(velocity);
    body
}

pub(crate) fn element(a: End, b: End, stiffness: f64, damping: f64, rest_length: f64) -> Element {
    Element {
        ends: [a, b],
        stiffness,
        damping,
        rest_length,
        guide: Guide::Centres,
        law: None,
        angle: 0.0,
        heat: 0.0,
        work: 0.0,
        direction: None,
        stiff_damper: false,
    }
}

pub(super) fn fixed(position: DVec3) -> End {
    End::Path(Path::straight(position, DVec3::ZERO))
}

pub(super) fn held(index: usize, arm: DVec3) -> End {
    End::Body { index, arm }
}

/// Bodies of which each is joined to the next, centre to centre, by a spring of this stiffness (N/m) and 1 m.
pub(crate) fn row(bodies: Vec<Body>, stiffness: f64) -> Component {
    let ends = (1..bodies.len()).map(|at| [at - 1, at].map(|index| held(index, DVec3::ZERO)));
    let elements = ends.map(|[a, b]| element(a, b, stiffness, 0.0, 1.0));
    Component {
        elements: elements.collect(),
        bodies,
        ..default()
    }
}

fn accuracy(microsteps: u32, extrapolate: bool) -> Accuracy {
    Accuracy {
        resolve: 1,
        extrapolate,
        ..Accuracy::exactly(microsteps)
    }
}

/// Rows of a reference file: t and the columns after it, one row every 1/240 s.
fn reference(text: &str) -> Vec<Vec<f64>> {
    text.lines()
        .skip(2)
        .map(|l| l.split(',').map(|x| x.parse().expect("a number")).collect())
        .collect()
}

fn pendulum_error(file: &str, k: f64, c: f64, accuracy: Accuracy) -> f64 {
    let g = DVec3::new(0.0, -9.81, 0.0);
    let mut pendulum = Component {
        bodies: vec![point(1.0, DVec3::X, g)],
        elements: vec![element(fixed(DVec3::ZERO), held(0, DVec3::ZERO), k, c, 1.0)],
        ..default()
    };
    let rows = reference(file);
    let mut worst = 0.0_f64;
    for row in rows.iter().step_by(4).skip(1) {
        pendulum.advance(DT, accuracy);
        let p = pendulum.bodies[0].position;
        worst = worst.max((p - DVec3::new(row[1], row[2], 0.0)).length());
    }
    worst
}

#[test]
fn elastic_pendulum_follows_the_reference_at_each_setting() {
    let soft = include_str!("../../tests/data/pendulum_k50.csv");
    let damped = include_str!("../../tests/data/pendulum_k500_c5.csv");
    let stiff = include_str!("../../tests/data/pendulum_k50000_c100.csv");
    for (file, k, c, setting, bar) in [
        (soft, 50.0, 0.0, accuracy(1, false), 1.5e-3),
        (soft, 50.0, 0.0, accuracy(16, false), 1e-5),
        (soft, 50.0, 0.0, accuracy(1, true), 1e-6),
        (damped, 500.0, 5.0, accuracy(1, false), 3.5e-3),
        (damped, 500.0, 5.0, accuracy(16, false), 1.5e-5),
        (damped, 500.0, 5.0, accuracy(1, true), 1e-5),
        (stiff, 5e4, 100.0, accuracy(1, false), 1.5e-3),
        (stiff, 5e4, 100.0, accuracy(16, false), 1e-5),
        (stiff, 5e4, 100.0, accuracy(1, true), 5e-4),
    ] {
        let error = pendulum_error(file, k, c, setting);
        assert!(error < bar, "k {k} c {c} {setting:?}: {error:.3e} m");
    }
}

/// Two spinning bricks of different size, connected at corners.
fn dumbbell(stiffness: f64) -> Component {
    let a = point(2.0, DVec3::ZERO, DVec3::ZERO);
    let mut b = point(0.5, DVec3::new(2.0, 0.3, -0.1), DVec3::ZERO);
    b.velocity = DVec3::new(0.0, 1.0, 0.5);
    Component {
        bodies: vec![
            turning(a, DVec3::new(0.2, 0.3, 0.45), DVec3::new(1.0, -2.0, 0.5)),
            turning(b, DVec3::new(0.02, 0.05, 0.06), DVec3::new(-1.0, 0.5, 3.0)),
        ],
        elements: vec![element(
            held(0, DVec3::new(0.4, 0.2, 0.1)),
            held(1, DVec3::new(-0.3, 0.1, 0.2)),
            stiffness,
            0.0,
            1.0,
        )],
        ..default()
    }
}

fn momenta(c: &Component) -> (DVec3, DVec3) {
    let mut linear = DVec3::ZERO;
    let mut angular = DVec3::ZERO;
    for b in &c.bodies {
        let p = b.velocity / b.inverse_mass;
        linear += p;
        angular += b.position.cross(p);
        if let Spin::Free { momentum } = b.spin {
            angular += momentum;
        }
    }
    (linear, angular)
}

fn energy(c: &Component) -> f64 {
    let kinetic: f64 = c
        .bodies
        .iter()
        .map(|b| {
            let spin = match b.spin {
                Spin::Free { momentum } => momentum.dot(b.angular_velocity()),
                _ => 0.0,
            };
            0.5 * ((b.velocity / b.inverse_mass).dot(b.velocity) + spin)
        })
        .sum();
    let stored: f64 = c
        .elements
        .iter()
        .map(|e| {
            let line = e.line(&c.bodies).expect("apart");
            0.5 * e.stiffness * (line.length - e.rest_length).powi(2)
        })
        .sum();
    kinetic + stored
}

#[test]
fn spinning_pair_with_corner_anchors_keeps_momentum_and_energy() {
    // The error oscillates, with an amplitude of order (ω dt)², and does not grow. Here ω dt is 0.16 and 0.5.
    for (k, bar) in [(20.0, 2e-3), (200.0, 4e-2)] {
        let mut pair = dumbbell(k);
        let (p0, l0) = momenta(&pair);
        let e0 = energy(&pair);
        let mut worst = 0.0_f64;
        for _ in 0..600 {
            pair.advance(DT, accuracy(1, false));
            worst = worst.max((energy(&pair) / e0 - 1.0).abs());
        }
        let (p1, l1) = momenta(&pair);
        assert!(
            (p1 - p0).length() < 1e-10 && (l1 - l0).length() < 1e-9,
            "{:?}",
            l1 - l0
        );
        assert!(worst < bar, "k {k}: energy {worst:.2e}");
    }
}

#[test]
fn spinning_pair_converges_at_second_order_and_fourth_when_extrapolated() {
    let end = |setting| {
        let mut pair = dumbbell(50.0);
        for _ in 0..120 {
            pair.advance(DT, setting);
        }
        pair.bodies[1].position
    };
    let exact = end(accuracy(64, true));
    let error = |n, x| (end(accuracy(n, x)) - exact).length();
    // From two on, for an element without a damper takes no fewer.
    let (two, four, eight) = (error(2, false), error(4, false), error(8, false));
    assert!((3.7..4.3).contains(&(two / four)), "{two:.2e} {four:.2e}");
    assert!(
        (3.8..4.2).contains(&(four / eight)),
        "{four:.2e} {eight:.2e}"
    );
    // Extrapolated, only these two: with eight the error, 5e-8 m, is that of the engine's rotations in f32.
    let (x2, x4) = (error(2, true), error(4, true));
    assert!(x2 / x4 > 13.0, "{x2:.2e} {x4:.2e}");
}

thread_local! {
    /// Number of calls of [`counted`].
    static RUNS: Cell<u32> = const { Cell::new(0) };
}

/// The engine's rule for rotation. Counts its calls.
fn counted(spinning: &Spinning, spin: DVec3, delivery: &Delivery) -> (DQuat, DVec3) {
    RUNS.set(RUNS.get() + 1);
    turn(spinning, spin, delivery)
}

#[test]
fn engine_substeps_reach_the_state_that_was_ordered() {
    let mut pair = dumbbell(500.0);
    let before = pair.bodies.clone();
    pair.advance(DT, accuracy(4, false));
    for n in [2, 4, 7, 32] {
        let s = Schedule::new(DT, n, 1);
        for (start, end) in before.iter().zip(&pair.bodies) {
            let d = s.reach(
                end.position - start.position - s.time * start.velocity,
                end.velocity - start.velocity,
            );
            let h = DT / f64::from(n);
            let (mut x, mut v) = (start.position, start.velocity + d.jump);
            for _ in 0..n {
                v += h * d.rate;
                x += h * v;
            }
            assert!((x - end.position).length() < 1e-13 && (v - end.velocity).length() < 1e-11);
            for gyroscopic in [true, false] {
                RUNS.set(0);
                let d = s.angular(start, gyroscopic, end, counted);
                // The prediction is good enough for a body that turns as little as most do.
                let turned = (end.rotation * start.rotation.inverse()).to_scaled_axis();
                let most = if turned.length() < 0.05 { 2 } else { 5 };
                assert!(RUNS.get() <= most, "n {n}: {} runs", RUNS.get());
                let spinning = Spinning {
                    schedule: &s,
                    body: start,
                    gyroscopic,
                };
                let (r, w) = turn(&spinning, start.angular_velocity(), &d);
                let apart = (r.inverse() * end.rotation).xyz().length();
                assert!(apart < 1e-6, "n {n}: {apart:.1e}");
                let missed = (w - end.angular_velocity()).length();
                assert!(missed < 3e-5, "n {n}: {missed:.1e}");
            }
        }
    }
}

fn network_error(file: &str, points: &[usize], mut net: Component, setting: Accuracy) -> f64 {
    let rows = reference(file);
    let mut worst = 0.0_f64;
    for row in rows.iter().step_by(4).skip(1).take(60) {
        net.advance(DT, setting);
        for (i, p) in points.iter().enumerate() {
            let wanted = DVec3::new(row[1 + 2 * i], row[2 + 2 * i], 0.0);
            worst = worst.max((net.bodies[*p].position - wanted).length());
        }
    }
    worst
}

#[test]
fn chain_of_ten_swings_as_the_reference() {
    let g = DVec3::new(0.0, -9.81, 0.0);
    let file = include_str!("../../tests/data/chain10_k100_c0.5.csv");
    let chain = || Component {
        bodies: (1..=10)
            .map(|i| point(0.1, DVec3::X * 0.2 * f64::from(i), g))
            .collect(),
        elements: (0..10)
            .map(|i: usize| {
                let a = if i == 0 {
                    fixed(DVec3::ZERO)
                } else {
                    held(i - 1, DVec3::ZERO)
                };
                element(a, held(i, DVec3::ZERO), 100.0, 0.5, 0.2)
            })
            .collect(),
        ..default()
    };
    let error = |setting| network_error(file, &[4, 9], chain(), setting);
    let (one, four, extrapolated) = (
        error(accuracy(1, false)),
        error(accuracy(4, false)),
        error(accuracy(2, true)),
    );
    assert!(one < 4e-3, "{one:.2e}");
    assert!(four < 3e-4, "{four:.2e}");
    assert!(extrapolated < 1e-5, "{extrapolated:.2e}");
}

#[test]
fn damped_chain_of_a_thousand_to_one_masses_settles_at_any_stiffness() {
    let g = DVec3::new(0.0, -9.81, 0.0);
    for k in [1e4_f64, 1e6, 1e8] {
        let masses = [1.0, 1e-3, 1.0, 1e3];
        let mut net = Component {
            bodies: masses
                .iter()
                .enumerate()
                .map(|(i, m)| point(*m, DVec3::NEG_Y * (i + 1) as f64, g))
                .collect(),
            elements: (0..4)
                .map(|i: usize| {
                    let a = if i == 0 {
                        fixed(DVec3::ZERO)
                    } else {
                        held(i - 1, DVec3::ZERO)
                    };
                    element(a, held(i, DVec3::ZERO), k, 0.6 * (k * 1e3).sqrt(), 1.0)
                })
                .collect(),
            ..default()
        };
        for _ in 0..6000 {
            net.advance(DT, accuracy(1, false));
        }
        let sag: f64 = (0..4)
            .map(|i| masses[i..].iter().sum::<f64>() * 9.81 / k)
            .sum();
        let low = -net.bodies[3].position.y;
        assert!(
            (low - 4.0 - sag).abs() < 1e-3 * sag + 1e-9,
            "k {k}: {low} against {}",
            4.0 + sag
        );
    }
}

/// The chain is so long that it is solved by iterations, which start from the last solution.
#[test]
fn a_network_goes_on_after_a_step_that_was_no_number() {
    let chain = || {
        let at = |i: usize| DVec3::X * (i + 1) as f64;
        let mut ends = vec![fixed(DVec3::ZERO)];
        ends.extend((0..40).map(|i| held(i, DVec3::ZERO)));
        Component {
            bodies: (0..40).map(|i| point(1.0, at(i), DVec3::NEG_Y)).collect(),
            elements: ends
                .windows(2)
                .map(|pair| element(pair[0], pair[1], 2e4, 1.0, 1.0))
                .collect(),
            ..default()
        }
    };
    let mut component = chain();
    component.advance(DT, accuracy(1, false));
    assert!(component.is_finite());
    component.bodies[7].velocity = DVec3::NAN;
    component.advance(DT, accuracy(1, false));
    assert!(!component.is_finite());
    component.bodies = chain().bodies;
    component.elements = chain().elements;
    component.forget();
    component.advance(DT, accuracy(1, false));
    assert!(component.is_finite());
}
