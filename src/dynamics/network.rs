//! The kick of elements that share bodies: one linearised solve for all of them together.
//!
//! At the drifted positions, C is the elements' damping along their lines. K is their stiffness along the lines, and across
//! them for isotropic elements and those in tension. The accelerations a solve
//!
//! ```text
//! (M + h/2 C + θ h² K) a = f(q, v) + f_outside + (θ h² k + h/2 c)·a_turning along each line
//! ```
//!
//! While the stiffest mode is resolved, θ makes its frequency exact. Beyond, θ is 1/4 and the step is the implicit midpoint
//! rule, which conserves the energy of any linear motion at any stiffness. Modes that the step cannot resolve are damped a
//! little, as those of a lone element are.

use super::body::{Body, Spin};
use super::conjugate::{FIRST, LAST, Until};
use super::element::{Element, End};
use super::flight::Flight;
use super::kick;
use super::line::{Line, Motion};
use super::strut::{NOBODY, Strut, Twists};
use super::system::System;
use super::thresholds::STRONG;
use bevy::math::DVec3;
use std::mem::take;

mod bounds;
mod kinked;
mod placement;
mod slipping;
#[cfg(test)]
mod tests;

pub(super) use bounds::shares;
pub(super) use placement::{REVERSES, damper_placement, placement, settling, steep, together};

/// (ω h)² of the stiffest mode up to which θ makes its frequency exact. Pinned by
/// `networks::every_normal_mode_of_a_chain_has_its_frequency`.
const PLACED: f64 = 9.0;

/// The coupled kick of a component, and its memory, which is kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Network {
    rows: Vec<Row>,
    system: System,
    right: Twists,
    /// The last solution, from which the next iterations start.
    acceleration: Twists,
    /// Motion of each body, which its elements share.
    flights: Vec<Flight>,
    /// Memory of [`Self::settle`].
    moved: Vec<Body>,
    /// For each body, the stiffness of its elements over its mass, 1/s²: the Gershgorin bound on ω².
    stiffness: Vec<f64>,
    /// For each body, the damping of its elements over its mass, 1/s: the bound on 2γ.
    damping: Vec<f64>,
    /// Whether a solve since the last [`Network::take_effort`] has not converged.
    unconverged: bool,
}

/// One element within a kick.
#[derive(Clone, Copy)]
struct Row {
    element: usize,
    line: Line,
    before: Motion,
    /// Force on its ends before the solve, without the centripetal part, world frame, N.
    load: DVec3,
    /// Force along the line per centripetal acceleration, N per m/s².
    centripetal_gain: f64,
    /// Centripetal acceleration of the line and of the arms, m/s².
    centripetal: f64,
    /// Force of the spring in `load`, N.
    elastic: f64,
    /// Damping force before the solve, N.
    drag: f64,
    /// Damping force per relative acceleration along the line, N per m/s².
    damping: f64,
    /// Its damping as it counts in [`Network::damping`], N s/m.
    braking: f64,
    /// Share of the damping that is the element's. The rest settles what the step cannot resolve, and is no heat.
    heating: f64,
}

impl Network {
    /// Fills the rows with the elements' lines and their motion.
    fn measure(&mut self, elements: &[Element], bodies: &[Body], step: f64) {
        self.flights.clear();
        self.flights.extend(bodies.iter().map(Body::flight));
        let flights = &self.flights;
        self.rows.clear();
        for (index, element) in elements.iter().enumerate() {
            let Some(line) = element.line(bodies) else {
                continue;
            };
            self.rows.push(Row {
                element: index,
                before: line.motion_of(element, |body| flights[body], step),
                line,
                load: DVec3::ZERO,
                centripetal_gain: 0.0,
                centripetal: 0.0,
                elastic: 0.0,
                drag: 0.0,
                damping: 0.0,
                braking: 0.0,
                heating: 0.0,
            });
        }
    }

