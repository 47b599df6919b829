use super::*;
use crate::dynamics::kick::Memo;
use bevy::math::DVec3;

use crate::dynamics::tests::DT;

/// A pair of which one end is held, with 1 kg at the other.
fn pair(stiffness: f64, damping: f64, rest_length: f64, gravity: f64) -> Pair {
    Pair {
        stiffness,
        damping,
        rest_length,
        inverse_mass: 1.0,
        outside: gravity * DVec3::NEG_Y,
        rounding: 1e-12,
    }
}

fn start(d: [f64; 2], v: [f64; 2]) -> Separation {
    let [d, v] = [d, v].map(|[x, y]| DVec3::new(x, y, 0.0));
    Separation::new(d, v, Some(d.normalize()))
}

/// Advances by `steps` steps of 1/60 s in `count` micro-steps each.
fn run(pair: &Pair, mut state: Separation, steps: u32, count: u32) -> Separation {
    let mut memo = Memo::default();
    for _ in 0..steps {
        pair.microsteps(&mut state, DT, count, &mut memo);
    }
    state
}

/// Angular velocity of uniform rotation at the length `radius`, rad/s.
fn uniform(pair: &Pair, radius: f64) -> f64 {
    (pair.stiffness * (radius - pair.rest_length) / radius).sqrt()
}

#[test]
fn uniform_rotation_is_exact() {
    // By 0.08, 0.25 and 0.3 rad in a step.
    for (pair, radius, most) in [
        (pair(100.0, 2.0, 1.0, 0.0), 1.3, 1e-11),
        (pair(600.0, 0.0, 0.5, 0.0), 0.8, 1e-10),
        (pair(2000.0, 3.0, 0.5, 0.0), 0.6, 1e-9),
    ] {
        let turning = uniform(&pair, radius);
        let end = run(&pair, start([radius, 0.0], [0.0, turning * radius]), 600, 1);
        let angle = turning * 600.0 * DT;
        let place = radius * DVec3::new(angle.cos(), angle.sin(), 0.0);
        let apart = (end.d - place).length();
        assert!(apart < most, "{apart:.1e} m");
        let velocity = turning * DVec3::Z.cross(place);
        assert!((end.v - velocity).length() < 30.0 * most);
    }
}

#[test]
fn motion_along_the_line_is_exact() {
    let pair = pair(400.0, 0.0, 1.0, 0.0);
    let end = run(&pair, start([1.2, 0.0], [1.0, 0.0]), 600, 1);
    let (phase, omega) = (20.0 * 600.0 * DT, 20.0);
    let length = 1.0 + 0.2 * phase.cos() + phase.sin() / omega;
    assert!((end.d.x - length).abs() < 1e-11 && end.d.y == 0.0);
}

/// Errors of the place after 5 s with one, two and four micro-steps a step.
fn errors(pair: &Pair, from: Separation) -> [f64; 3] {
    let exact = run(pair, from, 300, 128).d;
    [1, 2, 4].map(|count| (run(pair, from, 300, count).d - exact).length())
}

#[test]
fn without_damping_the_error_is_of_fourth_order() {
    for (what, pair, from) in [
        (
            "ellipse",
            pair(50.0, 0.0, 0.5, 0.0),
            start([1.0, 0.0], [0.0, 2.0]),
        ),
        (
            "pendulum",
            pair(50.0, 0.0, 1.0, 9.81),
            start([1.0, 0.0], [0.0, 0.0]),
        ),
        (
            "stiff pendulum",
            pair(4000.0, 0.0, 1.0, 9.81),
            start([1.0, 0.0], [0.0, 0.0]),
        ),
        (
            "whirled stone",
            pair(300.0, 0.0, 1.0, 9.81),
            start([1.1, 0.0], [0.0, 8.0]),
        ),
    ] {
        let [one, two, four] = errors(&pair, from);
        assert!(one < 3e-5, "{what}: {one:.1e} m");
        let (first, second) = (one / two, two / four);
        assert!(
            first > 14.0 && (14.0..18.0).contains(&second),
            "{what}: {first:.1} {second:.1}"
        );
    }
}

#[test]
fn with_damping_the_error_is_of_third_order() {
    for (pair, from) in [
        (pair(100.0, 3.0, 1.0, 0.0), start([1.3, 0.0], [0.0, 5.0])),
        (pair(100.0, 2.0, 1.0, 9.81), start([1.0, 0.0], [0.0, 0.0])),
    ] {
        let [one, two, four] = errors(&pair, from);
        assert!(one < 1e-5, "{one:.1e} m");
        assert!(
            one / two > 5.5 && two / four > 6.5,
            "{one:.1e} {two:.1e} {four:.1e}"
        );
    }
}

