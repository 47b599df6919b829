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
    let target = TOLERANCE * TOLERANCE * right;
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