    /// Applies the kick after the first half drift: all elements and external forces together. `kinks` says whether the kick
    /// must conserve the energy of laws with kinks.
    pub(crate) fn kick(
        &mut self,
        elements: &mut [Element],
        bodies: &mut [Body],
        step: f64,
        budget: u32,
        kinks: bool,
    ) {
        self.measure(elements, bodies, step);
        let (z_max, _) = self.bounds_of_rows(elements, bodies.len(), step);
        self.system.begin(bodies);
        self.add_struts(elements, bodies, step, placement(z_max));
        self.system.prepare();

        for row in &mut self.rows {
            row.centripetal = row.before.turning + row.before.arms;
        }
        self.solve(bodies, FIRST, budget);
        if self.hold_slipping(elements, step) {
            self.system.prepare();
            self.solve(bodies, FIRST, budget);
        }
        self.gain_speed(bodies, step);
        let flights = &self.flights;
        for row in &mut self.rows {
            // The mean of before and after the kick makes the step time-symmetric.
            let element = &elements[row.element];
            let after = row.line.motion_of(element, |body| flights[body], step);
            row.centripetal = 0.5 * (row.centripetal + after.turning + after.arms);
        }
        self.solve(bodies, LAST, budget);
        if kinks {
            self.keep_energy(elements, bodies, step, budget);
        }
        self.act(bodies, step);
        self.account(elements, step);
    }

    /// Adds to the motion of the bodies what they gain in a step by the present solution.
    fn gain_speed(&mut self, bodies: &[Body], step: f64) {
        let Twists { linear, angular } = &self.acceleration;
        for (i, (flight, body)) in self.flights.iter_mut().zip(bodies).enumerate() {
            let angular = angular.get(i).copied().unwrap_or(DVec3::ZERO);
            *flight = body.flight_after(flight, [step * linear[i], step * angular]);
        }
    }

    /// Adds up the heat of dampers, and the work of ends with prescribed motion.
    fn account(&self, elements: &mut [Element], step: f64) {
        for (row, strut) in self.rows.iter().zip(&self.system.struts) {
            let element = &mut elements[row.element];
            let gained = strut.relative(&self.acceleration).dot(row.line.direction);
            let rate = row.before.axial + 0.5 * step * gained;
            let heat = row.heating * (row.drag + row.damping * gained) * rate * step;
            element.heat += heat.max(0.0);
            for (i, (end, sign)) in element.ends.iter().zip([-1.0, 1.0]).enumerate() {
                if let End::Path(path) = end {
                    let hold = &row.line.holds[i];
                    let velocity = if hold.twist {
                        path.turning
                    } else {
                        end.motion(hold, &[]).0
                    };
                    let force = row.force() + strut.force(strut.relative(&self.acceleration));
                    element.work += sign * step * force.dot(velocity);
                }
            }
        }
    }

    /// Returns the bodies with their velocities after a step of the linearised implicit Euler rule, which only removes
    /// energy from linear motion; see [`super::bound`]. Their memory should be returned by [`Self::give_back`].
    pub(crate) fn settle(
        &mut self,
        elements: &[Element],
        bodies: &[Body],
        step: f64,
        budget: u32,
    ) -> Vec<Body> {
        self.measure(elements, bodies, step);
        self.system.begin(bodies);
        for row in &mut self.rows {
            let (element, line, before) = (&elements[row.element], &row.line, &row.before);
            let tension = element.elastic(line.length).force;
            let drag = element.drag(line.length, before.axial);
            let stiffness = element.stiffness_ahead(line.length, step * before.axial);
            let late = steep(drag, before.axial) + step * stiffness;
            let across = across(element, line, tension);
            let now = tension + drag.force + step * stiffness * before.axial;
            row.load = now * line.direction + step * across * before.lateral;
            row.centripetal_gain = 0.0;
            let (along, across) = (step * late, step * step * across);
            self.system.struts.push(strut(line, bodies, along, across));
        }
        self.system.prepare();
        self.solve(bodies, LAST, budget);
        let mut moved = std::mem::take(&mut self.moved);
        moved.clear();
        moved.extend_from_slice(bodies);
        self.act(&mut moved, step);
        moved
    }

    /// Takes back the memory of [`Self::settle`].
    pub(crate) fn give_back(&mut self, moved: Vec<Body>) {
        self.moved = moved;
    }

    /// Makes the next iterations start from zero.
    pub(super) fn forget_solution(&mut self) {
        self.acceleration = Twists::default();
    }

    /// Vector from which the iterations of the next solve start; none if they start from zero.
    pub(super) fn start(&self) -> Option<&Twists> {
        (!self.system.was_factorised()).then_some(&self.acceleration)
    }

    /// Makes the next iterations start from `start` if it is finite.
    pub(super) fn start_from(&mut self, start: &Twists) {
        if start
            .linear
            .iter()
            .chain(&start.angular)
            .all(|x| x.is_finite())
        {
            self.acceleration.clone_from(start);
        }
    }

