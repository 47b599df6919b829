//! Force laws beyond the linear one: an element's tension as a function of its length and rate.
//!
//! The elastic part derives from an energy that is bounded below, and damping only removes energy. The integrators rely on
//! both. The spring's force is clamped between a least and a greatest one (rope, buffer, force limit). Stops at the ends of
//! the travel add to it.

mod drag;
mod pieces;
mod table;

pub(crate) use drag::{Drag, DragLaw};
pub(crate) use table::Table;

use super::thresholds::SHORT;
use std::fmt::Debug;
use std::sync::Arc;

/// A custom function of the user: force over stretch or over rate.
pub(crate) trait Function: Send + Sync + Debug {
    fn force(&self, x: f64) -> f64;
    fn slope(&self, x: f64) -> f64;
    /// Integral of the force from 0 to `x`.
    fn integral(&self, x: f64) -> f64;
}

/// Stretch at which the search for a law's limit ends, m. No tuning constant: any number far beyond a scene.
const FARTHEST: f64 = 1e9;

/// Tension (N) of a spring as a function of its stretch (m), before clamps.
#[derive(Clone, Debug)]
pub(crate) enum SpringForce {
    /// Coefficients of x, x|x| and x³, for pull (x ≥ 0) and for push (x < 0).
    Polynomial { pull: [f64; 3], push: [f64; 3] },
    /// Table of tension over stretch.
    Table(Arc<Table>),
    /// A custom function of the user.
    Custom(Arc<dyn Function>),
}

/// A stop at an end of the travel, with the force k p (1 + progression · p) at a penetration p.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stop {
    /// Stiffness k at first touch, N/m.
    pub stiffness: f64,
    /// Increase of stiffness with penetration, 1/m.
    pub progression: f64,
    /// Damping while touched, N s/m.
    pub damping: f64,
}

/// The whole law of one element.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    spring: SpringForce,
    pub drag: DragLaw,
    /// Constant tension that is added to the spring's, N.
    preload: f64,
    /// Least and greatest tension of the spring, N.
    limits: [f64; 2],
    /// Stretches at which the limits begin, m; infinite if a limit applies nowhere or everywhere.
    at_limits: [f64; 2],
    /// Least and greatest length before the stops, m.
    travel: [f64; 2],
    stop: Stop,
    /// Integral of the spring's force up to the stretch without force, J. There the stored energy is zero by definition.
    reference: f64,
    /// Greatest force of spring and damper together, N.
    most: f64,
    /// Whether there is neither spring nor preload. Such a damper is never slack.
    springless: bool,
}

/// The parameters of a law; see [`Law`].
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    pub spring: SpringForce,
    pub drag: DragLaw,
    pub preload: f64,
    /// Least and greatest tension of the spring, N. One of them is 0 for ropes and buffers.
    pub limits: [f64; 2],
    pub most: f64,
    pub travel: [f64; 2],
    pub stop: Stop,
}

/// A spring's tension and stored energy at a length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Elastic {
    /// Tension, N.
    pub force: f64,
    /// Slope of the tension, N/m; not negative.
    pub stiffness: f64,
    /// Stored energy, J.
    pub energy: f64,
}

impl Elastic {
    /// That of a linear spring at a stretch (m).
    pub(crate) fn linear(stiffness: f64, stretch: f64) -> Self {
        Self {
            force: stiffness * stretch,
            stiffness,
            energy: 0.5 * stiffness * stretch * stretch,
        }
    }
}

impl SpringForce {
    fn at(&self, x: f64) -> Elastic {
        let (force, stiffness, energy) = match self {
            Self::Polynomial { pull, push } => {
                let [k1, k2, k3] = if x < 0.0 { push } else { pull };
                let a = x.abs();
                (
                    x * (k1 + a * (k2 + a * k3)),
                    k1 + a * (2.0 * k2 + a * 3.0 * k3),
                    x * x * (k1 / 2.0 + a * (k2 / 3.0 + a * k3 / 4.0)),
                )
            }
            Self::Table(table) => {
                let [force, slope, integral] = table.at(x);
                (force, slope, integral)
            }
            Self::Custom(function) => (function.force(x), function.slope(x), function.integral(x)),
        };
        Elastic {
            force,
            stiffness: stiffness.max(0.0),
            energy,
        }
    }

    /// Whether the slope jumps at zero stretch.
    fn is_bent(&self) -> bool {
        matches!(self, Self::Polynomial { pull, push } if pull[0] != push[0])
    }
}

