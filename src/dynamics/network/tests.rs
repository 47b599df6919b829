use crate::dynamics::body::Body;
use crate::dynamics::law::tests::recipe;
use crate::dynamics::law::{DragLaw, Law, Recipe, Table};
use crate::dynamics::step::Component;
use crate::dynamics::tests::{DT, element, fixed, held, point, row, turning};
use crate::dynamics::tolerance::{Accuracy, Method};
use crate::settings::MAX_ITERATIONS;
use bevy::math::DVec3;
use std::sync::Arc;

/// Three bodies of 1 kg in a row, 1 m apart. Each is joined to the next by an element with this law. The middle one moves with
/// `speed` (m/s).
fn three(law: Law, speed: f64) -> Component {
    let bodies = (0..3).map(|at| point(1.0, DVec3::X * f64::from(at), DVec3::ZERO));
    let mut row = row(bodies.collect(), 0.0);
    row.bodies[1].velocity = DVec3::X * speed;
    let law = Arc::new(law);
    for element in &mut row.elements {
        element.law = Some(law.clone());
    }
    row
}

/// A spring with the force k₁ x + k₃ x³ and a damper.
fn law([linear, cubic]: [f64; 2], drag: DragLaw) -> Law {
    let force = [linear, 0.0, cubic];
    Law::new(Recipe {
        drag,
        ..recipe(force, force)
    })
}

fn step(row: &mut Component, microsteps: u32) {
    row.advance(DT, Accuracy::exactly(microsteps));
}

/// Where the bodies are after two seconds, in so many micro-steps a step.
fn places(mut row: Component, microsteps: u32) -> [f64; 3] {
    (0..120).for_each(|_| step(&mut row, microsteps));
    std::array::from_fn(|at| row.bodies[at].position.x)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn springs_that_harden_have_an_error_of_second_order_though_their_stiffness_doubles_within_steps() {
    let go = |count| {
        let harden = law([200.0, 1e4], DragLaw::Linear(0.0));
        places(three(harden, 2.0), count)
    };
    let exact = go(128);
    let [one, two, four] = [1, 2, 4].map(|count| apart(go(count), exact));
    assert!(one < 4e-3, "{one:.1e} m");
    assert!(
        one / two > 3.5 && two / four > 3.5,
        "{one:.1e} {two:.1e} {four:.1e}"
    );
}

#[test]
fn a_table_of_a_linear_damper_is_no_limit_of_its_force() {
    let damping = 3.0;
    let line = [-5.0, -1.3, -0.7, 0.0, 0.3, 1.1, 5.0].map(|rate| (rate, damping * rate));
    let [table, plain] = [
        DragLaw::Table(Arc::new(Table::new(&line))),
        DragLaw::Linear(damping),
    ]
    .map(|drag| places(three(law([400.0, 0.0], drag), 1.0), 1));
    assert!(apart(table, plain) < 1e-12, "{table:?} {plain:?}");
}

#[test]
fn dampers_that_blow_off_at_once_stop_their_ends_and_hardly_throw_them_back() {
    for (force, beyond) in [(10.0, 0.1), (10.0, 5.0), (100.0, 10.0)] {
        let drag = DragLaw::BlowOff {
            damping: 1e4,
            knee: 1e-4 * force,
            beyond,
        };
        let mut row = three(law([0.0; 2], drag), 1.0);
        let rate = |row: &Component| row.bodies[1].velocity.x - row.bodies[0].velocity.x;
        let mut back = 0.0_f64;
        for _ in 0..300 {
            step(&mut row, 1);
            back = back.min(rate(&row));
        }
        let what = format!("{force} N and {beyond} N s/m");
        assert!(back > -0.2, "{what}: {back} m/s");
        assert!(rate(&row).abs() < 1e-9, "{what}: {} m/s", rate(&row));
    }
}

/// A net of 60 × 60 bodies of 0.1 kg that hangs from hooks along two sides, with a body of 100 kg in its middle.
fn net() -> Component {
    const SIDE: usize = 60;
    let mut net = Component::default();
    let mut join = |a, b| net.elements.push(element(a, b, 1e7, 1.0, 1.0));
    for at in 0..SIDE * SIDE {
        let (x, z) = (at % SIDE, at / SIDE);
        let mass = if [x, z] == [SIDE / 2; 2] { 100.0 } else { 0.1 };
        let place = DVec3::new(x as f64, 0.0, z as f64);
        net.bodies.push(point(mass, place, 9.81 * DVec3::NEG_Y));
        let end = |index| held(index, DVec3::ZERO);
        if x > 0 {
            join(end(at - 1), end(at));
        }
        if z > 0 {
            join(end(at - SIDE), end(at));
        }
        if z == 0 || z == SIDE - 1 {
            join(fixed(place + DVec3::Y), end(at));
        }
    }
    net
}

#[test]
fn a_stiff_net_under_a_heavy_body_needs_more_than_half_of_the_iterations_that_it_may_take() {
    for (most, is_enough) in [(MAX_ITERATIONS, true), (MAX_ITERATIONS / 2, false)] {
        let mut net = net();
        let accuracy = Accuracy {
            max_iterations: most,
            resolve: 1,
            ..Accuracy::exactly(1)
        };
        let capped = (0..6).any(|_| net.advance(DT, accuracy).capped);
        assert_eq!(capped, !is_enough, "{most} iterations");
    }
}

/// Bodies that turn as one with 5 rad/s, all joined to each other by stretched springs, and so many idle ones beside them.
fn crowd(idle: usize) -> Component {
    let mut crowd = Component::default();
    let turns = DVec3::new(3.0, 4.0, 0.0);
    let count = 12;
    for at in 0..count + idle {
        let place = DVec3::new(at as f64, (at * at % 7) as f64, (at * at % 5) as f64);
        let inertia = DVec3::new(0.1, 0.2, 0.25);
        let is_idle = at >= count;
        let spin = if is_idle { DVec3::ZERO } else { turns };
        let mut body = turning(point(1.0, place, DVec3::ZERO), inertia, spin);
        body.velocity = spin.cross(place);
        crowd.bodies.push(body);
        for other in if is_idle { count..at } else { 0..at } {
            let stiffness = if is_idle { 0.0 } else { 300.0 };
            let length = 0.9 * place.distance(crowd.bodies[other].position);
            let [a, b] = [held(other, 0.2 * DVec3::X), held(at, 0.3 * DVec3::Y)];
            crowd.elements.push(element(a, b, stiffness, 0.0, length));
        }
    }
    crowd
}

#[test]
fn what_turns_after_a_kick_is_known_well_enough() {
    // With idle bodies beside it, the crowd is so large that its equations are solved by iterations.
    let [alone, beside] = [0, 12].map(|idle| {
        let mut crowd = crowd(idle);
        let methods = (0..60).map(|_| crowd.advance(DT, Accuracy::exactly(4)).method);
        let wanted = if idle == 0 {
            Method::Direct
        } else {
            Method::Iterative
        };
        assert!(methods.into_iter().all(|method| method == wanted));
        crowd.bodies
    });
    let apart = |(a, b): (&Body, &Body)| a.position.distance(b.position);
    let apart = alone.iter().zip(&beside).map(apart).fold(0.0, f64::max);
    assert!(apart < 3e-7, "{apart:.1e} m");
}
