//! Preconditioned conjugate gradients (M. Hestenes and E. Stiefel, 1952). The matrix is not stored: it is symmetric and
//! positive definite, and the system to be solved multiplies its own vectors by it.

/// Tolerance of the solution that moves the bodies. It is well below the rounding of the engine's f32. Pinned by
/// `network::tests::what_turns_after_a_kick_is_known_well_enough`.
pub(super) const LAST: f64 = 1e-10;

/// Tolerance of a solution that only tells how lines turn after a kick. That part of the force is small, of second order in the
/// step. With [`LAST`] in its place, a large network takes about a quarter more iterations. Pinned by
/// `network::tests::what_turns_after_a_kick_is_known_well_enough`.
pub(super) const FIRST: f64 = 1e-7;

/// Factor by which rᵀ P r may exceed its value at the tolerance when the iterations run out. Up to this factor the residual
/// counts as rounding, and the solve as converged. Pinned by `conjugate::tests`.
const ROUNDING: f64 = 1e4;

/// A linear system with matrix A, and the vectors of its iterative solution: the approximate solution x, the residual r, and
/// the search direction p. P is the preconditioner.
pub(super) trait Iterated {
    /// p = P r + keep·p, then computes A p. Returns pᵀ A p.
    fn apply(&mut self, keep: f64) -> f64;

    /// x += by·p and r −= by·A p. Returns rᵀ P r.
    fn advance(&mut self, by: f64) -> f64;
}

/// When iterations end.
#[derive(Clone, Copy)]
pub(super) struct Until {
    /// Residual, relative to the right side.
    pub tolerance: f64,
    /// Greatest number of iterations.
    pub budget: u32,
}

/// Iterates. `right` is bᵀ P b of the right side b, and `residual` is rᵀ P r of the first guess. Returns whether the solution
/// converged.
pub(super) fn solve(
    system: &mut impl Iterated,
    right: f64,
    mut residual: f64,
    until: Until,
) -> bool {
    // If the right side is zero, so is the solution. Then the residual is compared with that of the first guess.
    let against = if right > 0.0 { right } else { residual };
    let target = until.tolerance * until.tolerance * against;
    let (mut iterations, mut keep) = (0, 0.0);
    while residual > target && iterations < until.budget {
        let by = residual / system.apply(keep);
        let next = system.advance(by);
        keep = next / residual;
        residual = next;
        iterations += 1;
    }
    residual <= target * ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNTIL: Until = Until {
        tolerance: LAST,
        budget: 200,
    };

    /// Three independent equations, without a preconditioner.
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
        fn apply(&mut self, keep: f64) -> f64 {
            self.applied += 1;
            for at in 0..3 {
                self.search[at] = self.residual[at] + keep * self.search[at];
            }
            (0..3).map(|at| self.search[at] * self.image(at)).sum()
        }

        fn advance(&mut self, by: f64) -> f64 {
            for at in 0..3 {
                self.x[at] += by * self.search[at];
                self.residual[at] -= by * self.image(at);
            }
            self.residual.iter().map(|r| r * r).sum()
        }
    }

    /// A system whose iterations end at a residual.
    struct Stuck(f64);

    impl Iterated for Stuck {
        fn apply(&mut self, _: f64) -> f64 {
            1.0
        }

        fn advance(&mut self, _: f64) -> f64 {
            self.0 * self.0
        }
    }

    #[test]
    fn what_is_left_counts_as_rounding_if_it_is_well_below_that_of_the_engine() {
        let rounding = f64::from(f32::EPSILON) / 2.0;
        assert!(solve(&mut Stuck(rounding / 12.0), 1.0, 1.0, UNTIL));
        assert!(!solve(&mut Stuck(rounding), 1.0, 1.0, UNTIL));
    }

    #[test]
    fn nothing_to_solve_for_is_found_from_any_first_guess() {
        let mut system = Diagonal {
            x: [3.0, -2.0, 0.7],
            ..Diagonal::default()
        };
        system.residual = std::array::from_fn(|at| -Diagonal::MATRIX[at] * system.x[at]);
        let residual = system.advance(0.0);
        assert!(solve(&mut system, 0.0, residual, UNTIL));
        assert!(system.applied <= 4, "{} times", system.applied);
        assert!(system.x.iter().all(|x| x.abs() < 1e-9), "{:?}", system.x);
    }
}
