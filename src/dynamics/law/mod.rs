//! Force laws beyond the linear one: what an element's tension is for a length and its rate.
//!
//! All of it derives from one energy that is bounded below, and a drag that only takes: that is what the
//! integrators rely on. The spring's force is clamped between a least and a greatest one (rope, buffer, force
//! limit); stops at the ends of the travel come on top.

mod drag;
mod pieces;
mod table;

pub(crate) use drag::{Drag, DragLaw};
pub(crate) use table::Table;

use std::fmt::Debug;
use std::sync::Arc;

/// A function of a user's own: force over stretch or over rate.
pub(crate) trait Function: Send + Sync + Debug {
    fn force(&self, x: f64) -> f64;
    fn slope(&self, x: f64) -> f64;
    /// Integral of the force from 0.
    fn integral(&self, x: f64) -> f64;
}

/// Stretch beyond which a law's limit is not looked for, m. Pinned by `a_spring_that_is_beyond_its_limit_everywhere_has_the_limit`.
const FARTHEST: f64 = 1e9;

/// Tension (N) of a spring for a stretch (m), before clamps.
#[derive(Clone, Debug)]
pub(crate) enum SpringForce {
    /// Coefficients of x, x|x| and x³, for pull and for push.
    Polynomial { pull: [f64; 3], push: [f64; 3] },
    /// Over the stretch.
    Table(Arc<Table>),
    /// A user's own.
    Custom(Arc<dyn Function>),
}

/// A stop at an end of the travel: force k p (1 + progression · p) for a penetration p.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stop {
    /// N/m.
    pub stiffness: f64,
    /// 1/m.
    pub progression: f64,
    /// N s/m.
    pub damping: f64,
}

/// The whole law of one element.
#[derive(Clone, Debug)]
pub(crate) struct Law {
    spring: SpringForce,
    pub drag: DragLaw,
    /// Constant tension that is added, N.
    preload: f64,
    /// Least and greatest tension of the spring, and the stretches from where on they hold: infinite where that is nowhere, or
    /// everywhere.
    limits: [f64; 2],
    at_limits: [f64; 2],
    /// Least and greatest length before the stops, m.
    travel: [f64; 2],
    stop: Stop,
    /// Integral of the spring's force up to where it has none, which counts as no stored energy.
    reference: f64,
    /// Greatest tension of spring and damper together, N.
    most: f64,
    /// A damper alone is never slack.
    springless: bool,
}

/// What a law is made of.
#[derive(Clone, Debug)]
pub(crate) struct Recipe {
    pub spring: SpringForce,
    pub drag: DragLaw,
    pub preload: f64,
    /// Least and greatest tension of the spring: 0 on one side for ropes and buffers.
    pub limits: [f64; 2],
    pub most: f64,
    pub travel: [f64; 2],
    pub stop: Stop,
}

/// A spring's tension at a length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Elastic {
    /// N.
    pub force: f64,
    /// Its slope, N/m, not negative.
    pub stiffness: f64,
    /// Stored, J.
    pub energy: f64,
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

    /// Whether its slope leaps at zero stretch.
    fn is_bent(&self) -> bool {
        matches!(self, Self::Polynomial { pull, push } if pull[0] != push[0])
    }
}

impl Stop {
    /// Force and stored energy for a penetration.
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
    /// The law of an element without one: stiffness (N/m) and damping (N s/m).
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

    /// Spring and preload, without clamps.
    fn bare(&self, x: f64) -> Elastic {
        let mut bare = self.spring.at(x);
        bare.force += self.preload;
        bare.energy += self.preload * x;
        bare
    }

    /// The stretch at which the rising force reaches a value: −∞ where it is above it at every stretch, ∞ where it is below.
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

