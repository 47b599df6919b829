use super::*;
use crate::dynamics::law::{DragLaw, Recipe, SpringForce, Stop};

const STIFFNESS: f64 = 50.0;

fn law(limits: [f64; 2]) -> Law {
    Law::new(recipe(limits))
}

fn recipe(limits: [f64; 2]) -> Recipe {
    let force = [STIFFNESS, 0.0, 0.0];
    Recipe {
        spring: SpringForce::Polynomial {
            pull: force,
            push: force,
        },
        drag: DragLaw::Sided {
            bump: 2.0,
            rebound: 6.0,
        },
        preload: 0.0,
        limits,
        most: f64::INFINITY,
        travel: [0.5, 1.5],
        stop: Stop {
            stiffness: 1e3,
            ..Stop::default()
        },
    }
}

fn reach(way: [f64; 2], rate: f64) -> Outreach {
    Outreach {
        way,
        rate,
        change: 0.3,
        speed: 10.0,
        firmest: [f64::INFINITY; 2],
    }
}

#[test]
fn pieces_do_the_work_of_the_laws_energy_across_its_kinks() {
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    for limits in [free, [0.0, f64::INFINITY], [f64::NEG_INFINITY, 0.0]] {
        let law = law(limits);
        for way in [[0.9, 1.2], [1.2, 0.8], [0.6, 0.4], [1.3, 1.6], [1.6, 1.4]] {
            // The predicted change of length has the wrong sign.
            let pieces = Pieces::of(&law, 1.0, reach([way[0], 2.0 * way[0] - way[1]], 1.0));
            let stored = way.map(|length| law.elastic(length, 1.0).energy);
            let missed = pieces.work(way) - (stored[1] - stored[0]);
            assert!(missed.abs() < 1e-12, "{limits:?}, {way:?}: {missed}");
        }
    }
}

#[test]
fn a_spring_that_is_stiffer_one_way_does_its_work_across_the_kink() {
    let mut recipe = recipe([f64::NEG_INFINITY, f64::INFINITY]);
    recipe.spring = SpringForce::Polynomial {
        pull: [300.0, 0.0, 0.0],
        push: [10.0, 0.0, 0.0],
    };
    let law = Law::new(recipe);
    for way in [[0.9, 1.1], [1.1, 0.9], [0.8, 0.9], [1.0, 1.2], [1.2, 1.1]] {
        let pieces = Pieces::of(&law, 1.0, reach([way[0], way[0]], 0.0));
        let stored = way.map(|length| law.elastic(length, 1.0).energy);
        let missed = pieces.work(way) - (stored[1] - stored[0]);
        assert!(missed.abs() < 1e-9, "{way:?}: {missed}");
    }
}

#[test]
fn at_rest_it_gives_what_a_bent_law_gives_there() {
    let mut recipe = recipe([f64::NEG_INFINITY, f64::INFINITY]);
    recipe.spring = SpringForce::Polynomial {
        pull: [100.0, 0.0, 1e4],
        push: [50.0, 0.0, 0.0],
    };
    let law = Law::new(recipe);
    for length in [0.9, 1.1, 1.2] {
        let pieces = Pieces::of(&law, 1.0, reach([length; 2], 0.0));
        let (given, wanted) = (pieces.tension(length, 0.0), law.elastic(length, 1.0).force);
        assert!((given - wanted).abs() < 1e-9, "{length}: {given}, {wanted}");
    }
}

#[test]
fn a_limit_holds_for_spring_and_damper_together_where_a_spring_is_stiffer_one_way() {
    let mut recipe = recipe([-100.0, 100.0]);
    recipe.most = 100.0;
    recipe.drag = DragLaw::Linear(50.0);
    recipe.spring = SpringForce::Polynomial {
        pull: [300.0, 0.0, 0.0],
        push: [500.0, 0.0, 0.0],
    };
    let law = Law::new(recipe);
    for (way, rate) in [([1.3, 1.33], 4.0), ([0.7, 0.67], -4.0), ([1.5, 1.5], 4.0)] {
        let pieces = Pieces::of(&law, 1.0, reach(way, rate));
        let tension = pieces.tension(way[1], rate);
        let wanted = 100.0_f64.copysign(rate);
        assert!((tension - wanted).abs() < 1e-9, "{way:?}: {tension}");
    }
}

