//! What rows take of memory, and what they tell.

use super::{BodyRow, ElementRow, RareBody, RareElement, Solved};
use crate::dynamics::tolerance::Outcome;

#[test]
fn an_error_beyond_all_numbers_is_told_as_the_greatest_number() {
    for error in [1e39, f64::INFINITY, f64::NAN] {
        let outcome = Outcome {
            error: Some(error),
            ..Outcome::default()
        };
        assert_eq!(Solved::from(outcome).error, f32::MAX);
    }
}

#[test]
fn a_row_is_what_a_step_reads_of_it() {
    assert_eq!(size_of::<ElementRow>(), 192);
    assert_eq!(size_of::<BodyRow>(), 64);
}

#[test]
fn what_not_every_step_needs_is_no_larger_than_it_must_be() {
    assert_eq!(size_of::<RareElement>(), 352);
    assert_eq!(size_of::<RareBody>(), 224);
}
