//! The kick of a network of points between two half drifts.

use super::bar::{Bar, Load, add};
use super::parts::{Run, places};
use super::solve::{Block, Solver};
use super::{Points, State};
use crate::dynamics::conjugate::{FIRST, LAST, Until};
use crate::dynamics::network::placement;
use crate::threads::{PIECE, share_pieces};
use bevy::math::DVec3;

/// (ω h)² of the stiffest mode below which the matrix is so well conditioned that a few iterations solve it. Pinned by
/// `points::tests::a_sheet_of_points_moves_as_one_of_bodies`.
const SOFT: f64 = 9.0;

impl Points {
    /// Applies the kick of all elements and external forces together. The second half drift follows at once.
    pub(super) fn kick(&mut self, step: f64) {
        let (z_max, _) = self.bounds(step);
        self.measure(step, placement(z_max));
        self.solver.prepare(&self.bars, z_max < SOFT);
        self.solve(FIRST);
        self.push(step, false);
        self.turn(step);
        self.solve(LAST);
        self.push(step, true);
        self.arrive(step);
    }

    /// Computes the line of each element, its motion, and the linear system.
    pub(super) fn measure(&mut self, step: f64, theta: f64) {
        let (points, bodies) = (&self.points, self.points.bodies);
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
        let (solution, sums) = (&solution[..], &self.sums[..]);
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
                    for (i, mass) in masses.iter_mut().enumerate() {
                        let body = first + i;
                        *mass = points.inverse_masses[body].recip();
                        blocks[i] = Block::of_mass(*mass);
                        right[i] = weight(points, body);
                        image[i] = *mass * solution[body];
                    }
                }
                for ((wire, bar), load) in wires.iter().zip(bars).zip(loads) {
                    (*bar, *load) = wire.measure(points, wire.of(sums), step, theta);
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
    fn solve(&mut self, tolerance: f64) {
        let budget = self.budget;
        let until = Until { tolerance, budget };
        self.converged &= self.solver.solve(&self.bars, &self.parts, until);
    }

    /// Computes the impulses of the solution. They come in pairs of opposite impulses, so linear momentum is conserved
    /// even if the solution is inexact. Angular momentum is too, as far as they act along the lines. For the `last`
    /// solution, also adds up the heat of dampers and the work of moving ends.
    fn push(&mut self, step: f64, last: bool) {
        let (points, solution) = (&self.points, &self.solver.solution[..]);
        for stage in self.parts.stages() {
            let elements = (&self.bars[..], &self.loads[..], &mut self.exchanged[..]);
            let impulses = &mut self.impulses[..points.bodies];
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
                        let led = [points.led(bar.ends[0]), points.led(bar.ends[1])];
                        load.account(bar, exchanged, led, [relative, force], step);
                    }
                }
            });
        }
    }

    /// Computes how the lines turn with the impulses of the first solution, and the right side for the second one. What is left
    /// in place of the impulses are the velocities after the kick.
    fn turn(&mut self, step: f64) {
        let (points, bodies) = (&self.points, self.points.bodies);
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
                    for (i, mass) in masses.iter().enumerate() {
                        let body = first + i;
                        let kicked = points.inverse_masses[body] * after[i];
                        let pulled = step * points.accelerations[body];
                        after[i] = points.velocities[body] + kicked + pulled;
                        right[i] = weight(points, body);
                        image[i] = *mass * solution[body];
                    }
                }
                for (bar, load) in bars.iter().zip(loads) {
                    let places = places(bar.ends, first);
                    let velocity = |end: usize| match after.get(places[end]) {
                        Some(velocity) => *velocity,
                        None => points.velocities[bar.ends[end] as usize],
                    };
                    load.turn(bar, velocity(1) - velocity(0), step);
                    add(right, places, -load.force(bar));
                    add(image, places, bar.answer(bar.relative(solution)));
                }
            });
        }
    }

    /// Gives the bodies the impulses, and moves all points on by half a step.
    fn arrive(&mut self, step: f64) {
        let State {
            bodies,
            positions,
            velocities,
            accelerations,
            inverse_masses,
            given,
        } = &mut self.points;
        let (positions, led_positions) = positions.split_at_mut(*bodies);
        let (velocities, led_velocities) = velocities.split_at_mut(*bodies);
        let impulses = &self.impulses;
        let moving = positions
            .chunks_mut(PIECE)
            .zip(velocities.chunks_mut(PIECE));
        let pieces = moving.zip(given.chunks_mut(PIECE)).enumerate();
        share_pieces(pieces, |(piece, ((positions, velocities), given))| {
            for (i, given) in given.iter_mut().enumerate() {
                let at = piece * PIECE + i;
                *given += impulses[at];
                velocities[i] += inverse_masses[at] * impulses[at] + step * accelerations[at];
                positions[i] += step / 2.0 * velocities[i];
            }
        });
        for (position, velocity) in led_positions.iter_mut().zip(led_velocities) {
            *position += step / 2.0 * *velocity;
        }
    }
}

/// External force on a body, N.
#[inline(always)]
fn weight(points: &State, body: usize) -> DVec3 {
    points.accelerations[body] / points.inverse_masses[body]
}
