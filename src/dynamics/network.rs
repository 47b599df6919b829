//! Elements that share bodies: one linearised solve for all of them together.
//!
//! At the drifted positions, with K and C the elements' stiffness and damping along their lines and K
//! also across them where they are in tension,
//!
//! ```text
//! (M + h/2 C + (θ + η) h² K) a = f(q, v) + f_outside + (θ h² k + h/2 c)·a_turning along each line
//! ```
//!
//! θ places the stiffest mode exactly while it is resolved and is 1/4 beyond; η adds damping only to
//! modes that the step can no longer resolve. The matrix is symmetric and positive definite.

use super::body::{Body, Spin};
use super::element::{Element, Line, Motion};
use super::kick;
use bevy::math::DVec3;
use nalgebra::{DMatrix, DVector};

/// (ω h)² of the stiffest mode up to which it is placed exactly.
const PLACED: f64 = 9.0;
/// (ω h)² of the stiffest mode beyond which unresolved modes are damped.
const RESOLVED: f64 = 4.0;
/// How strongly.
const UNRESOLVED_DAMPING: f64 = 0.1;

/// The coupled kick of a component.
pub(crate) struct Network {
    /// First unknown of each body, and how many it has: 3, or 6 where it turns.
    slots: Vec<(usize, usize)>,
    size: usize,
}

/// One element's line, if it acts in this kick.
struct Row {
    line: Line,
    before: Motion,
    /// Tension at the drifted positions, N.
    tension: f64,
    rate: f64,
}

/// Linear and angular parts of one direction at both ends: the row of its Jacobian.
fn jacobian(line: &Line, direction: DVec3) -> [(Option<usize>, DVec3, DVec3); 2] {
    let [a, b] = &line.holds;
    [
        (a.body, -direction, -a.arm.cross(direction)),
        (b.body, direction, b.arm.cross(direction)),
    ]
}

impl Network {
    /// Bound on (ω h)² of the component's stiffest mode: Gershgorin on h² M⁻¹K, block by body.
    pub(crate) fn stiffest(elements: &[Element], bodies: &[Body], step: f64) -> f64 {
        let mut bound = vec![0.0_f64; bodies.len()];
        for element in elements {
            let Some(line) = element.line(bodies) else {
                continue;
            };
            let w = line
                .holds
                .map(|h| h.inverse_mass_along(line.direction).sqrt());
            for (end, hold) in line.holds.iter().enumerate() {
                if let Some(body) = hold.body {
                    bound[body] += element.stiffness * w[end] * (w[0] + w[1]);
                }
            }
        }
        step * step * bound.into_iter().fold(0.0, f64::max)
    }

    fn new(bodies: &[Body]) -> Self {
        let mut size = 0;
        let slots = bodies
            .iter()
            .map(|body| {
                let count = if body.spin == Spin::Still { 3 } else { 6 };
                size += count;
                (size - count, count)
            })
            .collect();
        Self { slots, size }
    }

    /// Adds the outer product of a row with itself, weighted.
    fn add(
        &self,
        matrix: &mut DMatrix<f64>,
        row: &[(Option<usize>, DVec3, DVec3); 2],
        weight: f64,
    ) {
        for (body_i, linear_i, angular_i) in row {
            for (body_j, linear_j, angular_j) in row {
                let (Some(i), Some(j)) = (body_i, body_j) else {
                    continue;
                };
                let ((at_i, count_i), (at_j, count_j)) = (self.slots[*i], self.slots[*j]);
                let entry = |linear: DVec3, angular: DVec3, k: usize| {
                    if k < 3 { linear[k] } else { angular[k - 3] }
                };
                for r in 0..count_i {
                    for c in 0..count_j {
                        matrix[(at_i + r, at_j + c)] += weight
                            * entry(*linear_i, *angular_i, r)
                            * entry(*linear_j, *angular_j, c);
                    }
                }
            }
        }
    }

    /// Adds a generalised force along a row.
    fn load(&self, right: &mut DVector<f64>, row: &[(Option<usize>, DVec3, DVec3); 2], force: f64) {
        for (body, linear, angular) in row {
            let Some(body) = body else { continue };
            let (at, count) = self.slots[*body];
            for k in 0..3 {
                right[at + k] += force * linear[k];
                if count == 6 {
                    right[at + 3 + k] += force * angular[k];
                }
            }
        }
    }

