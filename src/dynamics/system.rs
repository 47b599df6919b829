//! The linear system of a network: masses on the diagonal, and one strut for each element. It is symmetric and positive
//! definite.
//!
//! Small systems are factorised. Large ones are solved by matrix-free conjugate gradients from the last solution. Their
//! preconditioner is the inverse of each body's diagonal block.

use super::body::{Body, Spin};
use super::conjugate::{self, Iterated};
use super::strut::{NOBODY, Strut, Twists, cross};
use bevy::math::{DMat3, DVec3};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix6, Vector6};

/// Number of unknowns up to which a factorisation is cheaper than iterations.
pub(super) const DENSE: usize = 96;

/// Result of a solve.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    pub converged: bool,
}

#[derive(Clone, Default)]
pub(super) struct System {
    pub struts: Vec<Strut>,
    mass: Vec<DMat3>,
    inertia: Vec<DMat3>,
    /// 1 on axes that are free, 0 on locked ones.
    free: Twists,
    turns: bool,
    /// For each body, the index of its first unknown in the matrix, and whether its rotation is among the unknowns.
    places: Vec<(usize, bool)>,
    unknowns: usize,
    blocks: Vec<DMat3>,
    blocks_turning: Vec<Matrix6<f64>>,
    matrix: DMatrix<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
    vector: DVector<f64>,
    vectors: Vectors,
}

/// See [`Iterated`].
#[derive(Clone, Default)]
struct Vectors {
    residual: Twists,
    preconditioned: Twists,
    search: Twists,
    image: Twists,
}

/// State of the iterations for a system.
struct Running<'a> {
    system: &'a System,
    vectors: Vectors,
    x: &'a mut Twists,
}

impl Iterated for Running<'_> {
    fn apply(&mut self) -> f64 {
        let Vectors { search, image, .. } = &mut self.vectors;
        self.system.apply(search, image);
        search.dot(image)
    }

    fn advance(&mut self, by: f64) -> f64 {
        let Vectors {
            residual,
            preconditioned,
            search,
            image,
        } = &mut self.vectors;
        self.x.combine(1.0, search, by);
        residual.combine(1.0, image, -by);
        self.system.precondition(residual, preconditioned);
        residual.dot(preconditioned)
    }

    fn turn(&mut self, keep: f64) {
        let Vectors {
            preconditioned,
            search,
            ..
        } = &mut self.vectors;
        search.combine(keep, preconditioned, 1.0);
    }
}

