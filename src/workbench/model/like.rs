//! Comparison that tells whether numbers were edited.

use std::fmt::Debug;

/// Whether two values are equal, where NaN counts as equal to NaN. With `==`, a value that contains NaN would look
/// edited in every frame.
pub(crate) fn is_like<T: PartialEq + Debug>(a: &T, b: &T) -> bool {
    a == b || format!("{a:?}") == format!("{b:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::SpringTravel;

    #[test]
    fn a_nan_is_like_itself_and_like_nothing_else() {
        let stops = |min: f32, max: f32| SpringTravel::new(min, max, 1.0);
        let nan = f32::NAN;
        assert!(is_like(&stops(nan, 1.0), &stops(nan, 1.0)));
        assert!(!is_like(&stops(nan, 1.0), &stops(nan, 2.0)));
        assert!(!is_like(&stops(nan, 1.0), &stops(0.0, 1.0)));
        // Adjacent floating-point numbers are different.
        let next = 0.1_f32.next_up();
        assert!(!is_like(&stops(nan, 0.1), &stops(nan, next)));
    }
}