    /// The spring alone, clamped, its energy counted from the first point of the bare one's.
    fn spring_at(&self, x: f64) -> Elastic {
        let within = x.clamp(self.at_limits[0], self.at_limits[1]);
        if within == x {
            return self.bare(x);
        }
        // The force there is the limit but for rounding, and slack is no force at all.
        let force = self.limits[usize::from(x > within)];
        // Beyond its limit everywhere, it has no stretch from where on that holds: it stores as any constant force does.
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

    /// What the spring alone would have without its limits, where they cut its force to `cut`.
    fn uncut(&self, x: f64, cut: f64) -> f64 {
        if x > self.at_limits[1] {
            self.bare(x).force.max(cut)
        } else if x < self.at_limits[0] {
            self.bare(x).force.min(cut)
        } else {
            cut
        }
    }

    /// Tension without damping.
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

    /// The mean tension between two lengths: the one that does exactly the work of the energy.
    pub(crate) fn mean_force(&self, [from, to]: [f64; 2], rest_length: f64) -> f64 {
        if (to - from).abs() > 1e-7 * (from.abs() + to.abs()) {
            let [a, b] = [from, to].map(|length| self.elastic(length, rest_length).energy);
            (b - a) / (to - from)
        } else {
            self.elastic(0.5 * (from + to), rest_length).force
        }
    }

    /// Forces of the stops at least and at greatest length, with their signs as tensions.
    fn stops(&self, length: f64) -> [(Elastic, f64); 2] {
        [
            (self.stop.at(self.travel[0] - length), -1.0),
            (self.stop.at(length - self.travel[1]), 1.0),
        ]
    }

    /// Whether it can take energy at all.
    pub(crate) fn damps(&self) -> bool {
        self.drag.linear() != Some(0.0) || self.stop.damping > 0.0
    }

    /// Tension that damping adds.
    pub(crate) fn drag(&self, length: f64, rest_length: f64, rate: f64) -> Drag {
        let mut sum = Drag::default();
        let spring = self.spring_at(length - rest_length).force;
        // A slack rope does not damp, and no damper makes one push.
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
            // Their sum is cut, as a clutch that slips does: where the spring alone is past the limit, a damper that is weaker
            // than what it has too much changes nothing. A cut keeps order, so this never drives.
            let total = self.uncut(length - rest_length, spring) + sum.force;
            if total < least || total > greatest {
                let clamped = total.clamp(least, greatest) - spring;
                let force = if clamped * rate < 0.0 { 0.0 } else { clamped };
                sum = Drag { force, slope: 0.0 };
            }
        }
        for (stop, sign) in self.stops(length) {
            if stop.force <= 0.0 {
                continue;
            }
            // A stop holds nobody back who leaves it.
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

    /// Whether its slope leaps anywhere.
    pub(crate) fn is_bent(&self) -> bool {
        let ends = self.at_limits.iter().chain(&self.travel);
        self.spring.is_bent() || ends.into_iter().any(|x| x.is_finite())
    }

    /// Which of its smooth parts a length is in: between two lengths with the same answer nothing is kinked.
    pub(crate) fn part(&self, length: f64, rest_length: f64) -> u8 {
        let x = length - rest_length;
        let past = |condition: bool, bit: u8| u8::from(condition) << bit;
        past(self.spring.is_bent() && x < 0.0, 0)
            | past(x < self.at_limits[0], 1)
            | past(x > self.at_limits[1], 2)
            | past(length < self.travel[0], 3)
            | past(length > self.travel[1], 4)
    }

    /// Greatest slope at and between two lengths, as far as its parts show it.
    pub(crate) fn stiffest(&self, lengths: [f64; 2], rest_length: f64) -> f64 {
        let [low, high] = [lengths[0].min(lengths[1]), lengths[0].max(lengths[1])];
        let inner = [
            rest_length,
            rest_length + self.at_limits[0],
            rest_length + self.at_limits[1],
        ]
        .map(|length| {
            if length.is_finite() {
                // Unlike `clamp` it stands NaN, which a motion that diverges within a step can come to.
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
mod tests;