#[test]
fn what_acts_one_way_with_a_limit_damps_only_where_it_is_not_slack() {
    for sign in [1.0, -1.0] {
        let limits = if sign > 0.0 {
            [0.0, 100.0]
        } else {
            [-100.0, 0.0]
        };
        let mut recipe = recipe(limits);
        recipe.most = 100.0;
        recipe.drag = DragLaw::Linear(50.0);
        let [near, far] = [300.0, 500.0].map(|linear| [linear, 0.0, 0.0]);
        let [pull, push] = if sign > 0.0 { [near, far] } else { [far, near] };
        recipe.spring = SpringForce::Polynomial { pull, push };
        let law = Law::new(recipe);
        // Stretches, and the tension at the last one: slack, on the way out of that, and taut.
        for (stretch, wanted) in [
            ([-0.3, -0.28], 0.0),
            ([-0.02, -0.01], 0.0),
            ([-0.01, 0.02], 31.0),
            ([0.1, 0.12], 61.0),
        ] {
            let way = stretch.map(|stretch: f64| 1.0 + sign * stretch);
            let rate = sign * 0.5;
            let pieces = Pieces::of(&law, 1.0, reach(way, rate));
            let tension = sign * pieces.tension(way[1], rate);
            assert!((tension - wanted).abs() < 1e-9, "{way:?}: {tension}");
        }
    }
}

#[test]
fn a_rope_a_buffer_and_a_stop_damp_no_farther_ahead_than_the_step_leads_beyond() {
    let endless = f64::INFINITY;
    for (limits, travel, edge, sign) in [
        ([0.0, endless], [-endless, endless], 1.0, 1.0),
        ([-endless, 0.0], [-endless, endless], 1.0, -1.0),
        ([-endless, endless], [-endless, 1.5], 1.5, 1.0),
        ([-endless, endless], [0.5, endless], 0.5, -1.0),
    ] {
        let mut recipe = recipe(limits);
        recipe.travel = travel;
        recipe.drag = DragLaw::Linear(if limits == [-endless, endless] {
            0.0
        } else {
            50.0
        });
        recipe.stop.damping = 100.0;
        let law = Law::new(recipe);
        // How far beyond: far away, on the way, over the edge, and pressed.
        for way in [[-0.2, -0.19], [-0.01, -0.001], [-0.01, 0.005], [0.01, 0.02]] {
            let lengths = way.map(|beyond: f64| edge + sign * beyond);
            let rate = sign * 0.5;
            let pieces = Pieces::of(&law, 1.0, reach(lengths, rate));
            let damped = |length: f64| pieces.tension(length, rate) - pieces.tension(length, 0.0);
            let begins = edge - sign * way[1].abs();
            let last = if way[1] < 0.0 {
                lengths[1]
            } else {
                begins - sign * 1e-6
            };
            let before = [lengths[0], last].map(|at| damped(at).abs());
            let before = before[0].max(before[1]);
            let case = format!("{limits:?} {travel:?} {way:?}");
            if way[0] < 0.0 {
                assert!(before < 1e-9, "{case}: {before} N before {begins}");
            } else {
                let now = damped(lengths[1]).abs();
                assert!(now >= 25.0 - 1e-9, "{case}: {now} N");
            }
        }
    }
}

#[test]
fn a_slack_rope_is_ready_and_has_no_force() {
    let law = law([0.0, f64::INFINITY]);
    let pieces = Pieces::of(&law, 1.0, reach([0.9, 0.9], 0.0));
    assert_eq!(pieces.tension(0.9, 0.0), 0.0);
    assert!((pieces.tension(1.1, 0.0) - 0.1 * STIFFNESS).abs() < 1e-12);
    assert_eq!(pieces.stiffness(), STIFFNESS, "no stop is near");
}

