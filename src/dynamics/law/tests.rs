use super::*;

/// A spring with these polynomials, beside a damper of 3 N s/m.
pub(crate) fn recipe(pull: [f64; 3], push: [f64; 3]) -> Recipe {
    Recipe {
        spring: SpringForce::Polynomial { pull, push },
        drag: DragLaw::Linear(3.0),
        preload: 0.0,
        limits: [f64::NEG_INFINITY, f64::INFINITY],
        most: f64::INFINITY,
        travel: [f64::NEG_INFINITY, f64::INFINITY],
        stop: Stop::default(),
    }
}

/// Laws with all combinations of preload, limits and spring.
fn laws() -> Vec<Law> {
    let stop = Stop {
        stiffness: 500.0,
        progression: 4.0,
        damping: 20.0,
    };
    let table = Table::new(&[(-0.5, -30.0), (-0.1, -2.0), (0.2, 5.0), (0.4, 40.0)]);
    let mut all = Vec::new();
    for preload in [0.0, -7.0, 4.0] {
        for limits in [
            [f64::NEG_INFINITY, f64::INFINITY],
            [0.0, f64::INFINITY],
            [f64::NEG_INFINITY, 0.0],
            [-12.0, 12.0],
        ] {
            for spring in [
                SpringForce::Polynomial {
                    pull: [40.0, 0.0, 0.0],
                    push: [40.0, 0.0, 0.0],
                },
                SpringForce::Polynomial {
                    pull: [10.0, 30.0, 200.0],
                    push: [80.0, 0.0, 5.0],
                },
                SpringForce::Table(Arc::new(table.clone())),
            ] {
                all.push(Law::new(Recipe {
                    spring,
                    preload,
                    limits,
                    most: if limits[0].is_finite() {
                        12.0
                    } else {
                        f64::INFINITY
                    },
                    travel: [0.6, 1.4],
                    stop,
                    ..recipe([0.0; 3], [0.0; 3])
                }));
            }
        }
    }
    all
}

#[test]
fn force_is_the_slope_of_the_energy_and_rises_everywhere() {
    for law in laws() {
        let mut last = f64::NEG_INFINITY;
        for i in 1..400 {
            let length = 0.005 * f64::from(i);
            let now = law.elastic(length, 1.0);
            assert!(
                now.force >= last - 1e-9 && now.stiffness >= 0.0,
                "{law:?} at {length}"
            );
            assert!(now.energy >= -1e-9, "{law:?}: {} J at {length}", now.energy);
            last = now.force;
            let h = 1e-6;
            let energy = |l| law.elastic(l, 1.0).energy;
            let slope = (energy(length + h) - energy(length - h)) / (2.0 * h);
            let near = 1e-6 * (1.0 + now.force.abs()) + h * now.stiffness.max(600.0);
            assert!(
                (slope - now.force).abs() < near,
                "{law:?} at {length}: {slope} {now:?}"
            );
        }
    }
}

#[test]
fn damping_only_takes() {
    for mut law in laws() {
        for drag in [
            DragLaw::Linear(3.0),
            DragLaw::Sided {
                bump: 1.0,
                rebound: 3.0,
            },
            DragLaw::Quadratic {
                linear: 1.0,
                quadratic: 5.0,
            },
            DragLaw::BlowOff {
                damping: 9.0,
                knee: 0.2,
                beyond: 1.0,
            },
            DragLaw::Table(Arc::new(Table::new(&[
                (-1.0, -9.0),
                (0.0, 0.0),
                (1.0, 4.0),
            ]))),
        ] {
            law.drag = drag;
            for i in 1..60 {
                for j in -20..=20 {
                    let rate = 0.2 * f64::from(j);
                    let drag = law.drag(0.03 * f64::from(i), 1.0, rate);
                    assert!(
                        drag.force * rate >= 0.0 && drag.slope >= 0.0,
                        "{law:?} {rate}"
                    );
                }
            }
        }
    }
}

