//! The kick of a network of points after the first half drift.

use super::bar::{Bar, Load, add};
use super::parts::{Run, places};
use super::solve::{Block, Solver};
use super::{Point, Points};
use crate::dynamics::network::placement;
use crate::threads::each;
use bevy::math::DVec3;

impl Points {
    /// Applies the kick of all elements and external forces together.
    pub(super) fn kick(&mut self, step: f64) {
        let (z_max, _) = self.bounds(step);
        self.measure(step, placement(z_max));
        self.solver.invert_blocks();
        self.solve();
        self.push(step, false);
        self.turn(step);
        self.solve();
        self.push(step, true);
        let impulses = &self.impulses;
        each(&mut self.points[..self.bodies], |at, point| {
            let impulse = impulses[at];
            point.given += impulse;
            point.velocity += point.inverse_mass * impulse + step * point.acceleration;
        });
    }

    /// Computes the line of each element, its motion, and the linear system.
    pub(super) fn measure(&mut self, step: f64, theta: f64) {
        let (points, bodies) = (&self.points[..], self.bodies);
        self.bars.resize(self.wires.len(), Bar::default());
        self.loads.resize(self.wires.len(), Load::default());
        self.impulses.resize(points.len(), DVec3::ZERO);
        self.solver.resize(bodies, points.len());
        let Solver {
            solution,
            masses,
            blocks,
            right,
            image,
            ..
        } = &mut self.solver;
        let (solution, sums) = (&solution[..], [&self.stiffness, &self.damping]);
        for stage in self.parts.stages() {
            let elements = (&self.wires[..], &mut self.bars[..], &mut self.loads[..]);
            let sides = (&mut right[..], &mut image[..]);
            let of_bodies = (sides, &mut masses[..], &mut blocks[..]);
            self.parts.pass(*stage, elements, of_bodies, |run| {
                let Run {
                    elements: (wires, bars, loads),
                    bodies: ((right, image), masses, blocks),
                    first,
                } = run;
                if stage.is_first() {
                    for (i, point) in points[first..].iter().take(masses.len()).enumerate() {
                        masses[i] = point.inverse_mass.recip();
                        blocks[i] = Block::of_mass(masses[i]);
                        right[i] = weight(point);
                        image[i] = masses[i] * solution[first + i];
                    }
                }
                for ((wire, bar), load) in wires.iter().zip(bars).zip(loads) {
                    let sums = sums.map(|of| wire.ends.map(|end| of[end as usize]));
                    (*bar, *load) = wire.measure(wire.of(points), sums, step, theta);
                    let (places, block) = (places(bar.ends, first), Block::of_bar(bar));
                    for place in places {
                        if let Some(own) = blocks.get_mut(place) {
                            own.add(&block);
                        }
                    }
                    add(right, places, -load.force(bar));
                    add(image, places, bar.answer(bar.relative(solution)));
                }
            });
        }
    }

    /// Solves for the accelerations at the present turning of the lines.
    fn solve(&mut self) {
        self.converged &= self.solver.solve(&self.bars, &self.parts, self.budget);
    }

    /// Computes the impulses of the solution. They come in pairs of opposite impulses, so linear momentum is conserved
    /// even if the solution is inexact. Angular momentum is too, as far as they act along the lines. For the `last`
    /// solution, also adds up the heat of dampers and the work of moving ends.
    fn push(&mut self, step: f64, last: bool) {
        let (solution, bodies) = (&self.solver.solution[..], self.bodies);
        let led = &self.points[bodies..];
        let led = |end: u32| Some(led.get((end as usize).wrapping_sub(bodies))?.velocity);
        for stage in self.parts.stages() {
            let elements = (&self.bars[..], &self.loads[..], &mut self.exchanged[..]);
            let impulses = &mut self.impulses[..bodies];
            self.parts.pass(*stage, elements, impulses, |run| {
                let Run {
                    elements: (bars, loads, exchanged),
                    bodies: impulses,
                    first,
                } = run;
                if stage.is_first() {
                    impulses.fill(DVec3::ZERO);
                }
                for ((bar, load), exchanged) in bars.iter().zip(loads).zip(exchanged) {
                    let relative = bar.relative(solution);
                    let force = load.force(bar) + bar.answer(relative);
                    add(impulses, places(bar.ends, first), -step * force);
                    if last {
                        load.account(bar, exchanged, bar.ends.map(led), [relative, force], step);
                    }
                }
            });
        }
    }

    /// Computes how the lines turn with the impulses of the first solution, and the right side for the second one. What is left
    /// in place of the impulses are the velocities after the kick.
    fn turn(&mut self, step: f64) {
        let (points, bodies) = (&self.points[..], self.bodies);
        let Solver {
            solution,
            masses,
            right,
            image,
            ..
        } = &mut self.solver;
        let (solution, masses) = (&solution[..], &masses[..]);
        for stage in self.parts.stages() {
            let elements = (&self.bars[..], &mut self.loads[..]);
            let sides = (&mut right[..], &mut image[..]);
            let of_bodies = (sides, masses, &mut self.impulses[..bodies]);
            self.parts.pass(*stage, elements, of_bodies, |run| {
                let Run {
                    elements: (bars, loads),
                    bodies: ((right, image), masses, after),
                    first,
                } = run;
                if stage.is_first() {
                    for (i, point) in points[first..].iter().take(masses.len()).enumerate() {
                        let gained = point.inverse_mass * after[i] + step * point.acceleration;
                        after[i] = point.velocity + gained;
                        right[i] = weight(point);
                        image[i] = masses[i] * solution[first + i];
                    }
                }
                for (bar, load) in bars.iter().zip(loads) {
                    let places = places(bar.ends, first);
                    let [a, b] = [0, 1].map(|end| match after.get(places[end]) {
                        Some(velocity) => *velocity,
                        None => points[bar.ends[end] as usize].velocity,
                    });
                    load.turn(bar, b - a, step);
                    add(right, places, -load.force(bar));
                    add(image, places, bar.answer(bar.relative(solution)));
                }
            });
        }
    }
}

/// External force on a body, N.
fn weight(point: &Point) -> DVec3 {
    point.acceleration / point.inverse_mass
}
