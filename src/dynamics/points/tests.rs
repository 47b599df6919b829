//! Compares point masses with rigid bodies that do not turn. Both must take the same step except for rounding.

use super::parts::places;
use super::*;
use crate::dynamics::dice::Dice;
use crate::dynamics::element::Path;
use crate::dynamics::energy::Energy;
use crate::dynamics::step::Component;
use crate::dynamics::tests;
use crate::threads::{self, PIECE};
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};

/// A sheet of slightly displaced bodies that hangs from moving points.
fn sheet(stiffness: f64, damping: f64) -> Component {
    let mut dice = Dice(7);
    let (columns, rows) = (7, 6);
    let mut sheet = Component::default();
    let mut element = |a: End, b: End, rest_length: f64| {
        let new = tests::element(a, b, stiffness, damping, rest_length);
        sheet.elements.push(new);
    };
    for i in 0..columns * rows {
        let (x, y) = (i % columns, i / columns);
        let at = DVec3::new(x as f64, -(y as f64), 0.0) + dice.vector(0.2);
        let mass = 0.5 + dice.number();
        let gravity = DVec3::new(0.0, -9.81, 0.0);
        let body = Body {
            velocity: dice.vector(1.0),
            ..tests::point(mass, at, gravity)
        };
        let own = |index| tests::held(index, DVec3::ZERO);
        if y == 0 {
            let hook = Path::straight(at + DVec3::Y, dice.vector(1.0));
            element(End::Path(hook), own(i), 0.8);
        } else {
            element(own(i - columns), own(i), 1.1);
        }
        if x > 0 {
            // Some elements have zero rest length.
            element(own(i - 1), own(i), if y == 2 { 0.0 } else { 0.9 });
        }
        sheet.bodies.push(body);
    }
    sheet
}

#[test]
fn a_sheet_of_points_moves_as_one_of_bodies() {
    let time = 1.0 / 60.0;
    for (stiffness, damping) in [
        (40.0, 0.0),
        (40.0, 0.5),
        (1e4, 3.0),
        (1e6, 0.0),
        (100.0, 60.0),
    ] {
        let mut bodies = sheet(stiffness, damping);
        let (mut elements, mut masses) = (bodies.elements.clone(), bodies.bodies.clone());
        assert!(Points::can_be(&elements, &masses));
        let mut points = Points::default();
        points.load_from(&elements, &masses, 500);
        bodies.memory_for_test(500);
        assert_eq!(points.least(time, 32), bodies.least(time, 32));
        for count in [1, 3] {
            points.run(time, count);
            bodies.run(time, count);
        }
        assert!(points.converged());
        points.store_into(&mut elements, &mut masses);
        let scale = masses
            .iter()
            .map(|b| b.velocity.length())
            .fold(1.0, f64::max);
        for (point, body) in masses.iter().zip(&bodies.bodies) {
            let apart = point.position.distance(body.position)
                + time * point.velocity.distance(body.velocity)
                + time * (point.given.0 - body.given.0).length();
            assert!(
                apart < 1e-7 * time * scale,
                "k {stiffness} c {damping}: {apart:e} m apart at {scale} m/s"
            );
        }
        for (wire, element) in elements.iter().zip(&bodies.elements) {
            let heat = (wire.heat - element.heat).abs() / (1e-3 + element.heat.abs());
            let work = (wire.work - element.work).abs() / (1e-3 + element.work.abs());
            assert!(heat < 1e-5 && work < 1e-5, "heat {heat:e} work {work:e}");
        }
        let survey = points.survey();
        let energy = Energy::of(&elements, &masses);
        for (one, other) in [
            (survey.energy.motion, energy.motion),
            (survey.energy.stored, energy.stored),
        ] {
            assert!((one - other).abs() <= 1e-9 * other.abs(), "{one} {other}");
        }
    }
}

#[test]
fn ends_in_one_place_push_nowhere_until_they_part() {
    let mut net = sheet(50.0, 0.0);
    net.bodies[9].position = net.bodies[8].position;
    net.elements[0].direction = None;
    let mut points = Points::default();
    points.load_from(&net.elements, &net.bodies, 200);
    points.run(1.0 / 60.0, 1);
    points.store_into(&mut net.elements, &mut net.bodies);
    assert!(net.bodies.iter().all(Body::is_finite));
}

/// A net of so many rows and columns of points. Its elements are sorted by the smaller index of their ends.
fn net(rows: usize, columns: usize) -> Component {
    let mut dice = Dice(3);
    let mut net = Component::default();
    let own = |index: usize| End::Body {
        index,
        arm: DVec3::ZERO,
    };
    for i in 0..rows * columns {
        let at = DVec3::new((i % columns) as f64, 0.0, (i / columns) as f64) + dice.vector(0.1);
        let body = Body {
            velocity: dice.vector(1.0),
            ..tests::point(1.0, at, DVec3::ZERO)
        };
        net.bodies.push(body);
        let aside = ((i + 1) % columns != 0).then_some(i + 1);
        let ahead = (i + columns < rows * columns).then_some(i + columns);
        for other in [aside, ahead].into_iter().flatten() {
            let new = tests::element(own(i), own(other), 50.0, 0.1, 0.9);
            net.elements.push(new);
        }
    }
    net
}

#[test]
fn how_many_threads_share_a_network_changes_no_bit_of_it() {
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(3).build());
    let net = net(100, 100);
    assert!(net.elements.len() > 4 * PIECE);
    let run = || {
        let mut points = Points::default();
        points.load_from(&net.elements, &net.bodies, 200);
        let survey = points.survey();
        points.run(1.0 / 60.0, 3);
        (points.points, survey.energy)
    };
    let shared = run();
    assert!(shared == threads::alone(run));
}

#[test]
fn parts_that_go_at_one_time_share_no_body() {
    // The wide net needs runs of more than a row, which is more than a piece.
    for (net, count) in [(net(100, 100), 20), (net(8, 1200), 5)] {
        are_apart(&net, count);
    }
}

/// Checks the division of a net, which has so many parts.
fn are_apart(net: &Component, parts: usize) {
    let mut points = Points::default();
    points.load_from(&net.elements, &net.bodies, 200);
    points.measure(1.0 / 60.0, 0.25);
    // Each element adds one to both of its ends, which counts the elements of each body.
    let count = |parts: &Parts| {
        let mut count = vec![0_u32; net.bodies.len()];
        let mut begun = vec![0_u32; net.bodies.len()];
        for stage in parts.stages() {
            let of_bodies = (&mut count[..], &mut begun[..]);
            parts.pass(*stage, &points.bars[..], of_bodies, |run| {
                let (count, begun) = run.bodies;
                for begun in begun.iter_mut().filter(|_| stage.is_first()) {
                    *begun += 1;
                }
                for end in run.elements.iter().flat_map(|bar| bar.ends) {
                    let [place, _] = places([end; 2], run.first);
                    count[place] += begun[place];
                }
            });
        }
        count
    };
    let mut whole = Parts::default();
    let mut wires = points.wires.clone();
    whole.find(&wires, net.bodies.len());
    assert_eq!(whole.count(), parts);
    let in_parts = count(&whole);
    // Elements that are not sorted by memory must form a single part.
    let last = wires.len() - 1;
    wires.swap(0, last);
    whole.find(&wires, net.bodies.len());
    assert_eq!(whole.count(), 1);
    assert_eq!(in_parts, count(&whole));
}
