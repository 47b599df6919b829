//! The linear system of point masses and bars: conjugate gradients without a matrix, preconditioned by
//! the inverse of each point's own block, from the last solution.

use super::Point;
use super::kick::Bar;
use bevy::math::{DMat3, DVec3};

/// Residual, relative to the right side, at which iterations end: well below the engine's f32.
const TOLERANCE: f64 = 1e-10;

#[derive(Clone, Default)]
pub(super) struct Solver {
    /// Accelerations of all points; of those that elements cannot move zero.
    pub solution: Vec<DVec3>,
    masses: Vec<f64>,
    /// The inverse of each point's own block.
    blocks: Vec<DMat3>,
    residual: Vec<DVec3>,
    preconditioned: Vec<DVec3>,
    search: Vec<DVec3>,
    image: Vec<DVec3>,
}

fn outer(u: DVec3) -> DMat3 {
    DMat3::from_cols(u * u.x, u * u.y, u * u.z)
}

impl Solver {
    /// Takes in the movable points and the bars as they are now.
    pub(super) fn begin(&mut self, points: &[Point], bars: &[Bar]) {
        self.masses.clear();
        self.masses
            .extend(points.iter().map(|point| point.inverse_mass.recip()));
        self.blocks.clear();
        self.blocks
            .extend(self.masses.iter().map(|m| DMat3::IDENTITY * *m));
        for bar in bars {
            let across = DMat3::from_diagonal(DVec3::splat(bar.across));
            let own = across + outer(bar.direction) * (bar.along - bar.across);
            for end in bar.ends {
                if let Some(block) = self.blocks.get_mut(end as usize) {
                    *block += own;
                }
            }
        }
        for block in &mut self.blocks {
            *block = block.inverse();
        }
    }

    /// Solves for `right`, whose length is the number of all points; says whether it came to an end.
    pub(super) fn solve(&mut self, right: &mut [DVec3], bars: &[Bar], budget: u32) -> bool {
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
        let target = TOLERANCE * TOLERANCE * self.weigh(right);
        apply(&self.masses, bars, &self.solution, &mut self.residual);
        let mut rz = 0.0;
        let vectors = self.residual.iter_mut().zip(&mut self.preconditioned);
        for (((r, z), block), right) in vectors.zip(&self.blocks).zip(&*right) {
            *r = *right - *r;
            *z = *block * *r;
            rz += r.dot(*z);
        }
        self.search.copy_from_slice(&self.preconditioned);
        let mut iterations = 0;
        while rz > target && iterations < budget {
            let kinked = apply(&self.masses, bars, &self.search, &mut self.image);
            rz = self.advance(rz / kinked, rz);
            iterations += 1;
        }
        // Short of the target by so little is rounding.
        rz <= target * 1e4
    }

    /// rᵀ P r of a vector.
    fn weigh(&self, r: &[DVec3]) -> f64 {
        let weighed = self
            .blocks
            .iter()
            .zip(r)
            .map(|(block, r)| r.dot(*block * *r));
        weighed.sum()
    }

    /// Goes so far along the search direction and chooses the next; returns the new rᵀ P r.
    fn advance(&mut self, by: f64, rz: f64) -> f64 {
        let mut next = 0.0;
        for (i, block) in self.blocks.iter().enumerate() {
            self.solution[i] += by * self.search[i];
            let r = self.residual[i] - by * self.image[i];
            let z = *block * r;
            next += r.dot(z);
            self.residual[i] = r;
            self.preconditioned[i] = z;
        }
        let keep = next / rz;
        for (p, z) in self.search.iter_mut().zip(&self.preconditioned) {
            *p = keep * *p + *z;
        }
        next
    }
}

/// y = A x for movable points, 0 for others; returns xᵀ A x.
fn apply(masses: &[f64], bars: &[Bar], x: &[DVec3], y: &mut [DVec3]) -> f64 {
    y.fill(DVec3::ZERO);
    for bar in bars {
        bar.add(y, bar.answer(bar.relative(x)));
    }
    let mut sum = 0.0;
    for ((y, x), mass) in y.iter_mut().zip(x).zip(masses) {
        *y += *mass * *x;
        sum += x.dot(*y);
    }
    y[masses.len()..].fill(DVec3::ZERO);
    sum
}
