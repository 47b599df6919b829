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
pub(crate) const RESOLVED: f64 = 4.0;
/// How strongly.
const UNRESOLVED_DAMPING: f64 = 0.1;

/// The coupled kick of a component: where each body's unknown accelerations stand.
pub(crate) struct Network {
    /// First unknown of each body, and how many it has: 3, or 6 where it turns.
    slots: Vec<(usize, usize)>,
    size: usize,
}

/// One direction in which an element pulls its ends together: along its line, or across it.
struct Strut {
    /// Index of the line it belongs to.
    line: usize,
    direction: DVec3,
    /// Row of the Jacobian: linear and angular part at each end's body.
    row: [(Option<usize>, DVec3, DVec3); 2],
    /// Force before the solve, N.
    load: f64,
    /// What the turning of the line adds to it, N per m/s².
    turning: f64,
    /// What the relative acceleration adds to it, N per m/s².
    weight: f64,
}

/// How implicit the kick is.
#[derive(Clone, Copy)]
struct Blend {
    theta: f64,
    eta: f64,
    step: f64,
}

impl Blend {
    fn new(z_max: f64, step: f64) -> Self {
        Self {
            theta: placement(z_max),
            eta: if z_max > RESOLVED {
                UNRESOLVED_DAMPING
            } else {
                0.0
            },
            step,
        }
    }

    /// The struts of one element on its line.
    fn struts(&self, element: &Element, line: &Line, before: &Motion, index: usize) -> Vec<Strut> {
        let (h, h2) = (self.step, self.step * self.step);
        let (k, c) = (element.stiffness, element.damping);
        let rate = line.backward_rate(before, h);
        let tension = k * (line.length - element.rest_length) + c * rate;
        let implicit = (self.theta + self.eta) * h2;
        let damping = damper_placement(c * h * line.inverse_mass);
        let mut struts = vec![Strut {
            line: index,
            direction: line.direction,
            row: jacobian(line, line.direction),
            load: tension + self.eta * h * k * rate,
            // The half drift counted h²/8 of the turning as stretch already.
            turning: (self.theta * h2 - h2 / 8.0) * k + damping * h * c,
            weight: implicit * k + damping * h * c,
        }];
        let across = across(element, line, tension);
        if across > 0.0 {
            let (t1, t2) = line.direction.any_orthonormal_pair();
            struts.extend([t1, t2].map(|t| Strut {
                line: index,
                direction: t,
                row: jacobian(line, t),
                load: self.eta * h * across * before.lateral.dot(t),
                turning: 0.0,
                weight: implicit * across,
            }));
        }
        struts
    }
}

/// Linear and angular parts of one direction at both ends.
fn jacobian(line: &Line, direction: DVec3) -> [(Option<usize>, DVec3, DVec3); 2] {
    let [a, b] = &line.holds;
    [
        (a.body, -direction, -a.arm.cross(direction)),
        (b.body, direction, b.arm.cross(direction)),
    ]
}

impl Network {
    /// Bound on (ω h)² of the component's stiffest mode.
    pub(crate) fn stiffest(elements: &[Element], bodies: &[Body], step: f64) -> f64 {
        step * step * bound(elements, bodies, |element| element.stiffness)
    }

