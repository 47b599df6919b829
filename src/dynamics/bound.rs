//! A network never has more energy than it was given.
//!
//! The coupled step keeps the energy of small motions at any stiffness; of large ones, where lines turn
//! far within a step, only to the order of the step. So the sum is watched. A surplus is taken out of the
//! motion along the elements; where there is not so much motion, the step is taken again by the implicit
//! Euler rule, moving only as far as the energy at hand allows.

use super::body::Body;
use super::element::{Element, End};
use super::energy::{Energy, take};
use super::resolution::RESOLVED;
use bevy::math::DVec3;

/// Share of kinetic and stored energy by which the sum may seem to be too large: what a step of second order
/// shows at its ends is not constant, only bounded.
const SWAY: f64 = 0.02;

/// Share of energy by which the sum may seem too large where the step does not resolve the stiffest mode: it is the
/// implicit midpoint rule there, whose ends show hardly any of that.
const UNRESOLVED_SWAY: f64 = 0.002;

/// Share of [`SWAY`] that a step may win while a surplus waits. Roundings win a thousandth of that.
const OWN: f64 = 0.1;

/// Share of what was liveliest that counts in the next step: it is forgotten in some ten seconds.
const REMEMBERED: f64 = 0.998;

/// Rounds of taking.
const ROUNDS: usize = 4;

/// What a network may have.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Bound {
    /// Energy given so far: at first what it had, then what others than its elements changed.
    given: Option<f64>,
    /// What it had at the end of the last step.
    last: f64,
    /// What it had at the start of this one.
    start: f64,
    /// Work that moving ends can have done in this step, at most.
    work: f64,
    /// The stiffest mode is not resolved.
    unresolved: bool,
    /// Most energy of motion and springs of late: what hangs has little of both where it turns back, J.
    liveliest: f64,
}

impl Bound {
    /// Sees what was done to the network since the last step.
    pub(crate) fn begin(&mut self, elements: &[Element], bodies: &[Body], perturbed: bool) {
        let (energy, rounding) = energy_and_rounding(elements, bodies);
        let power = power(elements, bodies);
        self.start(energy.sum(), rounding, power, perturbed);
    }

    /// Begins a step with the energy `now`, of which `rounding` can be noise, and the power of moving ends, W.
    pub(crate) fn start(&mut self, now: f64, rounding: f64, power: f64, perturbed: bool) {
        self.start = now;
        let change = now - self.last;
        let gift = if change.abs() < rounding || (change > 0.0 && !perturbed) {
            // Noise of the engine's f32 is neither gift nor loss, nor is it a gift that it does not arrive where it
            // was sent.
            0.0
        } else {
            change
        };
        self.given = Some(self.given.map_or(now, |given| given + gift));
        self.work = power;
    }

    /// Takes in (ω h)² of the stiffest mode.
    pub(crate) fn see(&mut self, z: f64) {
        self.unresolved = z > RESOLVED;
    }

    /// For a network whose energy is not ours to account for.
    pub(crate) fn forget(&mut self) {
        self.given = None;
    }

    /// Whether a network that ends the step with so much is within its bound.
    pub(crate) fn is_kept(&mut self, energy: &Energy, power: f64, time: f64) -> bool {
        self.work = self.work.max(power);
        self.surplus(energy, time) <= 0.0
    }

    fn surplus(&self, energy: &Energy, time: f64) -> f64 {
        let most = self.most(energy.motion + energy.stored, time);
        most.map_or(0.0, |most| energy.sum() - most)
    }

    /// Most energy that there may seem to be, with so much of it in motion and springs.
    fn most(&self, lively: f64, time: f64) -> Option<f64> {
        Some(self.given? + time * self.work + self.sway(lively))
    }

    fn sway(&self, lively: f64) -> f64 {
        let share = if self.unresolved {
            UNRESOLVED_SWAY
        } else {
            SWAY
        };
        share * lively.max(self.liveliest)
    }

    /// Takes a surplus out of the motion; returns what energy there is then, if that was enough. One that this step has not
    /// made, as roundings make in an hour, waits until there is motion along the elements: to take the step again would cost
    /// far more.
    pub(crate) fn hold(
        &mut self,
        elements: &[Element],
        bodies: &mut [Body],
        time: f64,
    ) -> Option<Energy> {
        self.work = self.work.max(power(elements, bodies));
        for _ in 0..ROUNDS {
            let energy = Energy::of(elements, bodies);
            let surplus = self.surplus(&energy, time);
            if surplus <= 0.0 {
                return Some(energy);
            }
            if !surplus.is_finite() {
                return None;
            }
            let enough =
                surplus <= energy.motion && take(elements, bodies, surplus) >= 0.01 * surplus;
            if !enough {
                let waits = self.may_wait(&energy, surplus);
                return waits.then(|| Energy::of(elements, bodies));
            }
        }
        let energy = Energy::of(elements, bodies);
        let waits = self.may_wait(&energy, self.surplus(&energy, time));
        waits.then_some(energy)
    }

