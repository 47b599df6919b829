//! The kick at the half drift; see [`crate::dynamics::network`], whose formulas these are.

use super::parts::Window;
use super::{Exchanged, Line, Point, Points, Wire};
use crate::dynamics::line;
use crate::dynamics::network::{damper_placement, placement, settling};
use crate::threads::each;
use bevy::math::DVec3;

/// One element within a kick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bar {
    pub ends: [u32; 2],
    isotropic: bool,
    pub direction: DVec3,
    length: f64,
    /// Rate of the length before the kick.
    axial: f64,
    /// Force on its ends before the solve, without that of the line's turning.
    load: DVec3,
    /// What the turning adds to it along the line, N per m/s².
    turning: f64,
    /// The turning itself, m/s².
    turns: f64,
    /// Damping force before the solve, N, and what it gains per m/s².
    drag: f64,
    damping: f64,
    /// Force that a relative acceleration along and across the line adds, N per m/s².
    pub along: f64,
    pub across: f64,
}

impl Bar {
    /// Force before the solve.
    fn force(&self) -> DVec3 {
        self.load + self.turning * self.turns * self.direction
    }

    /// Force that a relative acceleration adds.
    pub(super) fn answer(&self, r: DVec3) -> DVec3 {
        self.across * r + (self.along - self.across) * self.direction.dot(r) * self.direction
    }

    /// |lateral|²/L, bounded where the line turns further than the step can follow.
    fn turning_at(&self, lateral_square: f64, step: f64) -> f64 {
        if self.isotropic || lateral_square == 0.0 {
            return 0.0;
        }
        line::turning(self.length, lateral_square, step)
    }

    fn of<'a, T>(&self, all: &'a [T]) -> [&'a T; 2] {
        self.ends.map(|end| &all[end as usize])
    }

    /// Relative acceleration of the ends.
    pub(super) fn relative(&self, x: &[DVec3]) -> DVec3 {
        let [a, b] = self.of(x);
        *b - *a
    }

    /// Adds a force on end B and its opposite on end A.
    pub(super) fn add(&self, to: &mut Window<DVec3>, force: DVec3) {
        if let Some(a) = to.of(self.ends[0]) {
            *a -= force;
        }
        if let Some(b) = to.of(self.ends[1]) {
            *b += force;
        }
    }
}

impl Bar {
    /// Of an element between these points, of which the one on the stiffest springs has so much stiffness over its mass. One without a
    /// direction adds nothing.
    #[inline(always)]
    fn measure(wire: &Wire, ends: [&Point; 2], stiffest: f64, step: f64, theta: f64) -> Self {
        let h2 = step * step;
        let Some(Line { direction, length }) = wire.line(ends) else {
            return Self {
                ends: wire.ends,
                ..Self::default()
            };
        };
        let ([a, b], u, k) = (ends, direction, wire.stiffness);
        let velocity = b.velocity - a.velocity;
        let axial = velocity.dot(u);
        let lateral = velocity - axial * u;
        let lateral_square = lateral.length_squared();
        let mut bar = Self {
            ends: wire.ends,
            isotropic: wire.rest_length == 0.0 && !wire.stiff_damper,
            direction: u,
            length,
            axial,
            ..Self::default()
        };
        bar.turns = bar.turning_at(lateral_square, step);
        let settle = settling(h2 * stiffest) * step;
        let c = wire.damping + settle * k;
        let rate = if c == 0.0 {
            0.0
        } else if bar.isotropic {
            axial
        } else {
            line::backward_rate(length, axial, lateral_square, step)
        };
        let elastic = k * (length - wire.rest_length);
        let tension = elastic + c * rate;
        let inverse_mass = a.inverse_mass + b.inverse_mass;
        bar.damping = damper_placement(c * step * inverse_mass) * step * c;
        let across = if bar.isotropic {
            k
        } else if tension > 0.0 && length > 0.0 {
            tension / length
        } else {
            0.0
        };
        let settle_across = settling(2.0 * h2 * across * inverse_mass) * step;
        // The half drift counted h²/8 of the turning as stretch already.
        bar.turning = (theta - 0.125) * h2 * k + bar.damping;
        bar.drag = tension - elastic;
        bar.load = tension * u + settle_across * across * lateral;
        bar.across = (theta * h2 + 0.5 * settle_across * step) * across;
        bar.along = theta * h2 * k + bar.damping;
        bar
    }
}

