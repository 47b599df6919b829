//! The linear system of a network: masses on the diagonal, and one strut for each element. It is symmetric and positive
//! definite.
//!
//! Small systems, and long and narrow ones, are [factorised](Direct). All others are solved by matrix-free conjugate gradients
//! from the last solution. Their preconditioner is the inverse of each body's diagonal block.

use super::body::{Body, Spin};
use super::conjugate::{self, Iterated, Until};
use super::delivery::free_inertia;
use super::direct::{Direct, Own};
use super::strut::{NOBODY, Strut, Twists, crossed};
use bevy::math::{DMat3, DVec3};
use std::mem::replace;

#[derive(Clone, Default)]
pub(super) struct System {
    pub struts: Vec<Strut>,
    mass: Vec<DMat3>,
    inertia: Vec<DMat3>,
    /// 1 on axes that are free, 0 on locked ones.
    free: Twists,
    turns: bool,
    blocks: Vec<DMat3>,
    blocks_turning: Vec<Block>,
    direct: Direct,
    /// Whether a factorisation is cheaper than iterations.
    is_direct: bool,
    /// Whether `direct` can solve with the present struts.
    factorised: bool,
    /// Whether the last solution is that of a factorisation.
    was_factorised: bool,
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
    fn apply(&mut self, keep: f64) -> f64 {
        let Vectors {
            preconditioned,
            search,
            image,
            ..
        } = &mut self.vectors;
        search.combine(keep, preconditioned, 1.0);
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
}

impl System {
    /// Loads masses and inertias, and removes all struts.
    pub(super) fn begin(&mut self, bodies: &[Body]) {
        self.struts.clear();
        self.turns = bodies.iter().any(|body| body.spin != Spin::Ignored);
        self.mass.clear();
        self.inertia.clear();
        self.free.clear(bodies.len(), self.turns);
        let turns = bodies.iter().map(|body| body.spin != Spin::Ignored);
        self.direct.number(turns);
        for (i, body) in bodies.iter().enumerate() {
            let w = body.inverse_mass;
            let free = DVec3::select(w.cmpgt(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
            self.free.linear[i] = free;
            let mass = DVec3::select(w.cmpgt(DVec3::ZERO), w.recip(), DVec3::ONE);
            self.mass.push(DMat3::from_diagonal(mass));
            let turns = body.spin != Spin::Ignored;
            if self.turns && !turns {
                self.inertia.push(DMat3::IDENTITY);
            }
            if turns {
                let (inertia, free) = free_inertia(body.inverse_inertia());
                self.free.angular[i] = free;
                self.inertia.push(inertia);
            }
        }
    }

    pub(super) fn turns(&self) -> bool {
        self.turns
    }

    pub(super) fn is_direct(&self) -> bool {
        self.is_direct
    }

    pub(super) fn was_factorised(&self) -> bool {
        self.was_factorised
    }

    /// Prepares the solve for the present struts.
    pub(super) fn prepare(&mut self) {
        let struts = self.struts.iter().copied();
        self.direct.join(struts.clone().map(|strut| strut.bodies));
        // Where bodies turn, iterations are so expensive that even a few cost more than a factorisation.
        self.is_direct = self.direct.is_cheaper();
        let bodies = |body: usize| Own {
            mass: self.mass[body],
            inertia: *self.inertia.get(body).unwrap_or(&DMat3::IDENTITY),
            free: self.free.linear[body],
            free_to_turn: *self.free.angular.get(body).unwrap_or(&DVec3::ONE),
        };
        self.factorised = self.is_direct && self.direct.factorise(bodies, struts);
        if !self.factorised {
            // Wide, or stiff beyond what f64 can factorise.
            self.invert_blocks();
        }
    }

    /// Solves for `right`. Iterations start from `x`, the last solution, or from zero if that is of a factorisation: a snapshot does
    /// not keep it. Returns whether they converged.
    pub(super) fn solve(&mut self, right: &mut Twists, x: &mut Twists, until: Until) -> bool {
        right.mask(&self.free);
        let was_factorised = replace(&mut self.was_factorised, self.factorised);
        let starts_anew = was_factorised && !self.factorised;
        if starts_anew || !x.fits(self.mass.len(), self.turns) {
            x.clear(self.mass.len(), self.turns);
        }
        if self.factorised {
            x.linear.clone_from(&right.linear);
            x.angular.clone_from(&right.angular);
            self.direct.solve(&mut x.linear, &mut x.angular);
            return true;
        }
        self.iterate(right, x, until)
    }

    /// y = A x.
    fn apply(&self, x: &Twists, y: &mut Twists) {
        y.fit(self.mass.len(), self.turns);
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

    fn iterate(&mut self, right: &Twists, x: &mut Twists, until: Until) -> bool {
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
        let converged = conjugate::solve(&mut running, weight, residual, until);
        self.vectors = running.vectors;
        converged
    }

    fn precondition(&self, r: &Twists, z: &mut Twists) {
        z.fit(self.mass.len(), self.turns);
        if !self.turns {
            for ((z, r), block) in z.linear.iter_mut().zip(&r.linear).zip(&self.blocks) {
                *z = *block * *r;
            }
            return;
        }
        for (i, block) in self.blocks_turning.iter().enumerate() {
            let (linear, angular) = (r.linear[i], r.angular[i]);
            z.linear[i] = block.linear * linear + block.across * angular;
            z.angular[i] = block.across.transpose() * linear + block.angular * angular;
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
        let own = |(mass, inertia): (&DMat3, &DMat3)| Block {
            linear: *mass,
            across: DMat3::ZERO,
            angular: *inertia,
        };
        self.blocks_turning
            .extend(self.mass.iter().zip(&self.inertia).map(own));
        for strut in &self.struts {
            let own = strut.matrix();
            for (body, arm) in strut.bodies.into_iter().zip(strut.arms) {
                if body == NOBODY {
                    continue;
                }
                let block = &mut self.blocks_turning[body];
                if strut.twist {
                    block.angular += own;
                    continue;
                }
                block.linear += own;
                if arm != DVec3::ZERO {
                    let swung = crossed(arm, &own).transpose();
                    block.across += swung;
                    block.angular += crossed(arm, &swung);
                }
            }
        }
        for (i, block) in self.blocks_turning.iter_mut().enumerate() {
            block.lock(self.free.linear[i], self.free.angular[i]);
            *block = block.inverse();
        }
    }
}

/// The part of the matrix that concerns one body alone: its velocity, its angular velocity, and what couples the two. The
/// rest is the transpose of `across`.
#[derive(Clone, Copy)]
struct Block {
    linear: DMat3,
    across: DMat3,
    angular: DMat3,
}

impl Block {
    const IDENTITY: Self = Self {
        linear: DMat3::IDENTITY,
        across: DMat3::ZERO,
        angular: DMat3::IDENTITY,
    };

    fn lock(&mut self, linear: DVec3, angular: DVec3) {
        lock(&mut self.linear, linear);
        lock(&mut self.angular, angular);
        for k in 0..3 {
            *self.across.col_mut(k) *= linear * angular[k];
        }
    }

    /// Inverts by the Schur complement of the linear part. Where rounding leaves nothing positive, the identity serves as well.
    fn inverse(&self) -> Self {
        let linear = self.linear.inverse();
        let moved = linear * self.across;
        let angular = (self.angular - self.across.transpose() * moved).inverse();
        let out = Self {
            linear: linear + moved * angular * moved.transpose(),
            across: -(moved * angular),
            angular,
        };
        let positive = |m: &DMat3| m.is_finite() && (0..3).all(|k| m.col(k)[k] > 0.0);
        if positive(&out.linear) && positive(&out.angular) && out.across.is_finite() {
            out
        } else {
            Self::IDENTITY
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
