//! How often the inverse mass that joints and contacts leave is computed again.

use super::Leeway;

const FREE: [(bool, bool); 2] = [(false, false); 2];
const PRESSED: [(bool, bool); 2] = [(false, true), (false, false)];
const MASSES: [f64; 2] = [1.0, 0.0];

/// Number of times that it is computed in steps in which contacts hold the ends in turn like `by`.
fn computed(by: impl Iterator<Item = [(bool, bool); 2]>) -> usize {
    let mut leeway = Leeway::default();
    by.filter(|by| leeway.is_due(*by, MASSES, true)).count()
}

#[test]
fn a_foot_that_drums_is_not_computed_anew_at_every_beat() {
    let beats = (0..64).map(|step| if step % 2 == 0 { PRESSED } else { FREE });
    let times = computed(beats);
    assert!(times <= 16, "{times} times in 64 steps");
}

#[test]
fn a_wheel_that_takes_off_is_free_within_a_sixth_of_a_second() {
    let mut leeway = Leeway::default();
    assert!(leeway.is_due(PRESSED, MASSES, true));
    let steps = (1..).find(|_| leeway.is_due(FREE, MASSES, true));
    assert!(steps.is_some_and(|steps| steps <= 10), "{steps:?} steps");
}

#[test]
fn what_joints_leave_is_computed_about_once_a_second_while_nothing_lets_go() {
    let times = computed([PRESSED; 600].into_iter());
    assert!(
        (9..=20).contains(&times),
        "{times} times in ten seconds of 60 steps"
    );
}