impl Stop {
    /// Force, stiffness and stored energy at a penetration `p`, m.
    fn at(&self, p: f64) -> Elastic {
        if p <= 0.0 {
            return Elastic::default();
        }
        let (k, g) = (self.stiffness, self.progression);
        Elastic {
            force: k * p * (1.0 + g * p),
            stiffness: k * (1.0 + 2.0 * g * p),
            energy: k * p * p * (0.5 + g * p / 3.0),
        }
    }
}

impl Law {
    /// The law of a linear element with a stiffness (N/m) and a damping (N s/m).
    pub(crate) fn linear(stiffness: f64, damping: f64) -> Self {
        let coefficients = [stiffness, 0.0, 0.0];
        let unlimited = [f64::NEG_INFINITY, f64::INFINITY];
        Self {
            spring: SpringForce::Polynomial {
                pull: coefficients,
                push: coefficients,
            },
            drag: DragLaw::Linear(damping),
            preload: 0.0,
            limits: unlimited,
            at_limits: unlimited,
            travel: unlimited,
            stop: Stop::default(),
            reference: 0.0,
            most: f64::INFINITY,
            springless: stiffness == 0.0,
        }
    }

    pub(crate) fn new(recipe: Recipe) -> Self {
        let springless = match &recipe.spring {
            SpringForce::Polynomial { pull, push } => *pull == [0.0; 3] && *push == [0.0; 3],
            SpringForce::Table(_) | SpringForce::Custom(_) => false,
        } && recipe.preload == 0.0;
        let mut law = Self {
            springless,
            spring: recipe.spring,
            drag: recipe.drag,
            preload: recipe.preload,
            limits: recipe.limits,
            at_limits: [f64::NEG_INFINITY, f64::INFINITY],
            travel: recipe.travel,
            stop: recipe.stop,
            reference: 0.0,
            most: recipe.most,
        };
        law.at_limits = law.limits.map(|limit| law.stretch_for(limit));
        if law.at_limits[0] > law.at_limits[1] {
            law.at_limits[1] = law.at_limits[0];
        }
        let free = law.stretch_for(0.0);
        let free = if free.is_finite() { free } else { 0.0 };
        law.reference = law.spring_at(free).energy;
        law
    }

    /// Spring and preload without clamps, at the stretch `x`.
    fn bare(&self, x: f64) -> Elastic {
        let mut bare = self.spring.at(x);
        bare.force += self.preload;
        bare.energy += self.preload * x;
        bare
    }

