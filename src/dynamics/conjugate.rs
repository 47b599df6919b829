//! Conjugate gradients without a matrix (M. Hestenes and E. Stiefel, 1952), preconditioned, for whoever can apply a symmetric
//! positive definite matrix to its own vectors.

/// Residual, relative to the right side, at which iterations end: well below the engine's f32. Pinned by
/// `dynamics::tests`.
const TOLERANCE: f64 = 1e-10;

/// Times the square of that by which the weight of a residual may be greater and still count as rounding.
const ROUNDING: f64 = 1e4;

/// A linear system with the vectors of its solution: what is found so far x, the residual r, and the search direction p. P is the
/// preconditioner.
pub(super) trait Iterated {
    /// Works out A p; returns pᵀ A p.
    fn apply(&mut self) -> f64;

    /// x += by·p and r −= by·A p; returns rᵀ P r.
    fn advance(&mut self, by: f64) -> f64;

    /// p = P r + keep·p.
    fn turn(&mut self, keep: f64);
}

/// Iterates where the right side has such a weight rᵀ P r and the residual that; says whether it came to an end.
pub(super) fn solve(
    system: &mut impl Iterated,
    right: f64,
    mut residual: f64,
    budget: u32,
) -> bool {
    // Without a right side the solution is zero, which nothing is small against but the first guess.
    let against = if right > 0.0 { right } else { residual };
    let target = TOLERANCE * TOLERANCE * against;
    system.turn(0.0);
    let mut iterations = 0;
    while residual > target && iterations < budget {
        let by = residual / system.apply();
        let next = system.advance(by);
        system.turn(next / residual);
        residual = next;
        iterations += 1;
    }
    residual <= target * ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three equations that do not know of each other, without a preconditioner.
    #[derive(Default)]
    struct Diagonal {
        x: [f64; 3],
        residual: [f64; 3],
        search: [f64; 3],
        applied: u32,
    }

    impl Diagonal {
        const MATRIX: [f64; 3] = [1.0, 4.0, 9.0];

        fn image(&self, at: usize) -> f64 {
            Self::MATRIX[at] * self.search[at]
        }
    }

    impl Iterated for Diagonal {
        fn apply(&mut self) -> f64 {
            self.applied += 1;
            (0..3).map(|at| self.search[at] * self.image(at)).sum()
        }

        fn advance(&mut self, by: f64) -> f64 {
            for at in 0..3 {
                self.x[at] += by * self.search[at];
                self.residual[at] -= by * self.image(at);
            }
            self.residual.iter().map(|r| r * r).sum()
        }

        fn turn(&mut self, keep: f64) {
            for at in 0..3 {
                self.search[at] = self.residual[at] + keep * self.search[at];
            }
        }
    }

    #[test]
    fn nothing_to_solve_for_is_found_from_any_first_guess() {
        let mut system = Diagonal {
            x: [3.0, -2.0, 0.7],
            ..Diagonal::default()
        };
        system.residual = std::array::from_fn(|at| -Diagonal::MATRIX[at] * system.x[at]);
        let residual = system.advance(0.0);
        assert!(solve(&mut system, 0.0, residual, 200));
        assert!(system.applied <= 4, "{} times", system.applied);
        assert!(system.x.iter().all(|x| x.abs() < 1e-9), "{:?}", system.x);
    }
}