    /// The kick at the half drift: all elements and outside forces together.
    pub(crate) fn kick(elements: &[Element], bodies: &mut [Body], step: f64) {
        let z_max = Self::stiffest(elements, bodies, step);
        let theta = placement(z_max);
        let eta = if z_max > RESOLVED {
            UNRESOLVED_DAMPING
        } else {
            0.0
        };
        let network = Self::new(bodies);
        let h2 = step * step;

        let mut matrix = DMatrix::zeros(network.size, network.size);
        let mut rows = Vec::with_capacity(elements.len());
        for element in elements {
            let Some(line) = element.line(bodies) else {
                continue;
            };
            let before = line.motion(element, bodies, step);
            let rate = line.backward_rate(&before, step);
            let tension =
                element.stiffness * (line.length - element.rest_length) + element.damping * rate;
            let axial = (theta + eta) * h2 * element.stiffness + 0.5 * step * element.damping;
            network.add(&mut matrix, &jacobian(&line, line.direction), axial);
            let across = across(element, &line, tension);
            if across > 0.0 {
                let (t1, t2) = line.direction.any_orthonormal_pair();
                for t in [t1, t2] {
                    network.add(
                        &mut matrix,
                        &jacobian(&line, t),
                        (theta + eta) * h2 * across,
                    );
                }
            }
            rows.push((
                *element,
                Row {
                    line,
                    before,
                    tension,
                    rate,
                },
            ));
        }
        network.add_inertia(&mut matrix, bodies);
        let Some(factor) = matrix.cholesky() else {
            // Cannot happen for finite input; without it the component just flies on.
            return kick::external(bodies, step);
        };

        let solve = |turning: &dyn Fn(usize) -> f64| {
            let drift = h2 / 8.0;
            let mut right = network.outside(bodies);
            for (i, (element, row)) in rows.iter().enumerate() {
                let k = element.stiffness;
                let tension = row.tension
                    + eta * step * k * row.rate
                    + ((theta * h2 - drift) * k + 0.5 * step * element.damping) * turning(i);
                network.load(
                    &mut right,
                    &jacobian(&row.line, row.line.direction),
                    -tension,
                );
                if eta > 0.0 {
                    let force = eta * step * across(element, &row.line, row.tension);
                    for (t, along) in [
                        (DVec3::X, row.before.lateral.x),
                        (DVec3::Y, row.before.lateral.y),
                        (DVec3::Z, row.before.lateral.z),
                    ] {
                        network.load(&mut right, &jacobian(&row.line, t), -force * along);
                    }
                }
            }
            network.clear_locked(&mut right, bodies);
            factor.solve(&right)
        };
        let first = solve(&|i| rows[i].1.before.turning + rows[i].1.before.arms);
        let mut trial = bodies.to_vec();
        network.apply(&mut trial, &first, step);
        // The mean of before and after the kick keeps the step its own mirror image in time.
        let mean: Vec<f64> = rows
            .iter()
            .map(|(element, row)| {
                let after = row.line.motion(element, &trial, step);
                0.5 * (row.before.turning + row.before.arms + after.turning + after.arms)
            })
            .collect();
        let acceleration = solve(&|i| mean[i]);
        network.apply(bodies, &acceleration, step);
    }

    /// Mass and inertia on the diagonal blocks; locked axes become unit rows of their own.
    fn add_inertia(&self, matrix: &mut DMatrix<f64>, bodies: &[Body]) {
        for (body, (at, count)) in bodies.iter().zip(&self.slots) {
            for k in 0..3 {
                let w = body.inverse_mass[k];
                if w > 0.0 {
                    matrix[(at + k, at + k)] += 1.0 / w;
                } else {
                    self.lock(matrix, at + k);
                }
            }
            if *count == 6 {
                let mut inverse = body.inverse_inertia();
                let locked = [0, 1, 2].map(|k| inverse.col(k)[k] == 0.0);
                for k in (0..3).filter(|k| locked[*k]) {
                    inverse.col_mut(k)[k] = 1.0;
                }
                let inertia = inverse.inverse();
                for r in 0..3 {
                    for c in 0..3 {
                        matrix[(at + 3 + r, at + 3 + c)] += inertia.col(c)[r];
                    }
                }
                for k in (0..3).filter(|k| locked[*k]) {
                    self.lock(matrix, at + 3 + k);
                }
            }
        }
    }

    fn lock(&self, matrix: &mut DMatrix<f64>, index: usize) {
        matrix.row_mut(index).fill(0.0);
        matrix.column_mut(index).fill(0.0);
        matrix[(index, index)] = 1.0;
    }

    fn clear_locked(&self, right: &mut DVector<f64>, bodies: &[Body]) {
        for (body, (at, count)) in bodies.iter().zip(&self.slots) {
            for k in (0..3).filter(|k| body.inverse_mass[*k] == 0.0) {
                right[at + k] = 0.0;
            }
            if *count == 6 {
                let inverse = body.inverse_inertia();
                for k in (0..3).filter(|k| inverse.col(*k)[*k] == 0.0) {
                    right[at + 3 + k] = 0.0;
                }
            }
        }
    }

    /// Outside forces and torques.
    fn outside(&self, bodies: &[Body]) -> DVector<f64> {
        let mut right = DVector::zeros(self.size);
        for (body, (at, count)) in bodies.iter().zip(&self.slots) {
            for k in 0..3 {
                if body.inverse_mass[k] > 0.0 {
                    right[at + k] = body.acceleration[k] / body.inverse_mass[k];
                }
                if *count == 6 {
                    right[at + 3 + k] = body.torque[k];
                }
            }
        }
        right
    }

    fn apply(&self, bodies: &mut [Body], acceleration: &DVector<f64>, step: f64) {
        for (body, (at, count)) in bodies.iter_mut().zip(&self.slots) {
            let part = |at: usize| {
                DVec3::new(acceleration[at], acceleration[at + 1], acceleration[at + 2])
            };
            body.velocity += step * part(*at);
            if *count == 6 {
                let velocity = body.angular_velocity() + step * part(at + 3);
                body.set_angular_velocity(velocity);
            }
        }
    }
}

/// Stiffness across the line: a spring in tension pulls a displaced end back.
fn across(element: &Element, line: &Line, tension: f64) -> f64 {
    if line.isotropic {
        element.stiffness
    } else if tension > 0.0 && line.length > 0.0 {
        tension / line.length
    } else {
        0.0
    }
}

/// θ for a stiffest mode with z = (ω h)².
fn placement(z: f64) -> f64 {
    if z <= 1e-3 {
        1.0 / 12.0
    } else if z < PLACED {
        ((z / (2.0 * (1.0 - z.sqrt().cos())) - 1.0) / z).max(1.0 / 12.0)
    } else {
        0.25
    }
}