    /// Returns whether the network is solved by iterations, and whether all solves since the last call converged.
    pub(crate) fn take_effort(&mut self) -> (bool, bool) {
        (!self.system.is_direct(), !take(&mut self.unconverged))
    }

    fn add_struts(&mut self, elements: &[Element], bodies: &[Body], step: f64, theta: f64) {
        let h2 = step * step;
        for row in &mut self.rows {
            let (element, line, before) = (&elements[row.element], &row.line, &row.before);
            let rate = line.backward_rate(before, step);
            let elastic = element.elastic(line.length);
            let drag = element.drag(line.length, rate);
            let k = elastic.stiffness;
            let stiffest = line
                .holds
                .iter()
                .filter_map(|hold| Some(self.stiffness[hold.body?]))
                .fold(0.0, f64::max);
            let settle = settling(h2 * stiffest) * step;
            let others = step * bounds::of_others(&self.damping, line, row.braking);
            let mut c = drag.slope;
            if c * step * line.inverse_mass > STRONG {
                c = steep(drag, rate);
            }
            let damper = c;
            c += settle * k;
            row.heating = match (drag.force.abs(), (settle * k * rate).abs()) {
                _ if c == damper => 1.0,
                (0.0, _) => damper / c,
                (force, settling) => force / (force + settling),
            };
            let tension = elastic.force + drag.force + settle * k * rate;
            let own = c * step * line.inverse_mass;
            let damping = damper_placement(together(own, others)) * step * c;
            let across = across(element, line, tension);
            let freest: f64 = line
                .holds
                .iter()
                .map(|h| h.inverse_mass.max_element())
                .sum();
            let settle_across = settling(2.0 * h2 * across * freest) * step;
            // The half drift has already added h²/8 of the centripetal acceleration to the stretch.
            row.centripetal_gain = (theta - 0.125) * h2 * k + damping;
            row.elastic = elastic.force;
            row.drag = tension - elastic.force;
            row.damping = damping;
            row.load = tension * line.direction + settle_across * across * before.lateral;
            let across = (theta * h2 + 0.5 * settle_across * step) * across;
            let along = theta * h2 * k + damping;
            self.system.struts.push(strut(line, bodies, along, across));
        }
    }

    /// Solves for the accelerations, with the present centripetal accelerations of the rows.
    fn solve(&mut self, bodies: &[Body], tolerance: f64, budget: u32) {
        let right = &mut self.right;
        right.clear(bodies.len(), self.system.turns());
        for (i, body) in bodies.iter().enumerate() {
            right.linear[i] = body.force_for(body.acceleration);
            if self.system.turns() {
                right.angular[i] = body.torque;
            }
        }
        for (row, strut) in self.rows.iter().zip(&self.system.struts) {
            strut.add(right, -row.force());
        }
        let until = Until { tolerance, budget };
        let converged = self
            .system
            .solve(&mut self.right, &mut self.acceleration, until);
        self.unconverged |= !converged;
    }

    /// Applies the solution and the external forces to the bodies. An element's two forces are opposite, so they conserve
    /// linear momentum however exact the solution is. The forces along the lines also conserve angular momentum.
    fn act(&self, bodies: &mut [Body], step: f64) {
        for (row, strut) in self.rows.iter().zip(&self.system.struts) {
            let force = row.force() + strut.force(strut.relative(&self.acceleration));
            row.line.impulse(bodies, -step * force);
        }
        kick::external(bodies, step);
    }
}

/// The part of an element in the linear system.
fn strut(line: &Line, bodies: &[Body], along: f64, across: f64) -> Strut {
    let arm = |end: usize| match line.holds[end].body {
        _ if line.holds[end].twist => DVec3::ZERO,
        Some(index) if bodies[index].spin != Spin::Ignored => line.holds[end].arm,
        _ => DVec3::ZERO,
    };
    Strut {
        bodies: [0, 1].map(|end| line.holds[end].body.unwrap_or(NOBODY)),
        arms: [0, 1].map(arm),
        direction: line.direction,
        along,
        across,
        twist: line.holds[0].twist,
    }
}

impl Row {
    fn force(&self) -> DVec3 {
        self.load + self.centripetal_gain * self.centripetal * self.line.direction
    }
}

/// Stiffness across the line, N/m. A spring in tension pulls a laterally displaced end back.
fn across(element: &Element, line: &Line, tension: f64) -> f64 {
    if line.isotropic {
        element.stiffness
    } else if tension > 0.0 && line.length > 0.0 && !line.guided {
        tension / line.length
    } else {
        0.0
    }
}