#[test]
fn out_of_the_plane_it_is_as_exact() {
    let pair = Pair {
        outside: DVec3::new(3.0, -9.0, 2.0),
        ..pair(200.0, 0.0, 0.7, 0.0)
    };
    let mut from = start([0.8, 0.3], [1.0, 2.0]);
    from.v.z = 3.0;
    let [one, two, four] = errors(&pair, from);
    assert!(one < 3e-5, "{one:.1e} m");
    assert!(
        one / two > 13.0 && two / four > 14.0,
        "{one:.1e} {two:.1e} {four:.1e}"
    );
}

#[test]
fn angular_momentum_is_kept_at_any_stiffness_and_damping() {
    for stiffness in [1.0, 100.0, 1e4, 1e6] {
        for damping in [0.0, 5.0, 500.0] {
            let pair = pair(stiffness, damping, 0.6, 0.0);
            let from = start([0.5, 0.3], [2.0, 4.0]);
            let end = run(&pair, from, 600, 1);
            let [before, after] = [from, end].map(|state| state.d.cross(state.v).z);
            let lost = (after / before - 1.0).abs();
            assert!(lost < 1e-11, "{stiffness} {damping}: {lost:.1e}");
        }
    }
}

/// Energy of the pair, J.
fn energy(pair: &Pair, state: &Separation) -> f64 {
    let stretch = state.d.length() - pair.rest_length;
    0.5 * state.v.length_squared() + 0.5 * pair.stiffness * stretch * stretch
        - pair.outside.dot(state.d)
}

/// Mean energies in the tenths of so many steps, J.
fn mean_energies(pair: &Pair, mut state: Separation, steps: u32) -> Vec<f64> {
    let mut memo = Memo::default();
    let mut sums = vec![0.0; 10];
    for i in 0..steps {
        pair.microsteps(&mut state, DT, 1, &mut memo);
        sums[(i * 10 / steps) as usize] += energy(pair, &state) * 10.0 / f64::from(steps);
    }
    sums
}

#[test]
fn a_whirled_stone_keeps_its_energy() {
    // The springs turn by half a radian in a step, or oscillate by two.
    for (pair, from) in [
        (pair(2000.0, 0.0, 0.5, 9.81), start([0.6, 0.0], [0.0, 8.0])),
        (
            pair(14_000.0, 0.0, 1.0, 9.81),
            start([1.0, 0.0], [0.0, 5.0]),
        ),
    ] {
        let means = mean_energies(&pair, from, 18_000);
        let motion = 0.5 * from.v.length_squared();
        let drift = (means[9] - means[0]).abs() / motion;
        assert!(drift < 1e-5, "{drift:.1e} of the energy in five minutes");
    }
}

#[test]
fn close_passages_do_not_add_up_in_the_energy() {
    let pair = pair(10.0, 0.0, 0.5, 9.81);
    for from in [[1.0, 1.0], [1.0, 0.8], [0.9, 1.2]] {
        let from = start(from, [0.0, 0.0]);
        let first = energy(&pair, &from);
        for mean in mean_energies(&pair, from, 90_000) {
            let off = (mean - first).abs();
            assert!(off < 0.02, "{off:.3} J");
        }
    }
}

#[test]
fn ends_that_swing_past_each_other_win_nothing() {
    // Half as far from the rest length as it is long, at nine metres a second: it turns by up to a radian in a step.
    for (pair, from) in [
        (
            pair(3232.0, 0.0, 0.45, 0.0),
            start([0.182, -0.699], [0.07, -8.773]),
        ),
        (
            pair(5254.0, 0.0, 1.737, 9.81),
            start([0.448, -0.511], [-9.297, 6.059]),
        ),
    ] {
        let first = energy(&pair, &from);
        let lift = 9.81 * (from.d.length() + pair.rest_length);
        for mean in mean_energies(&pair, from, 3_600) {
            let won = (mean - first) / (first.abs() + lift);
            assert!(won < 0.01, "{won:.3} of its energy");
        }
    }
}

#[test]
fn a_spring_that_is_squeezed_to_almost_nothing_falls_as_one_resolved_finely() {
    // h²·F/L is −2.3 and −8.
    for (damping, from, most) in [(0.0, 0.1, 1e-4), (30.0, 0.03, 1e-3)] {
        let pair = pair(900.0, damping, 1.0, 9.81);
        let from = start([from, 0.0], [0.0, 0.0]);
        let apart = (run(&pair, from, 1, 1).d - run(&pair, from, 1, 1024).d).length();
        assert!(apart < most, "{damping} N s/m: {apart:.1e} m");
    }
}