    fn may_wait(&self, energy: &Energy, surplus: f64) -> bool {
        let sway = self.sway(energy.motion + energy.stored);
        surplus <= sway && energy.sum() - self.start <= OWN * sway
    }

    /// Slows all motion, about the common centre of mass where nothing else holds the network, until the
    /// bound is kept; for where the stored energy alone keeps it.
    pub(crate) fn slow(&mut self, elements: &[Element], bodies: &mut [Body], time: f64) {
        let energy = Energy::of(elements, bodies);
        let Some(most) = self.most(energy.stored, time) else {
            return;
        };
        let room = most - energy.stored - energy.place;
        if room < 0.0 {
            // Rounding has pressed it above its bound, without motion that could be taken.
            self.given = self.given.map(|given| given - room);
        }
        if energy.motion <= room || energy.motion <= 0.0 {
            return;
        }
        let held = elements
            .iter()
            .flat_map(|element| element.ends)
            .any(|end| matches!(end, End::Path(_)));
        let (mass, momentum) = bodies.iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, body| {
            (sum.0 + body.mass(), sum.1 + body.mass() * body.velocity)
        });
        let common = if held || mass.min_element() <= 0.0 {
            DVec3::ZERO
        } else {
            momentum / mass
        };
        let carried = 0.5 * (mass * common).dot(common);
        let share = ((room - carried).max(0.0) / (energy.motion - carried).max(f64::MIN_POSITIVE))
            .min(1.0)
            .sqrt();
        for body in bodies {
            let mut slowed = *body;
            slowed.velocity -= common;
            body.slow_to(&slowed, share);
            body.velocity += common;
        }
    }

    /// Whether the stored energy alone is within the bound.
    pub(crate) fn allows(&self, elements: &[Element], bodies: &[Body], time: f64) -> bool {
        let energy = Energy::of(elements, bodies);
        self.most(energy.stored, time)
            .is_none_or(|most| energy.stored + energy.place <= most)
    }

    /// Notes what energy the step ends with.
    pub(crate) fn end(&mut self, energy: &Energy, bodies: &[Body], time: f64) {
        if self.given.is_some() {
            self.finish(energy, time);
            // From the next step on what torques gave is what the bodies have.
            let torque_work: f64 = bodies.iter().map(|body| body.torque_work).sum();
            self.last += torque_work;
            self.given = self.given.map(|given| given + torque_work);
        }
    }

    /// Ends a step with such an energy.
    pub(crate) fn finish(&mut self, energy: &Energy, time: f64) {
        self.last = energy.sum();
        self.liveliest = (REMEMBERED * self.liveliest).max(energy.motion + energy.stored);
        if let Some(given) = &mut self.given {
            *given += time * self.work;
        }
    }
}

/// The energy, and how much of it rounding a step's positions and velocities to f32 can add, J.
fn energy_and_rounding(elements: &[Element], bodies: &[Body]) -> (Energy, f64) {
    let unit = f64::from(f32::EPSILON);
    let mut energy = Energy::of(&[], bodies);
    let mut rounding = 2.0 * unit * energy.motion;
    for element in elements {
        // Four substeps, two ends.
        let (length, reach) = element.distance(bodies);
        let off = 8.0 * unit * reach;
        let elastic = element.elastic(length);
        energy.stored += elastic.energy;
        rounding += off * (elastic.force.abs() + elastic.stiffness * off);
    }
    (energy, rounding)
}

/// Power of ends that something else moves, at most, W.
fn power(elements: &[Element], bodies: &[Body]) -> f64 {
    let mut sum = 0.0;
    for element in elements {
        for (i, end) in element.ends.iter().enumerate() {
            if let End::Path(path) = end
                && (path.velocity != DVec3::ZERO || path.turning != DVec3::ZERO)
                && let Some(line) = element.line(bodies)
            {
                let rate = line.motion(element, bodies, 0.0).axial;
                let speed = if line.holds[0].twist {
                    path.turning.length()
                } else {
                    end.motion(&line.holds[i], bodies).0.length()
                };
                sum += element.tension(line.length, rate).abs() * speed;
            }
        }
    }
    sum
}