#[test]
fn ropes_never_push_and_buffers_never_pull() {
    for (limits, sign) in [
        ([0.0, f64::INFINITY], 1.0),
        ([f64::NEG_INFINITY, 0.0], -1.0),
    ] {
        let law = Law::new(Recipe {
            limits,
            ..recipe([40.0, 0.0, 10.0], [40.0, 0.0, 10.0])
        });
        for i in 1..40 {
            for rate in [-9.0, -0.1, 0.0, 0.1, 9.0] {
                let length = 0.05 * f64::from(i);
                let force = law.elastic(length, 1.0).force + law.drag(length, 1.0, rate).force;
                assert!(force * sign >= 0.0, "{force} N at {length} m, {rate} m/s");
            }
        }
    }
}

#[test]
fn spring_and_damper_together_are_the_sum_that_the_limits_leave() {
    for (limits, most) in [
        ([-12.0, 12.0], 12.0),
        ([-12.0, 0.0], 12.0),
        ([-5.0, 5.0], 5.0),
    ] {
        let law = Law::new(Recipe {
            limits,
            most,
            ..recipe([40.0, 0.0, 0.0], [40.0, 0.0, 0.0])
        });
        for i in 1..60 {
            for j in -40..=40 {
                let (length, rate) = (0.05 * f64::from(i), 0.5 * f64::from(j));
                let stretch = length - 1.0;
                if limits[1] == 0.0 && stretch >= 0.0 {
                    // Slack.
                    continue;
                }
                let wanted = (40.0 * stretch + 3.0 * rate).clamp(limits[0], limits[1]);
                let spring = law.elastic(length, 1.0).force;
                let total = spring + law.drag(length, 1.0, rate).force;
                // A damper only takes energy, so it does not bring back what the limit took from the spring.
                let wanted = if (wanted - spring) * rate < 0.0 {
                    spring
                } else {
                    wanted
                };
                assert!(
                    (total - wanted).abs() < 1e-9,
                    "{limits:?}: {total} N, not {wanted} N, at {length} m and {rate} m/s"
                );
            }
        }
    }
}

#[test]
fn a_spring_that_is_beyond_its_limit_everywhere_has_the_limit() {
    let endless = f64::INFINITY;
    for (preload, limits, held) in [
        // A gas strut whose force is limited to less than its preload, and its opposite.
        (-400.0, [-300.0, 300.0], -300.0),
        (400.0, [-300.0, 300.0], 300.0),
        // An element that can only pull, or only push, with nothing but a preload in the other direction.
        (-50.0, [0.0, endless], 0.0),
        (50.0, [-endless, 0.0], 0.0),
    ] {
        let law = Law::new(Recipe {
            preload,
            limits,
            most: 300.0,
            ..recipe([0.0; 3], [0.0; 3])
        });
        for length in [0.2, 1.0, 1.7] {
            let now = law.elastic(length, 1.0);
            assert_eq!((now.force, now.stiffness), (held, 0.0), "{law:?}");
            let total = now.force + law.drag(length, 1.0, held.signum()).force;
            assert_eq!(total, held, "{law:?}: no damper adds to it");
            // The change of its energy is its work.
            let work = law.elastic(length + 0.1, 1.0).energy - now.energy;
            assert!((work - 0.1 * held).abs() < 1e-9, "{law:?}: {work} J");
        }
        assert!(!law.is_bent(), "it has no kink");
    }
}

#[test]
fn a_slack_rope_does_not_damp_whatever_its_preload() {
    for stiffness in [100.0, 700.0, 1300.0] {
        for preload in (1..50).map(|p| 10.0 * f64::from(p)) {
            let force = [stiffness, 0.0, 0.0];
            let rope = Law::new(Recipe {
                spring: SpringForce::Polynomial {
                    pull: force,
                    push: force,
                },
                drag: DragLaw::Linear(50.0),
                preload,
                limits: [0.0, f64::INFINITY],
                most: f64::INFINITY,
                travel: [f64::NEG_INFINITY, f64::INFINITY],
                stop: Stop::default(),
            });
            let slack = 1.0 - preload / stiffness - 0.2;
            let told = (
                rope.elastic(slack, 1.0).force,
                rope.drag(slack, 1.0, 1.0).force,
            );
            assert_eq!(told, (0.0, 0.0), "{stiffness} N/m, {preload} N");
        }
    }
}
