//! The place of rest of a network: the minimum of its potential energy.

use super::nets::Net;
use crate::harness::GRAVITY;
use bevy::math::DVec3;
use nalgebra::{DMatrix, DVector};

/// Potential energy of springs and weight, and the indices that a minimiser needs.
pub struct Statics<'a> {
    net: &'a Net,
    k: f64,
    /// Index of each point's first coordinate among the unknowns. `None` for a fixed point.
    slots: Vec<Option<usize>>,
    unknowns: usize,
}

impl<'a> Statics<'a> {
    pub fn new(net: &'a Net, k: f64) -> Self {
        let mut unknowns = 0;
        let slots = net
            .points
            .iter()
            .map(|(_, mass)| {
                mass.map(|_| {
                    unknowns += 3;
                    unknowns - 3
                })
            })
            .collect();
        Self {
            net,
            k,
            slots,
            unknowns,
        }
    }

    pub fn energy(&self, at: &[DVec3]) -> f64 {
        let mut sum = 0.0;
        for ((_, mass), at) in self.net.points.iter().zip(at) {
            sum += f64::from(mass.unwrap_or(0.0)) * GRAVITY * at.y;
        }
        for (a, b, rest) in &self.net.links {
            let stretch = at[*a].distance(at[*b]) - f64::from(*rest);
            sum += 0.5 * self.k * stretch * stretch;
        }
        sum
    }

    /// Newton's method from `at`. A multiple of the identity in the Hessian keeps it descending.
    pub fn settle(&self, mut at: Vec<DVec3>) -> Vec<DVec3> {
        let mut shift = 1e-3 * self.k;
        for _ in 0..400 {
            let mut gradient = DVector::zeros(self.unknowns);
            let mut hessian = DMatrix::identity(self.unknowns, self.unknowns) * shift;
            for (slot, (_, mass)) in self.slots.iter().zip(&self.net.points) {
                if let (Some(slot), Some(mass)) = (slot, mass) {
                    gradient[slot + 1] += f64::from(*mass) * GRAVITY;
                }
            }
            for (a, b, rest) in &self.net.links {
                let d = at[*b] - at[*a];
                let (length, u) = (d.length(), d.normalize());
                let tension = self.k * (length - f64::from(*rest));
                let lateral = tension / length;
                for (end, sign) in [(*a, -1.0), (*b, 1.0)] {
                    let Some(row) = self.slots[end] else { continue };
                    for r in 0..3 {
                        gradient[row + r] += sign * tension * u[r];
                        for (other, other_sign) in [(*a, -1.0), (*b, 1.0)] {
                            let Some(column) = self.slots[other] else {
                                continue;
                            };
                            for c in 0..3 {
                                let own = if r == c { lateral } else { 0.0 };
                                hessian[(row + r, column + c)] +=
                                    sign * other_sign * ((self.k - lateral) * u[r] * u[c] + own);
                            }
                        }
                    }
                }
            }
            let Some(factor) = hessian.cholesky() else {
                shift *= 10.0;
                continue;
            };
            let step = factor.solve(&gradient);
            let tried: Vec<DVec3> = at
                .iter()
                .zip(&self.slots)
                .map(|(at, slot)| {
                    slot.map_or(*at, |s| *at - DVec3::new(step[s], step[s + 1], step[s + 2]))
                })
                .collect();
            if self.energy(&tried) <= self.energy(&at) {
                at = tried;
                shift = (shift * 0.3).max(1e-12 * self.k);
                if step.amax() < 1e-13 {
                    break;
                }
            } else {
                shift = (shift * 10.0).max(1e-9 * self.k);
            }
        }
        at
    }
}