#[test]
fn a_damper_takes_what_its_law_takes() {
    for (rate, wanted) in [(1.0, 6.0), (-0.2, 2.0), (0.0, 6.0)] {
        let law = law([f64::NEG_INFINITY, f64::INFINITY]);
        let mut pieces = Pieces::of(&law, 1.0, reach([1.0, 1.1], rate));
        assert_eq!(pieces.spring().damping, wanted, "at {rate} m/s");
    }
}

#[test]
fn a_buffer_that_is_not_met_yet_has_no_force_however_it_hardens() {
    let mut recipe = recipe([f64::NEG_INFINITY, 0.0]);
    let cubic = [0.0, 0.0, 1e6];
    recipe.spring = SpringForce::Polynomial {
        pull: cubic,
        push: cubic,
    };
    let law = Law::new(recipe);
    for way in [[1.2, 1.1], [1.05, 1.01], [1.3, 1.4]] {
        let pieces = Pieces::of(&law, 1.0, reach(way, -1.0));
        for length in [1.2, 1.1, 1.02, 1.001] {
            assert_eq!(pieces.tension(length, 0.0), 0.0, "{way:?}: at {length}");
        }
    }
}

#[test]
fn a_rope_is_as_stiff_as_it_is_however_hard_it_would_push() {
    let mut recipe = recipe([0.0, f64::INFINITY]);
    recipe.spring = SpringForce::Polynomial {
        pull: [STIFFNESS, 0.0, 0.0],
        push: [10.0, 0.0, 1e9],
    };
    let law = Law::new(recipe);
    for way in [[0.7, 0.8], [0.9, 1.1], [1.1, 1.2]] {
        let mut reach = reach(way, 0.0);
        reach.firmest = [1e3; 2];
        let pieces = Pieces::of(&law, 1.0, reach);
        assert_eq!(pieces.tension(0.9, 0.0), 0.0, "{way:?}");
        let taut = pieces.tension(1.2, 0.0);
        assert!((taut - 0.2 * STIFFNESS).abs() < 1e-9, "{way:?}: {taut}");
    }
}

#[test]
fn what_goes_farther_than_it_was_thought_to_meets_at_least_what_it_stores() {
    let mut recipe = recipe([f64::NEG_INFINITY, f64::INFINITY]);
    let cubic = [10.0, 0.0, 1e5];
    recipe.spring = SpringForce::Polynomial {
        pull: cubic,
        push: cubic,
    };
    let law = Law::new(recipe);
    for (way, goes) in [([1.0, 1.02], 1.2), ([1.0, 0.98], 0.8), ([1.1, 1.11], 1.3)] {
        let pieces = Pieces::of(&law, 1.0, reach(way, 0.0));
        let [before, after] = [way[0], goes].map(|length| law.elastic(length, 1.0).energy);
        let taken = pieces.work([way[0], goes]);
        assert!(
            taken > after - before,
            "{way:?}: {taken} J of {}",
            after - before
        );
    }
}

#[test]
fn a_rope_gives_all_the_force_that_it_can_reach_in_the_step() {
    let law = law([0.0, f64::INFINITY]);
    let reach = reach([1.1, 1.1], 1.0);
    let pieces = Pieces::of(&law, 1.0, reach);
    let tension = pieces.tension(1.1 + reach.change, reach.speed);
    let wanted = STIFFNESS * (0.1 + reach.change) + 6.0 * reach.speed;
    assert!((tension - wanted).abs() < 1e-9, "{tension}");
}

#[test]
fn a_slack_rope_that_hardens_is_as_soft_as_it_will_be_when_it_becomes_taut() {
    let mut recipe = recipe([0.0, f64::INFINITY]);
    let hardens = [100.0, 0.0, 1e4];
    recipe.spring = SpringForce::Polynomial {
        pull: hardens,
        push: hardens,
    };
    // Over the whole change of length, 0.3 m, its mean slope is ten times as much.
    let mut pieces = Pieces::of(&Law::new(recipe), 1.0, reach([0.8, 0.8], 0.0));
    let slope = pieces.spring().stiffness;
    assert!((slope / 100.0 - 1.0).abs() < 0.01, "{slope} N/m");
}
