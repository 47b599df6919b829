//! Computes the inverse effective mass that joints and contacts leave an element.
//!
//! With inverse masses W and constraints J v = 0, a unit impulse along the row e changes the velocity along e by
//! e W eᵀ − e W Jᵀ (J W Jᵀ)⁻¹ J W eᵀ. This is the Schur complement of the saddle-point system (for instance D. Baraff,
//! "Linear-time dynamics using Lagrange multipliers", 1996).

use super::body::Body;
use super::line::Line;
use bevy::math::{DMat3, DVec3};
use nalgebra::{DMatrix, DVector};

/// Share of each diagonal entry that is added to it, because constraints may be redundant. It is not that of the greatest entry: a tiny
/// body among large ones has one that is millions of times greater. Pinned by `a_constraint_that_is_said_twice_counts_once` and
/// `a_needle_on_the_rod_leaves_the_hinge_as_firm_as_it_is`.
const TWICE: f64 = 1e-9;

/// A constraint row: the sum of linear · v + angular · ω over its sides is zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Constraint {
    pub sides: [Option<Side>; 2],
}

/// The part of a constraint row for one body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub body: usize,
    pub linear: DVec3,
    pub angular: DVec3,
}

impl Constraint {
    /// Row that prevents relative motion of two bodies along an axis at the point `at`.
    pub(crate) fn along(axis: DVec3, at: DVec3, bodies: [Option<(usize, &Body)>; 2]) -> Self {
        let side = |(end, sign): (usize, f64)| {
            let (index, body) = bodies[end]?;
            Some(Side {
                body: index,
                linear: sign * axis,
                angular: (at - body.position).cross(sign * axis),
            })
        };
        Self {
            sides: [(0, -1.0), (1, 1.0)].map(side),
        }
    }

    /// Row that prevents relative rotation of two bodies about an axis.
    pub(crate) fn about(axis: DVec3, bodies: [Option<usize>; 2]) -> Self {
        let side = |(end, sign): (usize, f64)| {
            Some(Side {
                body: bodies[end]?,
                linear: DVec3::ZERO,
                angular: sign * axis,
            })
        };
        Self {
            sides: [(0, -1.0), (1, 1.0)].map(side),
        }
    }

    /// Row of an element's line, in the direction that pushes its ends apart.
    pub(crate) fn of_line(line: &Line) -> Self {
        let side = |(end, sign): (usize, f64)| {
            let hold = &line.holds[end];
            let push = sign * line.direction;
            let (linear, angular) = if hold.twist {
                (DVec3::ZERO, push)
            } else {
                (push, hold.arm.cross(push))
            };
            Some(Side {
                body: hold.body?,
                linear,
                angular,
            })
        };
        Self {
            sides: [(0, -1.0), (1, 1.0)].map(side),
        }
    }
}

/// Bodies, and the constraints on them.
#[derive(Debug, Default)]
pub(crate) struct Linkage {
    pub bodies: Vec<Body>,
    pub constraints: Vec<Constraint>,
}

impl Linkage {
    /// Returns the change of velocity along each row of `along` per impulse along `push`, under the constraints, 1/kg. None
    /// if the matrix of the constraints is not positive definite.
    pub(crate) fn response<const N: usize>(
        &self,
        push: &Constraint,
        along: [&Constraint; N],
    ) -> Option<[f64; N]> {
        let inertia: Vec<DMat3> = self.bodies.iter().map(Body::inverse_inertia).collect();
        let coupling = |a: &Constraint, b: &Constraint| -> f64 {
            let mut sum = 0.0;
            for x in a.sides.iter().flatten() {
                for y in b.sides.iter().flatten().filter(|y| y.body == x.body) {
                    sum += (self.bodies[x.body].inverse_mass * x.linear).dot(y.linear);
                    sum += (inertia[x.body] * x.angular).dot(y.angular);
                }
            }
            sum
        };
        let count = self.constraints.len();
        let mut matrix = DMatrix::from_fn(count, count, |i, j| {
            coupling(&self.constraints[i], &self.constraints[j])
        });
        for i in 0..count {
            matrix[(i, i)] += TWICE * matrix[(i, i)] + f64::MIN_POSITIVE;
        }
        let moved =
            |by: &Constraint| DVector::from_fn(count, |i, _| coupling(&self.constraints[i], by));
        let reactions = matrix.cholesky()?.solve(&moved(push));
        Some(along.map(|to| coupling(push, to) - reactions.dot(&moved(to))))
    }