impl System {
    /// Loads masses and inertias, and removes all struts.
    pub(super) fn begin(&mut self, bodies: &[Body]) {
        self.struts.clear();
        self.turns = bodies.iter().any(|body| body.spin != Spin::Ignored);
        self.mass.clear();
        self.inertia.clear();
        self.free.clear(bodies.len(), self.turns);
        self.places.clear();
        self.unknowns = 0;
        for (i, body) in bodies.iter().enumerate() {
            let w = body.inverse_mass;
            let free = DVec3::select(w.cmpgt(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
            self.free.linear[i] = free;
            let mass = DVec3::select(w.cmpgt(DVec3::ZERO), w.recip(), DVec3::ONE);
            self.mass.push(DMat3::from_diagonal(mass));
            let turns = body.spin != Spin::Ignored;
            self.places.push((self.unknowns, turns));
            self.unknowns += if turns { 6 } else { 3 };
            if self.turns && !turns {
                self.inertia.push(DMat3::IDENTITY);
            }
            if turns {
                let mut inverse = body.inverse_inertia();
                let mut free = DVec3::ONE;
                for k in 0..3 {
                    if inverse.col(k)[k] == 0.0 {
                        inverse.col_mut(k)[k] = 1.0;
                        free[k] = 0.0;
                    }
                }
                self.free.angular[i] = free;
                self.inertia.push(inverse.inverse());
            }
        }
        self.factor = None;
    }

    pub(super) fn turns(&self) -> bool {
        self.turns
    }

    pub(super) fn is_dense(&self) -> bool {
        self.unknowns <= DENSE
    }

    /// Prepares the solve for the present struts.
    pub(super) fn prepare(&mut self) {
        if self.is_dense() {
            self.factorise();
        }
        if self.factor.is_none() {
            // Large, or stiff beyond what f64 can factorise.
            self.invert_blocks();
        }
    }

    /// Solves for `right`. Iterations start from `x`.
    pub(super) fn solve(&mut self, right: &mut Twists, x: &mut Twists, budget: u32) -> Effort {
        right.mask(&self.free);
        if !x.fits(self.mass.len(), self.turns) {
            x.clear(self.mass.len(), self.turns);
        }
        if let Some(factor) = &self.factor {
            scatter(right, &self.places, &mut self.vector);
            factor.solve_mut(&mut self.vector);
            gather(&self.vector, &self.places, x);
            return Effort { converged: true };
        }
        self.iterate(right, x, budget)
    }

    /// y = A x.
    fn apply(&self, x: &Twists, y: &mut Twists) {
        y.clear(self.mass.len(), self.turns);
        for ((y, x), m) in y.linear.iter_mut().zip(&x.linear).zip(&self.mass) {
            *y = *m * *x;
        }
        for ((y, x), inertia) in y.angular.iter_mut().zip(&x.angular).zip(&self.inertia) {
            *y = *inertia * *x;
        }
        for strut in &self.struts {
            strut.add(y, strut.force(strut.relative(x)));
        }
        y.mask(&self.free);
    }

    fn iterate(&mut self, right: &Twists, x: &mut Twists, budget: u32) -> Effort {
        x.mask(&self.free);
        let mut vectors = std::mem::take(&mut self.vectors);
        self.precondition(right, &mut vectors.preconditioned);
        let weight = right.dot(&vectors.preconditioned);
        self.apply(x, &mut vectors.residual);
        vectors.residual.combine(-1.0, right, 1.0);
        for vector in [&mut vectors.search, &mut vectors.image] {
            vector.clear(self.mass.len(), self.turns);
        }
        let mut running = Running {
            system: self,
            vectors,
            x,
        };
        let residual = running.advance(0.0);
        let converged = conjugate::solve(&mut running, weight, residual, budget);
        self.vectors = running.vectors;
        Effort { converged }
    }

    fn precondition(&self, r: &Twists, z: &mut Twists) {
        z.clear(self.mass.len(), self.turns);
        if !self.turns {
            for ((z, r), block) in z.linear.iter_mut().zip(&r.linear).zip(&self.blocks) {
                *z = *block * *r;
            }
            return;
        }
        for (i, block) in self.blocks_turning.iter().enumerate() {
            let v = block * stack(r.linear[i], r.angular[i]);
            z.linear[i] = DVec3::new(v[0], v[1], v[2]);
            z.angular[i] = DVec3::new(v[3], v[4], v[5]);
        }
    }

    /// Inverts each body's diagonal block.
    fn invert_blocks(&mut self) {
        self.blocks.clear();
        self.blocks_turning.clear();
        if !self.turns {
            self.blocks.extend_from_slice(&self.mass);
            for strut in &self.struts {
                let own = strut.matrix();
                for body in strut.bodies.into_iter().filter(|b| *b != NOBODY) {
                    self.blocks[body] += own;
                }
            }
            for (block, free) in self.blocks.iter_mut().zip(&self.free.linear) {
                lock(block, *free);
                *block = block.inverse();
            }
            return;
        }
        for (mass, inertia) in self.mass.iter().zip(&self.inertia) {
            let mut block = Matrix6::zeros();
            put(&mut block, 0, 0, *mass);
            put(&mut block, 3, 3, *inertia);
            self.blocks_turning.push(block);
        }
        for strut in &self.struts {
            let own = strut.matrix();
            for (body, arm) in strut.bodies.into_iter().zip(strut.arms) {
                if body == NOBODY {
                    continue;
                }
                let (lever, block) = (cross(arm), &mut self.blocks_turning[body]);
                if strut.twist {
                    put(block, 3, 3, own);
                    continue;
                }
                put(block, 0, 0, own);
                put(block, 0, 3, own * -lever);
                put(block, 3, 0, lever * own);
                put(block, 3, 3, lever * own * -lever);
            }
        }
        for (i, block) in self.blocks_turning.iter_mut().enumerate() {
            let free = stack(self.free.linear[i], self.free.angular[i]);
            for k in (0..6).filter(|k| free[*k] == 0.0) {
                block.row_mut(k).fill(0.0);
                block.column_mut(k).fill(0.0);
                block[(k, k)] = 1.0;
            }
            *block = block
                .cholesky()
                .map_or_else(Matrix6::identity, |c| c.inverse());
        }
    }

    fn factorise(&mut self) {
        let n = self.unknowns;
        let mut matrix = std::mem::take(&mut self.matrix);
        if matrix.nrows() != n {
            matrix = DMatrix::zeros(n, n);
            self.vector = DVector::zeros(n);
        }
        matrix.fill(0.0);
        for (i, (at, turns)) in self.places.iter().enumerate() {
            put(&mut matrix, *at, *at, self.mass[i]);
            if *turns {
                put(&mut matrix, at + 3, at + 3, self.inertia[i]);
            }
        }
        for strut in &self.struts {
            let own = strut.matrix();
            for (i, row) in strut.bodies.into_iter().enumerate() {
                for (j, column) in strut.bodies.into_iter().enumerate() {
                    if row == NOBODY || column == NOBODY {
                        continue;
                    }
                    let own = if i == j { own } else { own * -1.0 };
                    let ((r, r_turns), (c, c_turns)) = (self.places[row], self.places[column]);
                    if strut.twist {
                        if r_turns && c_turns {
                            put(&mut matrix, r + 3, c + 3, own);
                        }
                        continue;
                    }
                    put(&mut matrix, r, c, own);
                    let (a, b) = (cross(strut.arms[i]), cross(strut.arms[j]));
                    if c_turns {
                        put(&mut matrix, r, c + 3, own * -b);
                    }
                    if r_turns {
                        put(&mut matrix, r + 3, c, a * own);
                    }
                    if r_turns && c_turns {
                        put(&mut matrix, r + 3, c + 3, a * own * -b);
                    }
                }
            }
        }
        for (i, (at, turns)) in self.places.iter().enumerate() {
            for k in 0..3 {
                if self.free.linear[i][k] == 0.0 {
                    lock_row(&mut matrix, at + k);
                }
                if *turns && self.free.angular[i][k] == 0.0 {
                    lock_row(&mut matrix, at + 3 + k);
                }
            }
        }
        self.factor = Cholesky::new(matrix);
    }

    /// Keeps the memory of the factorisation for the next one.
    pub(super) fn end(&mut self) {
        if let Some(factor) = self.factor.take() {
            self.matrix = factor.unpack_dirty();
        }
    }
}

fn lock(block: &mut DMat3, free: DVec3) {
    for k in (0..3).filter(|k| free[*k] == 0.0) {
        for other in 0..3 {
            block.col_mut(k)[other] = 0.0;
            block.col_mut(other)[k] = 0.0;
        }
        block.col_mut(k)[k] = 1.0;
    }
}

fn lock_row(matrix: &mut DMatrix<f64>, index: usize) {
    matrix.row_mut(index).fill(0.0);
    matrix.column_mut(index).fill(0.0);
    matrix[(index, index)] = 1.0;
}

/// Adds a block to a matrix.
fn put<M: std::ops::IndexMut<(usize, usize), Output = f64>>(
    matrix: &mut M,
    row: usize,
    column: usize,
    block: DMat3,
) {
    for c in 0..3 {
        for r in 0..3 {
            matrix[(row + r, column + c)] += block.col(c)[r];
        }
    }
}

fn stack(linear: DVec3, angular: DVec3) -> Vector6<f64> {
    Vector6::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    )
}

fn scatter(from: &Twists, places: &[(usize, bool)], to: &mut DVector<f64>) {
    for (i, (at, turns)) in places.iter().enumerate() {
        for k in 0..3 {
            to[at + k] = from.linear[i][k];
            if *turns {
                to[at + 3 + k] = from.angular[i][k];
            }
        }
    }
}

fn gather(from: &DVector<f64>, places: &[(usize, bool)], to: &mut Twists) {
    for (i, (at, turns)) in places.iter().enumerate() {
        for k in 0..3 {
            to.linear[i][k] = from[at + k];
            if *turns {
                to.angular[i][k] = from[at + 3 + k];
            }
        }
        if let (false, Some(angular)) = (*turns, to.angular.get_mut(i)) {
            // The body may have turned in an earlier step.
            *angular = DVec3::ZERO;
        }
    }
}