    /// Bound on 2γh of its most damped mode.
    pub(crate) fn most_damped(elements: &[Element], bodies: &[Body], step: f64) -> f64 {
        step * bound(elements, bodies, |element| element.damping)
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

    /// The kick at the half drift: all elements and outside forces together.
    pub(crate) fn kick(elements: &[Element], bodies: &mut [Body], step: f64) {
        let blend = Blend::new(Self::stiffest(elements, bodies, step), step);
        let network = Self::new(bodies);
        let lines: Vec<(&Element, Line, Motion)> = elements
            .iter()
            .filter_map(|element| {
                let line = element.line(bodies)?;
                Some((element, line, line.motion(element, bodies, step)))
            })
            .collect();
        let struts: Vec<Strut> = lines
            .iter()
            .enumerate()
            .flat_map(|(i, (element, line, before))| blend.struts(element, line, before, i))
            .collect();

        let mut matrix = DMatrix::zeros(network.size, network.size);
        for strut in &struts {
            network.add(&mut matrix, strut);
        }
        network.add_inertia(&mut matrix, bodies);
        let Some(factor) = matrix.cholesky() else {
            // Cannot happen for finite input; without it the component just flies on.
            return kick::external(bodies, step);
        };

        let solve = |turning: &[f64]| {
            let mut right = network.outside(bodies);
            for strut in &struts {
                network.load(&mut right, strut, turning[strut.line]);
            }
            network.clear_locked(&mut right, bodies);
            factor.solve(&right)
        };
        let act = |bodies: &mut [Body], acceleration: &DVector<f64>, turning: &[f64]| {
            for strut in &struts {
                let force = strut.load
                    + strut.turning * turning[strut.line]
                    + strut.weight * network.along(acceleration, strut);
                let pull = -step * force * strut.direction;
                lines[strut.line].1.impulse(bodies, pull);
            }
            kick::external(bodies, step);
        };
        let first: Vec<f64> = lines.iter().map(|(.., m)| m.turning + m.arms).collect();
        let mut trial = bodies.to_vec();
        act(&mut trial, &solve(&first), &first);
        // The mean of before and after the kick keeps the step its own mirror image in time.
        let mean: Vec<f64> = lines
            .iter()
            .zip(&first)
            .map(|((element, line, _), before)| {
                let after = line.motion(element, &trial, step);
                0.5 * (before + after.turning + after.arms)
            })
            .collect();
        act(bodies, &solve(&mean), &mean);
    }

    /// Linear and angular unknowns of a body; none of the latter where it does not turn.
    fn parts(&self, body: usize) -> impl Iterator<Item = (usize, usize)> {
        let (at, count) = self.slots[body];
        (0..count).map(move |k| (k, at + k))
    }

    /// Adds the outer product of a strut's row with itself.
    fn add(&self, matrix: &mut DMatrix<f64>, strut: &Strut) {
        for (body_i, linear_i, angular_i) in &strut.row {
            for (body_j, linear_j, angular_j) in &strut.row {
                let (Some(i), Some(j)) = (body_i, body_j) else {
                    continue;
                };
                for (k, r) in self.parts(*i) {
                    for (l, c) in self.parts(*j) {
                        matrix[(r, c)] += strut.weight
                            * entry(*linear_i, *angular_i, k)
                            * entry(*linear_j, *angular_j, l);
                    }
                }
            }
        }
    }

    /// Subtracts a strut's force before the solve from the right side.
    fn load(&self, right: &mut DVector<f64>, strut: &Strut, turning: f64) {
        let force = strut.load + strut.turning * turning;
        for (body, linear, angular) in &strut.row {
            let Some(body) = body else { continue };
            for (k, r) in self.parts(*body) {
                right[r] -= force * entry(*linear, *angular, k);
            }
        }
    }

    /// Relative acceleration of a strut's ends along it.
    fn along(&self, acceleration: &DVector<f64>, strut: &Strut) -> f64 {
        let mut sum = 0.0;
        for (body, linear, angular) in &strut.row {
            let Some(body) = body else { continue };
            for (k, r) in self.parts(*body) {
                sum += acceleration[r] * entry(*linear, *angular, k);
            }
        }
        sum
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
}

/// Gershgorin bound on M⁻¹K or M⁻¹C, block by body.
fn bound(elements: &[Element], bodies: &[Body], constant: impl Fn(&Element) -> f64) -> f64 {
    let mut sums = vec![0.0_f64; bodies.len()];
    for element in elements {
        let Some(line) = element.line(bodies) else {
            continue;
        };
        let w = line
            .holds
            .map(|h| h.inverse_mass_along(line.direction).sqrt());
        for (end, hold) in line.holds.iter().enumerate() {
            if let Some(body) = hold.body {
                sums[body] += constant(element) * w[end] * (w[0] + w[1]);
            }
        }
    }
    sums.into_iter().fold(0.0, f64::max)
}

/// Component k of six.
fn entry(linear: DVec3, angular: DVec3, k: usize) -> f64 {
    if k < 3 { linear[k] } else { angular[k - 3] }
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

/// Share of the step at whose end a damper with x = c h/m acts: half, which is of second order, while it
/// is resolved; beyond that the share with which a lone damper decays exactly, so that strong ones stop
/// their ends instead of throwing them back and forth.
fn damper_placement(x: f64) -> f64 {
    if x <= 1.0 {
        0.5
    } else {
        -1.0 / (-x).exp_m1() - 1.0 / x
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
