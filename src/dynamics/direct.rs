//! Solves a small system, or one that is long and narrow, directly: see [`super::envelope`].

use super::envelope::Envelope;
use super::strut::{Strut, crossed};
use bevy::math::{DMat3, DVec3};

/// Number of unknown vectors up to which a factorisation is cheaper than iterations, whatever the network looks like. Pinned by
/// `direct::tests::sixteen_bodies_that_are_all_joined_are_factorised_and_twenty_are_not`.
const SMALL: usize = 32;

/// Width of the matrix up to which a factorisation is cheaper than iterations for any number of unknowns: the number of blocks
/// that are kept in a row, as a root mean square. For each unknown vector, a factorisation costs the square of it. Pinned by
/// `direct::tests`.
const NARROW: usize = 13;

/// The matrix of a system, and its unknown vectors: the velocity of each body, and where a body turns, its angular velocity.
#[derive(Clone, Default)]
pub(super) struct Direct {
    places: Vec<Place>,
    /// Number of unknown vectors.
    unknowns: usize,
    /// Sum of the squares of the widths of all rows.
    squares: usize,
    matrix: Envelope,
    vector: Vec<DVec3>,
}

/// Where a body's unknown vectors stand in the matrix.
#[derive(Clone, Copy)]
struct Place {
    /// Index of the first one.
    at: usize,
    /// Whether its rotation is among them.
    turns: bool,
    /// Column of the first block in its rows.
    first: usize,
    /// For each of its unknown vectors, 1 on each axis that is free, and 0 on a locked one.
    free: [DVec3; 2],
}

impl Place {
    fn unknowns(&self) -> usize {
        if self.turns { 2 } else { 1 }
    }
}

/// What a body adds to the matrix by itself.
#[derive(Clone, Copy)]
pub(super) struct Own {
    pub mass: DMat3,
    pub inertia: DMat3,
    /// 1 on each axis along which the body can move, and 0 on a locked one.
    pub free: DVec3,
    /// 1 on each axis about which the body can turn, and 0 on a locked one.
    pub free_to_turn: DVec3,
}

impl Direct {
    /// Numbers the unknowns of a new set of bodies. `turns` says of each body whether it turns. The numbers go from the last body
    /// to the first. Neighbours in the network then have near numbers, which makes the matrix narrow. The body to which all others
    /// are attached, such as that of a car, is often the first body, so its unknowns come last. Each wheel then has entries only
    /// for itself and for the body of the car.
    pub(super) fn number(&mut self, turns: impl DoubleEndedIterator<Item = bool>) {
        self.unknowns = 0;
        self.places.clear();
        for turns in turns.rev() {
            let at = self.unknowns;
            let first = at;
            let place = Place {
                at,
                turns,
                first,
                free: [DVec3::ONE; 2],
            };
            self.unknowns += place.unknowns();
            self.places.push(place);
        }
        self.places.reverse();
    }

    /// Notes the pairs of bodies that elements join. Other indices than those of the bodies are ignored.
    pub(super) fn join(&mut self, pairs: impl Iterator<Item = [usize; 2]>) {
        for place in &mut self.places {
            place.first = place.at;
        }
        for [a, b] in pairs {
            if let (Some(from), Some(to)) = (self.places.get(a), self.places.get(b)) {
                // The rows of a body begin at the first body that an element leads to.
                let first = from.at.min(to.at);
                for end in [a, b] {
                    self.places[end].first = self.places[end].first.min(first);
                }
            }
        }
        let squares = self.places.iter().map(|place| {
            let width = place.at + place.unknowns() - place.first;
            place.unknowns() * width * width
        });
        self.squares = squares.sum();
    }

    /// Whether a factorisation is cheaper than iterations, unless a few of these would do.
    pub(super) fn is_cheaper(&self) -> bool {
        self.unknowns <= SMALL || self.squares <= self.unknowns * NARROW * NARROW
    }

