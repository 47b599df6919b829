use super::*;
use crate::dynamics::law::{DragLaw, Recipe, SpringForce, Stop};
use crate::dynamics::tolerance::Steppable;

fn pair(rest_length: f64, outside: DVec3) -> Pair {
    Pair {
        stiffness: 0.0,
        damping: 0.0,
        rest_length,
        inverse_mass: 1.0,
        outside,
        rounding: 1e-12,
    }
}

fn polynomial(coefficients: [f64; 3]) -> Recipe {
    Recipe {
        spring: SpringForce::Polynomial {
            pull: coefficients,
            push: coefficients,
        },
        drag: DragLaw::Linear(0.0),
        preload: 0.0,
        limits: [f64::NEG_INFINITY, f64::INFINITY],
        most: f64::INFINITY,
        travel: [f64::NEG_INFINITY, f64::INFINITY],
        stop: Stop::default(),
    }
}

/// Steps a separation, and calls `see` with time, separation and velocity after each step.
fn run(
    law: &Law,
    pair: &Pair,
    [d, v]: [DVec3; 2],
    [step, time]: [f64; 2],
    count: u32,
    mut see: impl FnMut(f64, DVec3, DVec3),
) {
    let mut memo = Memo::default();
    let mut moving = NonlinearPair::new(pair, law, Separation::new(d, v, None), &mut memo);
    for i in 1..=(time / step).round() as u32 {
        moving.run(step, count);
        see(step * f64::from(i), moving.state.d, moving.state.v);
    }
}

/// Mean period of the stretch about a rest length of 10 m, from its zeros, which are interpolated by cubics.
fn period(law: &Law, step: f64, count: u32, periods: f64) -> f64 {
    let mut last = (0.0, 1.0, 0.0);
    let mut crossings = Vec::new();
    let start = [DVec3::new(11.0, 0.0, 0.0), DVec3::ZERO];
    run(
        law,
        &pair(10.0, DVec3::ZERO),
        start,
        [step, periods],
        count,
        |t, d, v| {
            let now = (t, d.x - 10.0, v.x);
            if last.1 < 0.0 && now.1 >= 0.0 {
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..60 {
                    let s = 0.5 * (low + high);
                    let h = t - last.0;
                    let y = (1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s) * last.1
                        + s * (1.0 - s) * (1.0 - s) * h * last.2
                        + s * s * (3.0 - 2.0 * s) * now.1
                        + s * s * (s - 1.0) * h * now.2;
                    if y < 0.0 { low = s } else { high = s }
                }
                crossings.push(last.0 + low * (t - last.0));
            }
            last = now;
        },
    );
    (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}

#[test]
fn duffing_and_the_cubic_spring_keep_their_periods() {
    // Periods at amplitude 1 m, from the complete elliptic integral, s.
    for (coefficients, exact, bars) in [
        ([1.0, 0.0, 1.0], 4.768_022, [[5e-4, 5e-6], [1e-2, 1e-4]]),
        ([0.0, 0.0, 1.0], 7.416_299, [[6e-4, 3e-6], [1.2e-2, 1e-4]]),
    ] {
        let law = Law::new(polynomial(coefficients));
        for (step, bars) in [0.1, 0.5].into_iter().zip(bars) {
            for (count, bar) in [1, 16].into_iter().zip(bars) {
                let error = period(&law, step, count, 200.0) / exact - 1.0;
                println!("{coefficients:?} step {step} ×{count}: {error:.1e} (bar {bar:.0e})");
                assert!(error.abs() <= bar, "{error}");
            }
        }
    }
}

#[test]
fn no_law_gains_energy_at_any_step() {
    let unlimited = [f64::NEG_INFINITY, f64::INFINITY];
    for stiffness in [1e-2, 1.0, 1e2, 1e4] {
        for (limits, travel) in [
            (unlimited, unlimited),
            ([0.0, f64::INFINITY], unlimited),
            (unlimited, [0.8, 1.2]),
            ([-0.1, 0.1], [0.5, 1.5]),
        ] {
            let law = Law::new(Recipe {
                limits,
                most: limits[1],
                travel,
                stop: Stop {
                    stiffness: 100.0 * stiffness,
                    progression: 1.0,
                    damping: 0.0,
                },
                ..polynomial([stiffness, stiffness, stiffness])
            });
            let start = [DVec3::new(1.3, 0.1, 0.0), DVec3::new(0.4, 0.3, -0.2)];
            let outside = DVec3::new(0.05, 0.0, 0.02);
            let pair = pair(1.0, outside);
            let energy = |d: DVec3, v: DVec3| {
                0.5 * v.length_squared() + law.elastic(d.length(), 1.0).energy - outside.dot(d)
            };
            let first = energy(start[0], start[1]);
            let scale = 0.5 * start[1].length_squared() + law.elastic(1.3, 1.0).energy;
            let (mut most, mut least) = (f64::MIN, f64::MAX);
            run(&law, &pair, start, [1.0, 2000.0], 1, |_, d, v| {
                let gained = (energy(d, v) - first) / scale;
                (most, least) = (most.max(gained), least.min(gained));
            });
            println!("k {stiffness}, {limits:?}, {travel:?}: {least:.1e} to {most:.1e}");
            assert!(most < 0.03, "gained {most}");
        }
    }
}

#[test]
fn extrapolation_removes_most_of_the_error_of_every_smooth_law() {
    let start = [DVec3::new(11.0, 0.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
    let (step, steps) = (0.2, 100);
    let pair = pair(10.0, DVec3::ZERO);
    for coefficients in [[1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0, 0.0, 1.0]] {
        let law = Law::new(polynomial(coefficients));
        let end = |count, extrapolates| {
            let mut memo = Memo::default();
            let first = Separation::new(start[0], start[1], None);
            let mut moving = NonlinearPair::new(&pair, &law, first, &mut memo);
            for _ in 0..steps {
                moving.save(0);
                moving.run(step, count);
                if extrapolates {
                    moving.save(1);
                    moving.load(0);
                    moving.run(step, 2 * count);
                    moving.extrapolate(1);
                }
            }
            moving.state.d
        };
        let truth = end(256, false);
        let [plain, extrapolated] = [end(4, false), end(2, true)].map(|d| (d - truth).length());
        println!("{coefficients:?}: {plain:.1e} m, extrapolated {extrapolated:.1e} m");
        assert!(extrapolated < plain / 10.0);
    }
}
