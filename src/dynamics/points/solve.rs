//! Solves the linear system of point masses and bars: a small or a narrow one [directly](Direct), all others by matrix-free
//! conjugate gradients. Their preconditioner is the inverse of each point's diagonal block. Iterations start from the last
//! solution.
//!
//! A large system does not fit into the processor's cache, so that each list that is read costs time. What is done with a
//! body or an element is done in one pass where that is possible.

use super::bar::{Bar, add};
use super::parts::{Parts, Run, places};
use crate::dynamics::conjugate::{self, Iterated, Until};
use crate::dynamics::direct::{Direct, Own};
use crate::dynamics::strut::{NOBODY, Strut};
use crate::threads::{PIECE, each, share_pieces};
use bevy::math::{DMat3, DVec3};

/// A symmetric matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    diagonal: DVec3,
    /// Entries of x and y, of x and z, and of y and z.
    beside: DVec3,
}

/// The system, and the vectors of its iterative solution. Vectors have an entry for each body.
#[derive(Clone, Default)]
pub(super) struct Solver {
    /// Accelerations of all points, m/s²; zero for points that elements cannot move.
    pub solution: Vec<DVec3>,
    pub masses: Vec<f64>,
    /// Each body's diagonal block, and later its inverse.
    pub blocks: Vec<Block>,
    /// The right side.
    pub right: Vec<DVec3>,
    /// The product of the matrix with the solution, and during iterations with the search direction.
    pub image: Vec<DVec3>,
    residual: Vec<DVec3>,
    preconditioned: Vec<DVec3>,
    search: Vec<DVec3>,
    /// Partial sums.
    sums: Vec<f64>,
    starts: Vec<[f64; 2]>,
    direct: Direct,
    /// Whether `direct` can solve with the present bars.
    factorised: bool,
}

impl Block {
    pub(super) fn of_mass(mass: f64) -> Self {
        Self {
            diagonal: DVec3::splat(mass),
            beside: DVec3::ZERO,
        }
    }

    /// What an element adds to the block of each of its ends.
    #[inline(always)]
    pub(super) fn of_bar(bar: &Bar) -> Self {
        let (u, more) = (bar.direction, bar.along - bar.across);
        Self {
            diagonal: bar.across + u * u * more,
            beside: DVec3::new(u.x * u.y, u.x * u.z, u.y * u.z) * more,
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.diagonal += other.diagonal;
        self.beside += other.beside;
    }

    fn inverse(&self) -> Self {
        let (d, b) = (self.diagonal, self.beside);
        let inverse = DMat3::from_cols(
            DVec3::new(d.x, b.x, b.y),
            DVec3::new(b.x, d.y, b.z),
            DVec3::new(b.y, b.z, d.z),
        )
        .inverse();
        let (x, y, z) = (inverse.x_axis, inverse.y_axis, inverse.z_axis);
        Self {
            diagonal: DVec3::new(x.x, y.y, z.z),
            beside: DVec3::new(x.y, x.z, y.z),
        }
    }

    #[inline(always)]
    fn times(&self, r: DVec3) -> DVec3 {
        let (d, b) = (self.diagonal, self.beside);
        DVec3::new(d.x, b.x, b.y) * r.x
            + DVec3::new(b.x, d.y, b.z) * r.y
            + DVec3::new(b.y, b.z, d.z) * r.z
    }
}

impl Solver {
    /// Makes room for a number of bodies, and a solution for a number of points.
    pub(super) fn resize(&mut self, bodies: usize, points: usize) {
        self.solution.resize(points, DVec3::ZERO);
        self.solution[bodies..].fill(DVec3::ZERO);
        self.masses.resize(bodies, 0.0);
        self.blocks.resize(bodies, Block::default());
        for vector in [
            &mut self.right,
            &mut self.image,
            &mut self.residual,
            &mut self.preconditioned,
            &mut self.search,
        ] {
            vector.resize(bodies, DVec3::ZERO);
        }
        self.sums.resize(bodies.div_ceil(PIECE), 0.0);
    }

    /// Begins a network of `bodies` bodies whose elements join `pairs` of them.
    pub(super) fn join(&mut self, bodies: usize, pairs: impl Iterator<Item = [usize; 2]>) {
        self.direct.number((0..bodies).map(|_| false));
        self.direct.join(pairs);
    }

    /// Whether the last solve needed no iterations.
    pub(super) fn is_direct(&self) -> bool {
        self.factorised
    }

    /// Prepares the solve for the present bars. `soft` says whether few iterations would do.
    pub(super) fn prepare(&mut self, bars: &[Bar], soft: bool) {
        let (masses, last) = (&self.masses, self.masses.len());
        let body = |body: usize| Own {
            mass: DMat3::from_diagonal(DVec3::splat(masses[body])),
            inertia: DMat3::IDENTITY,
            free: DVec3::ONE,
            free_to_turn: DVec3::ONE,
        };
        let index = |end: u32| Some(end as usize).filter(|end| *end < last);
        let struts = bars.iter().map(|bar| Strut {
            bodies: bar.ends.map(|end| index(end).unwrap_or(NOBODY)),
            arms: [DVec3::ZERO; 2],
            direction: bar.direction,
            along: bar.along,
            across: bar.across,
            twist: false,
        });
        self.factorised = !soft && self.direct.is_cheaper() && self.direct.factorise(body, struts);
        if !self.factorised {
            // Wide, or stiff beyond what f64 can factorise.
            each(&mut self.blocks, |_, block| *block = block.inverse());
        }
    }