    /// Prepares the solve, after [`Self::join`]. Returns whether the matrix is positive definite, as far as f64 can tell.
    pub(super) fn factorise(
        &mut self,
        bodies: impl Fn(usize) -> Own,
        struts: impl Iterator<Item = Strut>,
    ) -> bool {
        self.matrix.clear();
        for place in self.places.iter().rev() {
            for _ in 0..place.unknowns() {
                self.matrix.push(place.first);
            }
        }
        let matrix = &mut self.matrix;
        for (body, place) in self.places.iter_mut().enumerate() {
            let own = bodies(body);
            place.free = [own.free, own.free_to_turn];
            place.add_own(matrix, 0, own.mass);
            if place.turns {
                place.add_own(matrix, 1, own.inertia);
            }
        }
        for strut in struts {
            let ends = strut.bodies.map(|body| self.places.get(body));
            add_strut(matrix, &strut, ends);
        }
        self.matrix.factorise()
    }

    /// Solves for the right side `linear`, and `angular` where bodies turn. Both become the solution.
    pub(super) fn solve(&mut self, linear: &mut [DVec3], angular: &mut [DVec3]) {
        self.vector.resize(self.unknowns, DVec3::ZERO);
        for (body, Place { at, turns, .. }) in self.places.iter().enumerate() {
            self.vector[*at] = linear[body];
            if *turns {
                self.vector[at + 1] = angular[body];
            }
        }
        self.matrix.solve(&mut self.vector);
        for (body, Place { at, turns, .. }) in self.places.iter().enumerate() {
            linear[body] = self.vector[*at];
            if let Some(angular) = angular.get_mut(body) {
                // The body may have turned in an earlier step.
                *angular = if *turns {
                    self.vector[at + 1]
                } else {
                    DVec3::ZERO
                };
            }
        }
    }
}

impl Place {
    /// Adds a block to the rows of one of its unknown vectors and the columns of one of another place, apart from what is
    /// locked.
    #[inline]
    fn add(&self, matrix: &mut Envelope, [row, column]: [usize; 2], other: &Self, block: DMat3) {
        let (down, across) = (self.free[row], other.free[column]);
        let block = if down == DVec3::ONE && across == DVec3::ONE {
            block
        } else {
            DMat3::from_cols(
                block.x_axis * down * across.x,
                block.y_axis * down * across.y,
                block.z_axis * down * across.z,
            )
        };
        matrix.add(self.at + row, other.at + column, block);
    }

    /// Adds what a body has by itself. What is locked has no part in the motion of anything else.
    fn add_own(&self, matrix: &mut Envelope, which: usize, own: DMat3) {
        self.add(matrix, [which; 2], self, own);
        let locked = DMat3::from_diagonal(DVec3::ONE - self.free[which]);
        matrix.add(self.at + which, self.at + which, locked);
    }
}

