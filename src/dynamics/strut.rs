//! The part of an element in a network's linear system, and vectors over the bodies of a network.

use bevy::math::{DMat3, DVec3};

/// Index that stands for no body, at an end with prescribed motion.
pub(super) const NOBODY: usize = usize::MAX;

/// The part of an element in the matrix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strut {
    pub bodies: [usize; 2],
    /// Vectors from the centres of mass to the ends, world frame, m.
    pub arms: [DVec3; 2],
    pub direction: DVec3,
    /// Force that a relative acceleration along the line adds, N per m/s².
    pub along: f64,
    /// Force that a relative acceleration across the line adds, N per m/s².
    pub across: f64,
    /// Whether the element turns its bodies instead of pushing them.
    pub twist: bool,
}

/// Force that the relative acceleration `r` of two ends adds, N. `along` and `across` are the force per acceleration along the
/// `direction` of their line and across it, N per m/s².
#[inline(always)]
pub(super) fn stiff_force([along, across]: [f64; 2], direction: DVec3, r: DVec3) -> DVec3 {
    across * r + (along - across) * direction.dot(r) * direction
}

/// A vector with a linear and an angular part for every body. `angular` is empty if no body turns.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Twists {
    pub linear: Vec<DVec3>,
    pub angular: Vec<DVec3>,
}

impl Strut {
    /// Motion of end B relative to end A.
    #[inline]
    pub(super) fn relative(&self, x: &Twists) -> DVec3 {
        self.motion_at(1, x) - self.motion_at(0, x)
    }

    #[inline(always)]
    fn motion_at(&self, end: usize, x: &Twists) -> DVec3 {
        match self.bodies[end] {
            NOBODY => DVec3::ZERO,
            body if self.twist => x.angular[body],
            body if self.arms[end] == DVec3::ZERO => x.linear[body],
            body => x.linear[body] + x.angular[body].cross(self.arms[end]),
        }
    }

    /// Force that the relative acceleration `r` adds, N.
    #[inline]
    pub(super) fn force(&self, r: DVec3) -> DVec3 {
        stiff_force([self.along, self.across], self.direction, r)
    }

    /// Adds a force on end B and its opposite on end A.
    #[inline]
    pub(super) fn add(&self, to: &mut Twists, force: DVec3) {
        self.add_at(0, to, -force);
        self.add_at(1, to, force);
    }

    #[inline(always)]
    fn add_at(&self, end: usize, to: &mut Twists, force: DVec3) {
        let body = self.bodies[end];
        if body == NOBODY {
            return;
        }
        if self.twist {
            to.angular[body] += force;
            return;
        }
        to.linear[body] += force;
        if self.arms[end] != DVec3::ZERO {
            to.angular[body] += self.arms[end].cross(force);
        }
    }

    /// The matrix of [`Self::force`].
    #[inline]
    pub(super) fn matrix(&self) -> DMat3 {
        let u = self.direction;
        let outer = DMat3::from_cols(u * u.x, u * u.y, u * u.z);
        DMat3::from_diagonal(DVec3::splat(self.across)) + outer * (self.along - self.across)
    }
}

/// Product of the matrix of r ↦ a × r and another one.
#[inline]
pub(super) fn crossed(a: DVec3, m: &DMat3) -> DMat3 {
    DMat3::from_cols(a.cross(m.x_axis), a.cross(m.y_axis), a.cross(m.z_axis))
}

impl Twists {
    pub(super) fn clear(&mut self, bodies: usize, turns: bool) {
        self.linear.clear();
        self.angular.clear();
        self.fit(bodies, turns);
    }

    /// Makes room for every body. The values of what was there remain.
    pub(super) fn fit(&mut self, bodies: usize, turns: bool) {
        self.linear.resize(bodies, DVec3::ZERO);
        self.angular
            .resize(if turns { bodies } else { 0 }, DVec3::ZERO);
    }

    pub(super) fn fits(&self, bodies: usize, turns: bool) -> bool {
        self.linear.len() == bodies && self.angular.len() == if turns { bodies } else { 0 }
    }

    pub(super) fn dot(&self, other: &Self) -> f64 {
        let sum = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
        sum(&self.linear, &other.linear) + sum(&self.angular, &other.angular)
    }

    /// self = by·self + other·times.
    pub(super) fn combine(&mut self, by: f64, other: &Self, times: f64) {
        let all = |a: &mut [DVec3], b: &[DVec3]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = by * *a + times * *b;
            }
        };
        all(&mut self.linear, &other.linear);
        all(&mut self.angular, &other.angular);
    }

    pub(super) fn mask(&mut self, free: &Self) {
        for (a, b) in self.linear.iter_mut().zip(&free.linear) {
            *a *= *b;
        }
        for (a, b) in self.angular.iter_mut().zip(&free.angular) {
            *a *= *b;
        }
    }
}
