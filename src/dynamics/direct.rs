//! Solves a small system directly: see [`super::envelope`].

use super::body::{Body, Spin};
use super::envelope::Envelope;
use super::strut::{NOBODY, Strut, Twists, cross};
use bevy::math::{DMat3, DVec3};

/// The matrix of a system, and its unknowns: the velocity of each body, and where a body turns, its angular velocity.
#[derive(Clone, Default)]
pub(super) struct Direct {
    places: Vec<Place>,
    unknowns: usize,
    matrix: Envelope,
    vector: Vec<f64>,
}

/// Where a body's unknowns stand in the matrix.
#[derive(Clone, Copy)]
struct Place {
    /// Index of the first one.
    at: usize,
    /// Whether its rotation is among them.
    turns: bool,
    /// Column of the first entry in its rows.
    first: usize,
}

impl Direct {
    /// Numbers the unknowns from the last body to the first. What is spawned first is often what all else hangs on, such as
    /// the body of a car; where it comes last, each wheel has entries only for itself and for it.
    pub(super) fn number(&mut self, bodies: &[Body]) {
        self.unknowns = 0;
        self.places.clear();
        for body in bodies.iter().rev() {
            let (at, turns) = (self.unknowns, body.spin != Spin::Ignored);
            // Its rows begin with itself, until a strut leads farther: see `shape`.
            self.places.push(Place {
                at,
                turns,
                first: at,
            });
            self.unknowns += if turns { 6 } else { 3 };
        }
        self.places.reverse();
    }

    pub(super) fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Prepares the solve. Returns whether the matrix is positive definite, as far as f64 can tell.
    pub(super) fn factorise(
        &mut self,
        struts: &[Strut],
        mass: &[DMat3],
        inertia: &[DMat3],
        free: &Twists,
    ) -> bool {
        self.shape(struts);
        let Self { matrix, places, .. } = self;
        for (i, Place { at, turns, .. }) in places.iter().enumerate() {
            add(matrix, *at, *at, mass[i]);
            if *turns {
                add(matrix, at + 3, at + 3, inertia[i]);
            }
        }
        for strut in struts {
            let own = strut.matrix();
            for (i, row) in strut.bodies.into_iter().enumerate() {
                for (j, column) in strut.bodies.into_iter().enumerate() {
                    if row == NOBODY || column == NOBODY || places[column].at > places[row].at {
                        continue;
                    }
                    let own = if i == j { own } else { own * -1.0 };
                    let (r, c) = (places[row], places[column]);
                    if strut.twist {
                        if r.turns && c.turns {
                            add(matrix, r.at + 3, c.at + 3, own);
                        }
                        continue;
                    }
                    add(matrix, r.at, c.at, own);
                    let (a, b) = (cross(strut.arms[i]), cross(strut.arms[j]));
                    if c.turns {
                        add(matrix, r.at, c.at + 3, own * -b);
                    }
                    if r.turns {
                        add(matrix, r.at + 3, c.at, a * own);
                    }
                    if r.turns && c.turns {
                        add(matrix, r.at + 3, c.at + 3, a * own * -b);
                    }
                }
            }
        }
        for (i, Place { at, turns, .. }) in places.iter().enumerate() {
            for k in 0..3 {
                if free.linear[i][k] == 0.0 {
                    matrix.lock(at + k);
                }
                if *turns && free.angular[i][k] == 0.0 {
                    matrix.lock(at + 3 + k);
                }
            }
        }
        matrix.factorise()
    }

    /// Gives the matrix its rows: those of a body begin at the first body that one of its struts leads to.
    fn shape(&mut self, struts: &[Strut]) {
        for Strut { bodies: [a, b], .. } in struts {
            if *a != NOBODY && *b != NOBODY {
                let first = self.places[*a].at.min(self.places[*b].at);
                for end in [*a, *b] {
                    self.places[end].first = self.places[end].first.min(first);
                }
            }
        }
        self.matrix.clear();
        for place in self.places.iter().rev() {
            for _ in 0..if place.turns { 6 } else { 3 } {
                self.matrix.push(place.first);
            }
        }
    }

    /// Solves for `right`.
    pub(super) fn solve(&mut self, right: &Twists, x: &mut Twists) {
        self.vector.resize(self.unknowns, 0.0);
        scatter(right, &self.places, &mut self.vector);
        self.matrix.solve(&mut self.vector);
        gather(&self.vector, &self.places, x);
    }
}

/// Adds a block to a matrix.
fn add(matrix: &mut Envelope, row: usize, column: usize, block: DMat3) {
    for c in 0..3 {
        for r in 0..3 {
            matrix.add(row + r, column + c, block.col(c)[r]);
        }
    }
}

fn scatter(from: &Twists, places: &[Place], to: &mut [f64]) {
    for (i, Place { at, turns, .. }) in places.iter().enumerate() {
        for k in 0..3 {
            to[at + k] = from.linear[i][k];
            if *turns {
                to[at + 3 + k] = from.angular[i][k];
            }
        }
    }
}

fn gather(from: &[f64], places: &[Place], to: &mut Twists) {
    for (i, Place { at, turns, .. }) in places.iter().enumerate() {
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
