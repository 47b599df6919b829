//! Whether what is edited is another one than before.

use std::fmt::Debug;

/// Whether two are alike. A NaN is like a NaN here: `==` has it differ from itself, so that what has one would look edited in
/// every frame.
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
        // Neighbours among numbers are two.
        let next = 0.1_f32.next_up();
        assert!(!is_like(&stops(nan, 0.1), &stops(nan, next)));
    }
}
