//! Solves the linear system of point masses and bars by matrix-free conjugate gradients. The preconditioner is the
//! inverse of each point's diagonal block. Iterations start from the last solution.

use super::Point;
use super::kick::Bar;
use super::parts::Parts;
use crate::dynamics::conjugate::{self, Iterated};
use crate::threads::{PIECE, each, share};
use bevy::math::{DMat3, DVec3};

#[derive(Clone, Default)]
pub(super) struct Solver {
    /// Accelerations of all points, m/s²; zero for points that elements cannot move.
    pub solution: Vec<DVec3>,
    masses: Vec<f64>,
    /// Inverse of each point's diagonal block.
    blocks: Vec<DMat3>,
    residual: Vec<DVec3>,
    preconditioned: Vec<DVec3>,
    search: Vec<DVec3>,
    image: Vec<DVec3>,
    /// Partial sums, one for each piece of points.
    sums: Vec<f64>,
}

fn outer(u: DVec3) -> DMat3 {
    DMat3::from_cols(u * u.x, u * u.y, u * u.z)
}

impl Solver {
    /// Sets up the system for the movable points and bars in their present state.
    pub(super) fn begin(&mut self, points: &[Point], bars: &[Bar], parts: &Parts) {
        self.masses.resize(points.len(), 0.0);
        each(&mut self.masses, |at, mass| {
            *mass = points[at].inverse_mass.recip();
        });
        let masses = &self.masses;
        self.blocks.resize(points.len(), DMat3::ZERO);
        each(&mut self.blocks, |at, block| {
            *block = DMat3::IDENTITY * masses[at];
        });
        parts.scatter(bars, &mut self.blocks, |bar, blocks| {
            let across = DMat3::from_diagonal(DVec3::splat(bar.across));
            let own = across + outer(bar.direction) * (bar.along - bar.across);
            for end in bar.ends {
                if let Some(block) = blocks.of(end) {
                    *block += own;
                }
            }
        });
        each(&mut self.blocks, |_, block| *block = block.inverse());
        self.sums.resize(points.len().div_ceil(PIECE), 0.0);
    }

    /// Solves for `right`, which has an entry for every point. Returns whether the iterations converged.
    pub(super) fn solve(
        &mut self,
        right: &mut [DVec3],
        bars: &[Bar],
        parts: &Parts,
        budget: u32,
    ) -> bool {
        let (all, movable) = (right.len(), self.masses.len());
        right[movable..].fill(DVec3::ZERO);
        for vector in [
            &mut self.solution,
            &mut self.residual,
            &mut self.preconditioned,
            &mut self.search,
            &mut self.image,
        ] {
            vector.resize(all, DVec3::ZERO);
            vector[movable..].fill(DVec3::ZERO);
        }
        let weight = self.weigh(right);
        let (masses, sums) = (&self.masses, &mut self.sums);
        apply(masses, bars, parts, &self.solution, &mut self.image, sums);
        let (image, right) = (&self.image, &*right);
        each(&mut self.residual, |at, r| *r = right[at] - image[at]);
        // The last search direction may not be finite, so it must not get into this solve.
        each(&mut self.search, |_, p| *p = DVec3::ZERO);
        let mut running = Running {
            solver: self,
            bars,
            parts,
        };
        let residual = running.advance(0.0);
        conjugate::solve(&mut running, weight, residual, budget)
    }

    /// rᵀ P r of a vector.
    fn weigh(&mut self, r: &[DVec3]) -> f64 {
        let pieces = self.sums.iter_mut().zip(self.blocks.chunks(PIECE));
        share(pieces.zip(r.chunks(PIECE)), |((sum, blocks), r)| {
            let weighed = blocks.iter().zip(r).map(|(block, r)| r.dot(*block * *r));
            *sum = weighed.sum();
        });
        self.sums.iter().sum()
    }
}

/// A solver with its matrix.
struct Running<'a> {
    solver: &'a mut Solver,
    bars: &'a [Bar],
    parts: &'a Parts,
}

impl Iterated for Running<'_> {
    fn apply(&mut self) -> f64 {
        let Solver {
            masses,
            search,
            image,
            sums,
            ..
        } = &mut *self.solver;
        apply(masses, self.bars, self.parts, search, image, sums)
    }

    fn advance(&mut self, by: f64) -> f64 {
        let state = self.solver.solution.chunks_mut(PIECE);
        let state = state.zip(self.solver.residual.chunks_mut(PIECE));
        let state = state.zip(self.solver.preconditioned.chunks_mut(PIECE));
        let way = self
            .solver
            .search
            .chunks(PIECE)
            .zip(self.solver.image.chunks(PIECE));
        let pieces = self
            .solver
            .sums
            .iter_mut()
            .zip(self.solver.blocks.chunks(PIECE));
        let pieces = pieces.zip(state.zip(way));
        share(
            pieces,
            |((sum, blocks), (((solution, residual), preconditioned), (search, image)))| {
                *sum = 0.0;
                for (i, block) in blocks.iter().enumerate() {
                    solution[i] += by * search[i];
                    let r = residual[i] - by * image[i];
                    let z = *block * r;
                    *sum += r.dot(z);
                    residual[i] = r;
                    preconditioned[i] = z;
                }
            },
        );
        self.solver.sums.iter().sum()
    }

    fn turn(&mut self, keep: f64) {
        let search = self.solver.search.chunks_mut(PIECE);
        share(
            search.zip(self.solver.preconditioned.chunks(PIECE)),
            |(search, preconditioned)| {
                for (p, z) in search.iter_mut().zip(preconditioned) {
                    *p = keep * *p + *z;
                }
            },
        );
    }
}

/// Computes y = A x for movable points; other entries of y stay zero. Returns xᵀ A x. `sums` is a buffer for partial
/// sums.
fn apply(
    masses: &[f64],
    bars: &[Bar],
    parts: &Parts,
    x: &[DVec3],
    y: &mut [DVec3],
    sums: &mut [f64],
) -> f64 {
    let pieces = y.chunks_mut(PIECE).zip(x.chunks(PIECE));
    share(pieces.zip(masses.chunks(PIECE)), |((y, x), masses)| {
        for ((y, x), mass) in y.iter_mut().zip(x).zip(masses) {
            *y = *mass * *x;
        }
    });
    parts.scatter(bars, y, |bar, y| bar.add(y, bar.answer(bar.relative(x))));
    let pieces = sums.iter_mut().zip(y.chunks(PIECE).zip(x.chunks(PIECE)));
    share(pieces, |(sum, (y, x))| {
        *sum = x.iter().zip(y).map(|(x, y)| x.dot(*y)).sum();
    });
    sums.iter().sum()
}