    /// Solves for the right side. `image` must be the product of the matrix with the last solution. Returns whether the
    /// iterations converged.
    pub(super) fn solve(&mut self, bars: &[Bar], parts: &Parts, until: Until) -> bool {
        if self.factorised {
            let solution = &mut self.solution[..self.right.len()];
            solution.copy_from_slice(&self.right);
            self.direct.solve(solution, &mut []);
            return true;
        }
        let [weight, residual] = self.start();
        let mut running = Running {
            solver: self,
            bars,
            parts,
        };
        conjugate::solve(&mut running, weight, residual, until)
    }

    /// Computes the residual. Returns bᵀ P b of the right side b and rᵀ P r of the residual.
    fn start(&mut self) -> [f64; 2] {
        let pieces = self.blocks.len().div_ceil(PIECE);
        self.starts.clear();
        self.starts.resize(pieces, [0.0; 2]);
        let sides = self.right.chunks(PIECE).zip(self.image.chunks(PIECE));
        let vectors = self.residual.chunks_mut(PIECE);
        let vectors = vectors.zip(self.preconditioned.chunks_mut(PIECE));
        let pieces = self.starts.iter_mut().zip(self.blocks.chunks(PIECE));
        let pieces = pieces.zip(sides).zip(vectors);
        share_pieces(
            pieces,
            |(((sums, blocks), (right, image)), (residual, preconditioned))| {
                for (i, block) in blocks.iter().enumerate() {
                    let (b, r) = (right[i], right[i] - image[i]);
                    let z = block.times(r);
                    sums[0] += b.dot(block.times(b));
                    sums[1] += r.dot(z);
                    residual[i] = r;
                    preconditioned[i] = z;
                }
            },
        );
        let sum = |of: usize| self.starts.iter().map(|sums| sums[of]).sum();
        [sum(0), sum(1)]
    }
}

/// A solver with its matrix.
struct Running<'a> {
    solver: &'a mut Solver,
    bars: &'a [Bar],
    parts: &'a Parts,
}

impl Iterated for Running<'_> {
    fn apply(&mut self, keep: f64) -> f64 {
        let Solver {
            masses,
            preconditioned,
            search,
            image,
            sums,
            ..
        } = &mut *self.solver;
        for stage in self.parts.stages() {
            let known = (&masses[..], &preconditioned[..]);
            let of_bodies = (known, &mut search[..], &mut image[..]);
            let parts = self.parts;
            parts.pass_with(*stage, self.bars, of_bodies, sums, |run, sum| {
                let Run {
                    elements: bars,
                    bodies: ((masses, z), x, y),
                    first,
                } = run;
                let y = &mut y[..x.len()];
                if stage.is_first() {
                    for (((x, y), z), mass) in x.iter_mut().zip(&mut *y).zip(z).zip(masses) {
                        // The last direction of an earlier solve may not be finite.
                        *x = if keep == 0.0 { *z } else { keep * *x + *z };
                        *y = *mass * *x;
                    }
                }
                for bar in bars {
                    let places = places(bar.ends, first);
                    let value = |at: usize| x.get(at).copied().unwrap_or(DVec3::ZERO);
                    add(y, places, bar.answer(value(places[1]) - value(places[0])));
                }
                if stage.is_last() {
                    *sum = x.iter().zip(y).map(|(x, y)| x.dot(*y)).sum();
                }
            });
        }
        sums.iter().sum()
    }

    fn advance(&mut self, by: f64) -> f64 {
        let solver = &mut *self.solver;
        let pieces = solver.blocks.len().div_ceil(PIECE);
        solver.sums.resize(pieces, 0.0);
        let state = solver.solution.chunks_mut(PIECE);
        let state = state.zip(solver.residual.chunks_mut(PIECE));
        let state = state.zip(solver.preconditioned.chunks_mut(PIECE));
        let way = solver.search.chunks(PIECE).zip(solver.image.chunks(PIECE));
        let pieces = solver.sums.iter_mut().zip(solver.blocks.chunks(PIECE));
        let pieces = pieces.zip(state.zip(way));
        share_pieces(
            pieces,
            |((sum, blocks), (((solution, residual), preconditioned), (search, image)))| {
                *sum = 0.0;
                for (i, block) in blocks.iter().enumerate() {
                    solution[i] += by * search[i];
                    let r = residual[i] - by * image[i];
                    let z = block.times(r);
                    *sum += r.dot(z);
                    residual[i] = r;
                    preconditioned[i] = z;
                }
            },
        );
        solver.sums.iter().sum()
    }
}
