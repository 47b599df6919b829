//! One element within a kick. The formulas are those of [`crate::dynamics::network`].

use super::{Exchanged, Line, State, Wire};
use crate::dynamics::line;
use crate::dynamics::network::{REVERSES, damper_placement, settling, shares, together};
use crate::dynamics::strut::stiff_force;
use bevy::math::DVec3;

/// The part of an element in the linear system. Every iteration reads it, so it is no larger than it must be.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bar {
    pub ends: [u32; 2],
    pub direction: DVec3,
    /// Force that a relative acceleration along the line adds, N per m/s².
    pub along: f64,
    /// Force that a relative acceleration across the line adds, N per m/s².
    pub across: f64,
}

/// What else a kick needs of an element.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Load {
    isotropic: bool,
    length: f64,
    /// Rate of the length before the kick, m/s.
    axial: f64,
    /// Force on its ends before the solve, without the part from the turning of the line, N.
    load: DVec3,
    /// Force along the line per centripetal acceleration, N per m/s².
    turning: f64,
    /// Centripetal acceleration of the line, m/s².
    turns: f64,
    /// Force of its damper before the solve, N.
    drag: f64,
    /// Force of its damper per relative acceleration along the line, N per m/s².
    damping: f64,
}

impl Bar {
    /// Force that the relative acceleration `r` adds, N.
    #[inline(always)]
    pub(super) fn answer(&self, r: DVec3) -> DVec3 {
        stiff_force([self.along, self.across], self.direction, r)
    }

    /// Relative acceleration of the ends.
    #[inline(always)]
    pub(super) fn relative(&self, x: &[DVec3]) -> DVec3 {
        let [a, b] = self.ends;
        x[b as usize] - x[a as usize]
    }
}

/// Adds a vector at end B, and its opposite at end A. `places` are those of [`super::parts::places`].
#[inline(always)]
pub(super) fn add(to: &mut [DVec3], places: [usize; 2], vector: DVec3) {
    if let Some(a) = to.get_mut(places[0]) {
        *a -= vector;
    }
    if let Some(b) = to.get_mut(places[1]) {
        *b += vector;
    }
}

impl Load {
    /// Force before the solve, N.
    #[inline(always)]
    pub(super) fn force(&self, bar: &Bar) -> DVec3 {
        self.load + self.turning * self.turns * bar.direction
    }

    /// Notes how the line turns if end B has a velocity (m/s) relative to end A after the kick. The mean of before and after
    /// makes the step time-symmetric.
    #[inline(always)]
    pub(super) fn turn(&mut self, bar: &Bar, velocity: DVec3, step: f64) {
        let lateral = velocity - velocity.dot(bar.direction) * bar.direction;
        let turns = self.turning_at(lateral.length_squared(), step);
        self.turns = 0.5 * (self.turns + turns);
    }

    /// Centripetal acceleration |lateral|²/L, m/s². Bounded where the step does not resolve the turning of the line.
    #[inline(always)]
    fn turning_at(&self, lateral_square: f64, step: f64) -> f64 {
        if self.isotropic || lateral_square == 0.0 {
            return 0.0;
        }
        line::turning(self.length, lateral_square, step)
    }

    /// Adds the heat of its damper and the work of its ends with prescribed motion, whose velocities are `led`, m/s.
    /// `relative` is the relative acceleration of the ends (m/s²), and `force` the force on them (N).
    #[inline(always)]
    pub(super) fn account(
        &self,
        bar: &Bar,
        exchanged: &mut Exchanged,
        led: [Option<DVec3>; 2],
        [relative, force]: [DVec3; 2],
        step: f64,
    ) {
        let [a, b] = led.each_ref();
        let is_moved = |velocity: &Option<DVec3>| velocity.is_some_and(|v| v != DVec3::ZERO);
        if self.damping == 0.0 && !is_moved(a) && !is_moved(b) {
            return;
        }
        let gained = relative.dot(bar.direction);
        let rate = self.axial + 0.5 * step * gained;
        exchanged.heat += ((self.drag + self.damping * gained) * rate * step).max(0.0);
        for (velocity, sign) in led.into_iter().zip([-1.0, 1.0]) {
            if let Some(velocity) = velocity {
                exchanged.work += sign * step * force.dot(velocity);
            }
        }
    }
}

impl Wire {
    /// c h/m that places its damper in the step, where its own is `own`. `damping` is that of all elements at each end over its
    /// mass, 1/s.
    #[inline(always)]
    fn braked(&self, own: f64, inverse_masses: [f64; 2], damping: [f64; 2], step: f64) -> f64 {
        // The sums count the element too. Most are so small that its share in them does not matter.
        if own + step * damping[0].max(damping[1]) <= REVERSES {
            return own;
        }
        let shares = shares(inverse_masses);
        let others = [0, 1].map(|end| damping[end] - self.damping * shares[end]);
        together(own, step * others[0].max(others[1]).max(0.0))
    }

    /// Its part in a kick. `sums` are stiffness (1/s²) and damping (1/s) of all elements at each of its ends, over the mass there.
    /// An element without a direction adds nothing. It
    /// is long because it is the whole formula of a kick.
    #[inline(always)]
    pub(super) fn measure(
        &self,
        points: &State,
        sums: [[f64; 2]; 2],
        step: f64,
        theta: f64,
    ) -> (Bar, Load) {
        let h2 = step * step;
        let mut bar = Bar {
            ends: self.ends,
            ..Bar::default()
        };
        let Some(Line { direction, length }) = self.line(points) else {
            return (bar, Load::default());
        };
        let (u, k) = (direction, self.stiffness);
        let [a, b] = self.of(&points.velocities);
        let velocity = b - a;
        let axial = velocity.dot(u);
        let lateral = velocity - axial * u;
        let lateral_square = lateral.length_squared();
        let mut load = Load {
            isotropic: self.rest_length == 0.0 && !self.stiff_damper,
            length,
            axial,
            ..Load::default()
        };
        load.turns = load.turning_at(lateral_square, step);
        let [[stiffness_a, damping_a], [stiffness_b, damping_b]] = sums;
        let settle = settling(h2 * stiffness_a.max(stiffness_b)) * step;
        let c = self.damping + settle * k;
        let rate = if c == 0.0 {
            0.0
        } else if load.isotropic {
            axial
        } else {
            line::backward_rate(length, axial, lateral_square, step)
        };
        let elastic = k * (length - self.rest_length);
        let tension = elastic + c * rate;
        let inverse_masses = self.inverse_masses(points);
        let inverse_mass = inverse_masses[0] + inverse_masses[1];
        let own = c * step * inverse_mass;
        let braked = self.braked(own, inverse_masses, [damping_a, damping_b], step);
        load.damping = damper_placement(braked) * step * c;
        let across = if load.isotropic {
            k
        } else if tension > 0.0 && length > 0.0 {
            tension / length
        } else {
            0.0
        };
        let settle_across = settling(2.0 * h2 * across * inverse_mass) * step;
        // The half drift has already added h²/8 of the centripetal acceleration to the stretch.
        load.turning = (theta - 0.125) * h2 * k + load.damping;
        load.drag = tension - elastic;
        load.load = tension * u + settle_across * across * lateral;
        bar.direction = u;
        bar.across = (theta * h2 + 0.5 * settle_across * step) * across;
        bar.along = theta * h2 * k + load.damping;
        if c > 0.0 {
            // What settles a motion that the step cannot resolve is no heat.
            let own = self.damping / c;
            load.drag *= own;
            load.damping *= own;
        }
        (bar, load)
    }
}