impl Points {
    /// All elements and outside forces together.
    pub(super) fn kick(&mut self, step: f64) {
        let (z_max, _) = self.bounds(step);
        self.measure(step, placement(z_max));
        self.solver
            .begin(&self.points[..self.bodies], &self.bars, &self.parts);
        self.solve();
        self.push(step);
        let (points, impulses) = (&self.points, &self.impulses);
        each(&mut self.bars, |_, bar| {
            // The mean of before and after the kick keeps the step its own mirror image in time.
            let after = |end: u32| {
                let (point, impulse) = (&points[end as usize], impulses[end as usize]);
                point.velocity + point.inverse_mass * impulse + step * point.acceleration
            };
            let velocity = after(bar.ends[1]) - after(bar.ends[0]);
            let lateral = velocity - velocity.dot(bar.direction) * bar.direction;
            let turns = bar.turning_at(lateral.length_squared(), step);
            bar.turns = 0.5 * (bar.turns + turns);
        });
        self.solve();
        self.push(step);
        let impulses = &self.impulses;
        each(&mut self.points[..self.bodies], |at, point| {
            let impulse = impulses[at];
            point.given += impulse;
            point.velocity += point.inverse_mass * impulse + step * point.acceleration;
        });
        self.account(step);
    }

    /// Where the lines are, what they do, and what each adds to the system.
    pub(super) fn measure(&mut self, step: f64, theta: f64) {
        self.bars.resize(self.wires.len(), Bar::default());
        let (points, stiffness) = (&self.points, &self.stiffness);
        let wires = &self.wires;
        each(&mut self.bars, |at, bar| {
            let wire = &wires[at];
            let stiffest = wire.ends.map(|end| stiffness[end as usize]);
            let stiffest = stiffest[0].max(stiffest[1]);
            *bar = Bar::measure(wire, wire.of(points), stiffest, step, theta);
        });
    }

    /// Accelerations for the lines' present turning.
    fn solve(&mut self) {
        let (right, points) = (&mut self.impulses, &self.points);
        right.resize(points.len(), DVec3::ZERO);
        each(right, |at, right| *right = weight(&points[at]));
        self.parts
            .scatter(&self.bars, right, |bar, right| bar.add(right, -bar.force()));
        self.converged &= self
            .solver
            .solve(right, &self.bars, &self.parts, self.budget);
    }

    /// Impulses of the solution. They come in pairs along the lines, so both momenta are kept however
    /// exact it is.
    fn push(&mut self, step: f64) {
        each(&mut self.impulses, |_, impulse| *impulse = DVec3::ZERO);
        let solution = &self.solver.solution;
        self.parts
            .scatter(&self.bars, &mut self.impulses, |bar, impulses| {
                let force = bar.force() + bar.answer(bar.relative(solution));
                bar.add(impulses, -step * force);
            });
    }

    /// Notes what dampers took and moving ends gave.
    fn account(&mut self, step: f64) {
        let (points, solution) = (&self.points, &self.solver.solution);
        let bars = &self.bars;
        each(&mut self.exchanged, |at, exchanged| {
            let bar = &bars[at];
            bar.account(exchanged, bar.of(points), bar.relative(solution), step);
        });
    }
}

impl Bar {
    /// Notes what its damper took and moving ends gave, where its ends have been accelerated so against each other.
    #[inline(always)]
    fn account(&self, exchanged: &mut Exchanged, [a, b]: [&Point; 2], relative: DVec3, step: f64) {
        let moved = [a, b].map(|end| end.inverse_mass == 0.0 && end.velocity != DVec3::ZERO);
        if self.damping == 0.0 && moved == [false; 2] {
            return;
        }
        let gained = relative.dot(self.direction);
        let rate = self.axial + 0.5 * step * gained;
        exchanged.heat += ((self.drag + self.damping * gained) * rate * step).max(0.0);
        let force = self.force() + self.answer(relative);
        for (end, sign) in [(a, -1.0), (b, 1.0)] {
            if end.inverse_mass == 0.0 {
                exchanged.work += sign * step * force.dot(end.velocity);
            }
        }
    }
}

/// The force of a point's outside acceleration.
fn weight(point: &Point) -> DVec3 {
    if point.inverse_mass == 0.0 {
        return DVec3::ZERO;
    }
    point.acceleration / point.inverse_mass
}