    /// Stretch at which the rising force of spring and preload reaches `force`, m: −∞ if it is greater at every stretch, ∞ if
    /// it is less at every stretch.
    fn stretch_for(&self, force: f64) -> f64 {
        if !force.is_finite() {
            return force;
        }
        let short = |x: f64| self.bare(x).force < force;
        let mut reach = 1e-3;
        while short(reach) || !(short(-reach) || self.bare(-reach).force == force) {
            reach *= 2.0;
            if reach > FARTHEST {
                return if short(reach) {
                    f64::INFINITY
                } else {
                    f64::NEG_INFINITY
                };
            }
        }
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if short(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// Spring and preload, clamped, at the stretch `x`. The energy has the same zero as that of [`Self::bare`].
    fn spring_at(&self, x: f64) -> Elastic {
        let within = x.clamp(self.at_limits[0], self.at_limits[1]);
        if within == x {
            return self.bare(x);
        }
        // Exactly the limit, which `bare` gives only up to rounding: a slack rope must have exactly no force.
        let force = self.limits[usize::from(x > within)];
        // If the spring is beyond its limit at every stretch, its force is constant. Its energy then counts from zero stretch.
        let (edge, stored) = if within.is_finite() {
            (within, self.bare(within).energy)
        } else {
            (0.0, 0.0)
        };
        Elastic {
            force,
            stiffness: 0.0,
            energy: stored + force * (x - edge),
        }
    }

    /// Tension of spring and preload without limits, where a limit cuts it to `cut`; elsewhere `cut`, N.
    fn uncut(&self, x: f64, cut: f64) -> f64 {
        if x > self.at_limits[1] {
            self.bare(x).force.max(cut)
        } else if x < self.at_limits[0] {
            self.bare(x).force.min(cut)
        } else {
            cut
        }
    }

    /// Tension of spring and stops without damping, and their stored energy.
    pub(crate) fn elastic(&self, length: f64, rest_length: f64) -> Elastic {
        let mut sum = self.spring_at(length - rest_length);
        sum.energy -= self.reference;
        for (stop, sign) in self.stops(length) {
            sum.force += sign * stop.force;
            sum.stiffness += stop.stiffness;
            sum.energy += stop.energy;
        }
        sum
    }

    /// Mean tension between two lengths, N. Its work is exactly the change of stored energy.
    pub(crate) fn mean_force(&self, [from, to]: [f64; 2], rest_length: f64) -> f64 {
        if (to - from).abs() > SHORT * (from.abs() + to.abs()) {
            let [a, b] = [from, to].map(|length| self.elastic(length, rest_length).energy);
            (b - a) / (to - from)
        } else {
            self.elastic(0.5 * (from + to), rest_length).force
        }
    }

    /// Forces of the stops at the least and the greatest length, with the signs of their tensions.
    fn stops(&self, length: f64) -> [(Elastic, f64); 2] {
        [
            (self.stop.at(self.travel[0] - length), -1.0),
            (self.stop.at(length - self.travel[1]), 1.0),
        ]
    }

    /// Whether the law can remove energy.
    pub(crate) fn damps(&self) -> bool {
        self.drag.linear() != Some(0.0) || self.stop.damping > 0.0
    }

    /// Tension from damping, and its slope.
    pub(crate) fn drag(&self, length: f64, rest_length: f64, rate: f64) -> Drag {
        let mut sum = Drag::default();
        let spring = self.spring_at(length - rest_length).force;
        // A slack rope does not damp, and its damper cannot make it push.
        let one_way = self.limits[0] == 0.0 || self.limits[1] == 0.0;
        let slack = one_way && spring == 0.0 && !self.springless;
        if !slack {
            sum = self.drag.at(rate);
            let least = if self.limits[0] == 0.0 {
                0.0
            } else {
                -self.most
            };
            let greatest = if self.limits[1] == 0.0 {
                0.0
            } else {
                self.most
            };
            let uncut = self.uncut(length - rest_length, spring);
            sum = sum.within([least, greatest], rate, [spring, uncut]);
        }
        for (stop, sign) in self.stops(length) {
            if stop.force <= 0.0 {
                continue;
            }
            // A stop cannot pull. Where damping would exceed its force, the two cancel.
            let pressed = stop.force + sign * self.stop.damping * rate;
            if pressed > 0.0 {
                sum.force += self.stop.damping * rate;
                sum.slope += self.stop.damping;
            } else {
                sum.force -= sign * stop.force;
            }
        }
        sum
    }

    /// Whether the slope jumps anywhere.
    pub(crate) fn is_bent(&self) -> bool {
        let ends = self.at_limits.iter().chain(&self.travel);
        self.spring.is_bent() || ends.into_iter().any(|x| x.is_finite())
    }

    /// Whether the force is linear between its kinks.
    pub(crate) fn is_linear_in_parts(&self) -> bool {
        let SpringForce::Polynomial { pull, push } = &self.spring else {
            return false;
        };
        let curved = [pull[1], pull[2], push[1], push[2], self.stop.progression];
        curved == [0.0; 5]
    }

    /// Bit mask of the smooth part of the law that contains a length. Between two lengths with the same mask there is no kink.
    pub(crate) fn part(&self, length: f64, rest_length: f64) -> u8 {
        let x = length - rest_length;
        let past = |condition: bool, bit: u8| u8::from(condition) << bit;
        past(self.spring.is_bent() && x < 0.0, 0)
            | past(x < self.at_limits[0], 1)
            | past(x > self.at_limits[1], 2)
            | past(length < self.travel[0], 3)
            | past(length > self.travel[1], 4)
    }

    /// Greatest slope at and between two lengths, N/m. It is sampled at both, in the middle, and at kinks of the spring.
    pub(crate) fn stiffest(&self, lengths: [f64; 2], rest_length: f64) -> f64 {
        let [low, high] = [lengths[0].min(lengths[1]), lengths[0].max(lengths[1])];
        let inner = [
            rest_length,
            rest_length + self.at_limits[0],
            rest_length + self.at_limits[1],
        ]
        .map(|length| {
            if length.is_finite() {
                // `clamp` would panic with NaN, which a motion that diverges within a step can produce.
                length.max(low).min(high)
            } else {
                low
            }
        });
        [low, 0.5 * (low + high), high]
            .into_iter()
            .chain(inner)
            .map(|length| self.elastic(length, rest_length).stiffness)
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
pub(crate) mod tests;
