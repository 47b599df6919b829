//! The kick of a network of points after the first half drift. The formulas are those of [`crate::dynamics::network`].

use super::parts::Window;
use super::{Exchanged, Line, Point, Points, Wire};
use crate::dynamics::line;
use crate::dynamics::network::{REVERSES, damper_placement, placement, settling, together};
use crate::threads::each;
use bevy::math::DVec3;

/// One element within a kick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bar {
    pub ends: [u32; 2],
    isotropic: bool,
    pub direction: DVec3,
    length: f64,
    /// Rate of the length before the kick, m/s.
    axial: f64,
    /// Force on its ends before the solve, without the part from the turning of the line, N.
    load: DVec3,
    /// Force along the line per centripetal acceleration, N per m/s².
    turning: f64,
    /// Centripetal acceleration of the line, m/s².
    turns: f64,
    /// Damping force before the solve, N.
    drag: f64,
    /// Damping force per relative acceleration along the line, N per m/s².
    damping: f64,
    /// Force that a relative acceleration along the line adds, N per m/s².
    pub along: f64,
    /// Force that a relative acceleration across the line adds, N per m/s².
    pub across: f64,
}

impl Bar {
    /// Force before the solve, N.
    fn force(&self) -> DVec3 {
        self.load + self.turning * self.turns * self.direction
    }

    /// Force that the relative acceleration `r` adds, N.
    pub(super) fn answer(&self, r: DVec3) -> DVec3 {
        self.across * r + (self.along - self.across) * self.direction.dot(r) * self.direction
    }

    /// Centripetal acceleration |lateral|²/L, m/s². Bounded where the step does not resolve the turning of the line.
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

impl Wire {
    /// c h/m that places its damper in the step, where its own is `own`. `damping` is that of all elements at each end over its
    /// mass, 1/s.
    #[inline(always)]
    fn braked(&self, own: f64, ends: [&Point; 2], damping: [f64; 2], step: f64) -> f64 {
        // The sums count the element too. Most are so small that its share in them does not matter.
        if own + step * damping[0].max(damping[1]) <= REVERSES {
            return own;
        }
        let shares = self.shares(ends);
        let others = [0, 1].map(|end| damping[end] - self.damping * shares[end]);
        together(own, step * others[0].max(others[1]).max(0.0))
    }
}

impl Bar {
    /// The bar of an element between two points. `stiffness` (1/s²) and `damping` (1/s) are those of all elements at each of the
    /// two, over its mass. An element without a direction adds nothing.
    #[inline(always)]
    fn measure(
        wire: &Wire,
        ends: [&Point; 2],
        [stiffness, damping]: [[f64; 2]; 2],
        step: f64,
        theta: f64,
    ) -> Self {
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
        let settle = settling(h2 * stiffness[0].max(stiffness[1])) * step;
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
        let own = c * step * inverse_mass;
        let braked = wire.braked(own, ends, damping, step);
        bar.damping = damper_placement(braked) * step * c;
        let across = if bar.isotropic {
            k
        } else if tension > 0.0 && length > 0.0 {
            tension / length
        } else {
            0.0
        };
        let settle_across = settling(2.0 * h2 * across * inverse_mass) * step;
        // The half drift has already added h²/8 of the centripetal acceleration to the stretch.
        bar.turning = (theta - 0.125) * h2 * k + bar.damping;
        bar.drag = tension - elastic;
        bar.load = tension * u + settle_across * across * lateral;
        bar.across = (theta * h2 + 0.5 * settle_across * step) * across;
        bar.along = theta * h2 * k + bar.damping;
        bar
    }
}

impl Points {
    /// Applies the kick of all elements and external forces together.
    pub(super) fn kick(&mut self, step: f64) {
        let (z_max, _) = self.bounds(step);
        self.measure(step, placement(z_max));
        self.solver
            .begin(&self.points[..self.bodies], &self.bars, &self.parts);
        self.solve();
        self.push(step);
        let (points, impulses) = (&self.points, &self.impulses);
        each(&mut self.bars, |_, bar| {
            // The mean of before and after the kick makes the step time-symmetric.
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

    /// Computes the line of each element, its motion, and its part of the linear system.
    pub(super) fn measure(&mut self, step: f64, theta: f64) {
        self.bars.resize(self.wires.len(), Bar::default());
        let (points, wires) = (&self.points, &self.wires);
        let sums = [&self.stiffness, &self.damping];
        each(&mut self.bars, |at, bar| {
            let wire = &wires[at];
            let sums = sums.map(|of| wire.ends.map(|end| of[end as usize]));
            *bar = Bar::measure(wire, wire.of(points), sums, step, theta);
        });
    }

    /// Solves for the accelerations at the present turning of the lines.
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

    /// Computes the impulses of the solution. They come in pairs of opposite impulses, so linear momentum is conserved
    /// even if the solution is inexact. Angular momentum is too, as far as they act along the lines.
    fn push(&mut self, step: f64) {
        each(&mut self.impulses, |_, impulse| *impulse = DVec3::ZERO);
        let solution = &self.solver.solution;
        self.parts
            .scatter(&self.bars, &mut self.impulses, |bar, impulses| {
                let force = bar.force() + bar.answer(bar.relative(solution));
                bar.add(impulses, -step * force);
            });
    }

    /// Adds up the heat of dampers and the work of moving ends.
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
    /// Adds the heat of its damper and the work of its moving ends. `relative` is the relative acceleration of the ends,
    /// m/s².
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

/// External force on a point, N.
fn weight(point: &Point) -> DVec3 {
    if point.inverse_mass == 0.0 {
        return DVec3::ZERO;
    }
    point.acceleration / point.inverse_mass
}