/// Adds what a strut couples: each end with itself and with the other one. `None` for an end that is no body of the system.
fn add_strut(matrix: &mut Envelope, strut: &Strut, ends: [Option<&Place>; 2]) {
    let own = strut.matrix();
    // Force by the rotation of the body at each end that has an arm.
    let swung: [Option<DMat3>; 2] = std::array::from_fn(|i| {
        let swings = !strut.twist && strut.arms[i] != DVec3::ZERO;
        let swings = swings && ends[i].is_some_and(|place| place.turns);
        swings.then(|| crossed(strut.arms[i], &own).transpose())
    });
    for (i, row) in ends.into_iter().enumerate() {
        for (j, column) in ends.into_iter().enumerate() {
            let (Some(row), Some(column)) = (row, column) else {
                continue;
            };
            if column.at > row.at {
                continue;
            }
            let sign = if i == j { 1.0 } else { -1.0 };
            if strut.twist {
                if row.turns && column.turns {
                    row.add(matrix, [1, 1], column, own * sign);
                }
                continue;
            }
            row.add(matrix, [0, 0], column, own * sign);
            if let Some(swung) = swung[j].filter(|_| i != j) {
                row.add(matrix, [0, 1], column, swung * sign);
            }
            if let Some(swung) = swung[i] {
                // Torque by the motion of the other end: the same coupling, transposed.
                row.add(matrix, [1, 0], column, swung.transpose() * sign);
            }
            if let (Some(_), Some(swung)) = (swung[i], swung[j]) {
                let block = crossed(strut.arms[i], &swung) * sign;
                row.add(matrix, [1, 1], column, block);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::strut::Twists;
    use super::*;

    fn strut(bodies: [usize; 2]) -> Strut {
        Strut {
            bodies,
            arms: [DVec3::ZERO; 2],
            direction: DVec3::new(0.6, 0.8, 0.0),
            along: 5.0,
            across: 2.0,
            twist: false,
        }
    }

    fn own(free: DVec3) -> Own {
        Own {
            mass: DMat3::IDENTITY * 3.0,
            inertia: DMat3::IDENTITY,
            free,
            free_to_turn: DVec3::ONE,
        }
    }

    #[test]
    fn what_is_locked_neither_moves_nor_moves_anything_else() {
        let mut direct = Direct::default();
        direct.number([false, false].into_iter());
        direct.join([[0, 1]].into_iter());
        let frees = [DVec3::new(1.0, 0.0, 1.0), DVec3::ONE];
        assert!(direct.factorise(|body| own(frees[body]), [strut([0, 1])].into_iter()));
        let (right, mut x) = (DVec3::new(1.0, 0.0, 3.0), [DVec3::ZERO; 2]);
        x[0] = right;
        direct.solve(&mut x, &mut []);
        assert_eq!(x[0].y, 0.0);
        // The equations hold on all axes that are free.
        let pull = strut([0, 1]).matrix() * (x[1] - x[0]);
        let left = [3.0 * x[0] - pull, 3.0 * x[1] + pull];
        assert!(((left[0] - right) * frees[0]).length() < 1e-14, "{left:?}");
        assert!(left[1].length() < 1e-14, "{left:?}");
    }

    #[test]
    fn bodies_that_turn_are_pulled_by_their_arms_as_the_equations_say() {
        let mut direct = Direct::default();
        direct.number([true, false, true].into_iter());
        let mut struts = [[0, 1], [2, 0], [0, 2]].map(strut);
        struts[0].arms = [DVec3::new(0.3, -0.2, 0.5), DVec3::ZERO];
        struts[1].arms = [DVec3::new(-0.4, 0.1, 0.2), DVec3::new(0.7, 0.2, -0.1)];
        struts[2].twist = true;
        direct.join(struts.iter().map(|strut| strut.bodies));
        assert!(direct.factorise(|_| own(DVec3::ONE), struts.iter().copied()));
        let given = |at: usize| DVec3::new(at as f64 - 1.5, 2.0, 0.7 * at as f64);
        let mut x = Twists {
            linear: (0..3).map(given).collect(),
            angular: (3..6).map(given).collect(),
        };
        // Nothing turns the body in the middle.
        x.angular[1] = DVec3::ZERO;
        let right = x.clone();
        direct.solve(&mut x.linear, &mut x.angular);
        let mut left = x.clone();
        left.linear.iter_mut().for_each(|v| *v *= 3.0);
        for strut in &struts {
            strut.add(&mut left, strut.force(strut.relative(&x)));
        }
        left.combine(1.0, &right, -1.0);
        assert!(left.dot(&left).sqrt() < 1e-13, "{left:?}");
    }

    /// Whether so many bodies are factorised that are joined in pairs.
    fn is_factorised(count: usize, turns: bool, pairs: impl Iterator<Item = [usize; 2]>) -> bool {
        let mut direct = Direct::default();
        direct.number((0..count).map(|_| turns));
        direct.join(pairs);
        direct.is_cheaper()
    }

    fn is_net_factorised(rows: usize, columns: usize, turns: bool) -> bool {
        let count = rows * columns;
        let beside = |at: usize| (at % columns + 1 < columns).then_some([at, at + 1]);
        let below = |at: usize| (at / columns + 1 < rows).then_some([at, at + columns]);
        let pairs = (0..count).flat_map(|at| beside(at).into_iter().chain(below(at)));
        is_factorised(count, turns, pairs)
    }

    #[test]
    fn a_rope_a_bridge_or_a_tower_is_factorised_at_any_length_and_a_cloth_is_not() {
        assert!(is_net_factorised(1000, 1, true));
        assert!(is_net_factorised(1000, 3, true));
        assert!(is_net_factorised(1000, 8, false));
        assert!(!is_net_factorised(100, 30, false));
        assert!(!is_net_factorised(30, 30, true));
    }

    #[test]
    fn sixteen_bodies_that_are_all_joined_are_factorised_and_twenty_are_not() {
        let all = |count: usize| (0..count).flat_map(|b| (0..b).map(move |a| [a, b]));
        assert!(is_factorised(16, true, all(16)));
        assert!(!is_factorised(20, true, all(20)));
    }
}