    /// Inverse effective mass that the constraints leave a line between the bodies, 1/kg.
    pub(crate) fn inverse_mass(&self, line: &Line) -> f64 {
        let own = Constraint::of_line(line);
        let free = line.inverse_mass;
        let [left] = self.response(&own, [&own]).unwrap_or([free]);
        // If the constraints prevent all motion along the line, only rounding is left.
        if left > 10.0 * TWICE.sqrt() * free {
            left
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::element::{End, Path};
    use super::super::tests::{element, point, turning};
    use super::*;

    /// A rod of 1 m and 2 kg along x, and the line of a vertical spring at its end.
    fn rod() -> (Linkage, Line) {
        let inertia = DVec3::new(1e-3, 2.0 / 12.0, 2.0 / 12.0);
        let rod = point(2.0, DVec3::X * 0.5, DVec3::ZERO);
        let bodies = vec![turning(rod, inertia, DVec3::ZERO)];
        let hook = End::Path(Path::straight(DVec3::new(1.0, 1.0, 0.0), DVec3::ZERO));
        let arm = DVec3::X * 0.5;
        let element = element(hook, End::Body { index: 0, arm }, 1.0, 0.0, 1.0);
        let line = element.line(&bodies).expect("a line");
        let linkage = Linkage {
            bodies,
            constraints: Vec::new(),
        };
        (linkage, line)
    }

    #[test]
    fn a_free_rod_has_the_mass_of_its_end() {
        let (linkage, line) = rod();
        let left = linkage.inverse_mass(&line);
        assert!((left - line.inverse_mass).abs() < 1e-12);
        assert!((left - 2.0).abs() < 1e-9, "1/m + (l/2)²/I: {left}");
    }

    #[test]
    fn on_a_hinge_it_has_a_third_of_its_mass_at_the_end() {
        let (mut linkage, line) = rod();
        linkage.constraints = hinge(&linkage.bodies[0]);
        let left = linkage.inverse_mass(&line);
        assert!((left - 1.5).abs() < 1e-6, "{left}");
    }

    /// Constraints that hold the middle of the rod's first end at the origin, and let it turn about z only.
    fn hinge(rod: &Body) -> Vec<Constraint> {
        let on = [None, Some((0, rod))];
        let along = DVec3::AXES.map(|axis| Constraint::along(axis, DVec3::ZERO, on));
        let about = [DVec3::X, DVec3::Y].map(|axis| Constraint::about(axis, [None, Some(0)]));
        along.into_iter().chain(about).collect()
    }

    #[test]
    fn a_needle_on_the_rod_leaves_the_hinge_as_firm_as_it_is() {
        let [thick, thin] = [1e-4, 1e-8].map(|inertia| {
            let (mut linkage, line) = rod();
            let rod = linkage.bodies[0];
            linkage.constraints = hinge(&rod);
            let needle = point(1e-3, DVec3::X * 0.5, DVec3::ZERO);
            let needle = turning(needle, DVec3::splat(inertia), DVec3::ZERO);
            linkage.bodies.push(needle);
            let on = [Some((0, &rod)), Some((1, &needle))];
            let along = DVec3::AXES.map(|axis| Constraint::along(axis, DVec3::X * 0.5, on));
            let about = DVec3::AXES.map(|axis| Constraint::about(axis, [Some(0), Some(1)]));
            linkage.constraints.extend(along.into_iter().chain(about));
            linkage.inverse_mass(&line)
        });
        assert!((thin / thick - 1.0).abs() < 1e-3, "{thin} and {thick} 1/kg");
        assert!((thin / 1.5 - 1.0).abs() < 1e-2, "{thin} 1/kg");
    }

    #[test]
    fn a_constraint_that_is_said_twice_counts_once() {
        let (mut linkage, line) = rod();
        let body = linkage.bodies[0];
        for axis in DVec3::AXES.into_iter().chain(DVec3::AXES) {
            let on = [None, Some((0, &body))];
            linkage
                .constraints
                .push(Constraint::along(axis, DVec3::ZERO, on));
        }
        let left = linkage.inverse_mass(&line);
        assert!((left - 1.5).abs() < 1e-6, "{left}");
        let weld = DVec3::AXES.map(|axis| Constraint::about(axis, [None, Some(0)]));
        linkage.constraints.extend(weld);
        assert_eq!(linkage.inverse_mass(&line), 0.0, "a weld leaves nothing");
    }
}
