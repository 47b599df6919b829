//! Limits the energy of a network to the energy that it was given.
//!
//! The coupled step conserves the energy of small motions at any stiffness. In large motions, lines turn far within a
//! step, and the energy is only accurate to the order of the step. So the energy is checked after every step. A surplus is
//! removed from the motion along the elements. If there is not enough such motion, the step is repeated: with finer
//! micro-steps, or else by the implicit Euler rule, which moves only as far as the available energy allows.

use super::body::Body;
use super::element::{Element, End};
use super::energy::{Energy, ROUNDINGS, take};
use super::thresholds::RESOLVED;
use bevy::math::DVec3;

/// Tolerance of the energy check, as a share of kinetic and stored energy. Energy at the ends of second-order steps is not
/// constant, but oscillates within bounds. Pinned by
/// `bound::tests::energy_may_sway_by_two_per_cent_or_by_a_fifth_of_one_where_the_step_is_too_long`.
const SWAY: f64 = 0.02;

/// Tolerance of the energy check where the step does not resolve the stiffest mode, as a share of kinetic and stored
/// energy. There the step is the implicit midpoint rule, whose energy hardly oscillates. Pinned by
/// `bound::tests::energy_may_sway_by_two_per_cent_or_by_a_fifth_of_one_where_the_step_is_too_long`.
const UNRESOLVED_SWAY: f64 = 0.002;

/// Energy gain of one step up to which a surplus need not be removed yet, as a share of the tolerance. Rounding in one step
/// gains a thousandth of this limit. Pinned by `bound::tests::a_surplus_waits_only_where_the_step_itself_gained_little`.
const OWN: f64 = 0.1;

/// Factor by which [`Bound::liveliest`] decreases in each step. It falls to a third in 550 steps, which are nine seconds at
/// 60 steps per second. Pinned by `bound::tests::what_turns_back_may_sway_as_it_did_in_the_seconds_before`.
const REMEMBERED: f64 = 0.998;

/// Greatest number of attempts to remove a surplus. Pinned by
/// `energy::tests::a_surplus_is_taken_from_a_chain_at_once_though_each_element_disturbs_its_neighbours`.
const ROUNDS: usize = 4;

/// Share of a surplus that an attempt must remove. If it removes less, the motion is across the elements, and further attempts would
/// be in vain. Pinned by `bound::tests::a_surplus_waits_only_where_the_step_itself_gained_little`.
const NOTABLE: f64 = 0.01;

/// The energy that a network may have.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Bound {
    /// Energy given so far, J: the initial energy, and all changes since by anything but its elements.
    given: Option<f64>,
    /// Energy at the end of the last step, J.
    last: f64,
    /// Energy at the start of this step, J.
    start: f64,
    /// Greatest power of ends with prescribed motion in this step, W.
    work: f64,
    /// Whether the step does not resolve the stiffest mode.
    unresolved: bool,
    /// Greatest sum of kinetic and stored energy in recent steps, J. The present sum can be much less: a hanging network has
    /// little of both where it turns back.
    liveliest: f64,
}

impl Bound {
    /// Begins a step, and accounts for changes of the network since the last step.
    pub(crate) fn begin(&mut self, elements: &[Element], bodies: &[Body], perturbed: bool) {
        let (energy, rounding) = energy_and_rounding(elements, bodies);
        let power = power(elements, bodies);
        self.start(energy.sum(), rounding, power, perturbed);
    }

    /// Begins a step with the energy `now` (J), of which `rounding` can be rounding errors. `power` is that of ends with
    /// prescribed motion (W). `perturbed` says whether anything but elements may have changed the energy.
    pub(crate) fn start(&mut self, now: f64, rounding: f64, power: f64, perturbed: bool) {
        self.start = now;
        let change = now - self.last;
        let gift = if change.abs() < rounding || (change > 0.0 && !perturbed) {
            // Rounding to the engine's f32 does not count. Nor does a gain if nothing else acted on the network: then the engine
            // did not arrive exactly where it should.
            0.0
        } else {
            change
        };
        self.given = Some(self.given.map_or(now, |given| given + gift));
        self.work = power;
    }

    /// The bound itself if all its numbers are finite, otherwise that of a new network. Of a network whose bound is not finite, the
    /// energy would never be checked again, or nothing would move any more.
    pub(crate) fn if_finite(&self) -> Self {
        let numbers = [self.last, self.start, self.work, self.liveliest];
        let mut numbers = numbers.into_iter().chain(self.given);
        if numbers.all(f64::is_finite) {
            *self
        } else {
            Self::default()
        }
    }

    /// Stores whether the step resolves the stiffest mode, with (ω h)² = `z`.
    pub(crate) fn see(&mut self, z: f64) {
        self.unresolved = z > RESOLVED;
    }

    /// Forgets the given energy. The next step that is checked starts the account anew.
    pub(crate) fn forget(&mut self) {
        self.given = None;
    }

    /// Whether `energy` at the end of a step is within the bound. `power` is that of ends with prescribed motion then, W.
    pub(crate) fn is_kept(&mut self, energy: &Energy, power: f64, time: f64) -> bool {
        self.work = self.work.max(power);
        self.surplus(energy, time) <= 0.0
    }

    fn surplus(&self, energy: &Energy, time: f64) -> f64 {
        let most = self.most(energy.motion + energy.stored, time);
        most.map_or(0.0, |most| energy.sum() - most)
    }

    /// Greatest energy that passes the check if its kinetic and stored part is `lively`, J.
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

    /// Removes a surplus from the motion. Returns the energy afterwards, or `None` if the step must be repeated. A surplus
    /// that is not from this step, as rounding causes in an hour, waits until there is motion along the elements. To repeat
    /// the step would cost far more.
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
                surplus <= energy.motion && take(elements, bodies, surplus) >= NOTABLE * surplus;
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

    /// Slows all motion until the energy is within the bound. Without motion, the energy of the state must be within it. The
    /// motion of the common centre of mass is kept unless an end with prescribed motion holds the network.
    pub(crate) fn slow(&mut self, elements: &[Element], bodies: &mut [Body], time: f64) {
        let energy = Energy::of(elements, bodies);
        let Some(most) = self.most(energy.stored, time) else {
            return;
        };
        let room = most - energy.stored - energy.potential;
        if room < 0.0 {
            // Rounding has raised the energy above the bound, and there is no motion to remove.
            self.given = self.given.map(|given| given - room);
        }
        if energy.motion <= room || energy.motion <= 0.0 {
            return;
        }
        let Common {
            velocity: common,
            energy: carried,
        } = Common::of(elements, bodies);
        let share = ((room - carried).max(0.0) / (energy.motion - carried).max(f64::MIN_POSITIVE))
            .min(1.0)
            .sqrt();
        for body in bodies {
            let moved = *body;
            slow_beside(common, body, &moved, share);
        }
    }

    /// Whether the energy without motion against the common centre of mass is within the bound.
    pub(crate) fn allows(&self, elements: &[Element], bodies: &[Body], time: f64) -> bool {
        let energy = Energy::of(elements, bodies);
        let least = energy.stored + energy.potential + Common::of(elements, bodies).energy;
        self.most(energy.stored, time)
            .is_none_or(|most| least <= most)
    }

    /// Ends a step of `bodies` with an energy.
    pub(crate) fn end(&mut self, energy: &Energy, bodies: &[Body], time: f64) {
        if self.given.is_some() {
            self.finish(energy, time);
            // From the next step on, the work of torques is part of the bodies' energy.
            let torque_work: f64 = bodies.iter().map(|body| body.torque_work).sum();
            self.last += torque_work;
            self.given = self.given.map(|given| given + torque_work);
        }
    }

    /// Ends a step with an energy.
    pub(crate) fn finish(&mut self, energy: &Energy, time: f64) {
        self.last = energy.sum();
        self.liveliest = (REMEMBERED * self.liveliest).max(energy.motion + energy.stored);
        if let Some(given) = &mut self.given {
            *given += time * self.work;
        }
    }
}

/// Motion of the common centre of mass of a network, which its elements cannot change. It is zero if an end with prescribed
/// motion holds the network.
pub(super) struct Common {
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Kinetic energy, J.
    pub energy: f64,
}

impl Common {
    pub(super) fn of(elements: &[Element], bodies: &[Body]) -> Self {
        let held = elements
            .iter()
            .flat_map(|element| element.ends)
            .any(|end| end.is_path());
        let (mass, momentum) = bodies.iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, body| {
            (sum.0 + body.mass(), sum.1 + body.mass() * body.velocity)
        });
        let velocity = if held || mass.min_element() <= 0.0 {
            DVec3::ZERO
        } else {
            momentum / mass
        };
        let energy = 0.5 * (mass * velocity).dot(velocity);
        Self { velocity, energy }
    }
}

/// Gives a body `share` of the motion that `moved` has beside the `common` velocity, which stays.
pub(super) fn slow_beside(common: DVec3, body: &mut Body, moved: &Body, share: f64) {
    // A body has no share in the motion along an axis that it cannot move along.
    let free = body.inverse_mass.cmpgt(DVec3::ZERO);
    let common = DVec3::select(free, common, DVec3::ZERO);
    let mut beside = *moved;
    beside.velocity -= common;
    body.slow_to(&beside, share);
    body.velocity += common;
}

/// Returns the energy, and the energy that rounding a step's positions and velocities to f32 can add, J.
fn energy_and_rounding(elements: &[Element], bodies: &[Body]) -> (Energy, f64) {
    let unit = f64::from(f32::EPSILON);
    let mut energy = Energy::of(&[], bodies);
    let mut rounding = 2.0 * unit * energy.motion;
    for element in elements {
        let (length, reach) = element.distance(bodies);
        let off = ROUNDINGS * unit * reach;
        let elastic = element.elastic(length);
        energy.stored += elastic.energy;
        rounding += off * (elastic.force.abs() + elastic.stiffness * off);
    }
    (energy, rounding)
}

/// Greatest power of the ends with prescribed motion, W.
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

#[cfg(test)]
mod tests {
    use super::super::tests::{DT, element, point};
    use super::*;

    /// A bound of 100 J, of which all is lively.
    fn hundred(z: f64) -> Bound {
        let mut bound = Bound::default();
        bound.start(100.0, 0.0, 0.0, false);
        bound.see(z);
        bound
    }

    fn moving(motion: f64) -> Energy {
        Energy {
            motion,
            ..Energy::default()
        }
    }

    #[test]
    fn energy_may_sway_by_two_per_cent_or_by_a_fifth_of_one_where_the_step_is_too_long() {
        for (z, within, beyond) in [(1.0, 101.0, 104.0), (100.0, 100.1, 101.0)] {
            let mut bound = hundred(z);
            assert!(bound.is_kept(&moving(within), 0.0, DT), "(ω h)² {z}");
            assert!(!bound.is_kept(&moving(beyond), 0.0, DT), "(ω h)² {z}");
        }
    }

    #[test]
    fn what_turns_back_may_sway_as_it_did_in_the_seconds_before() {
        let mut bound = hundred(1.0);
        bound.finish(&moving(100.0), DT);
        let at_rest = |place: f64| Energy {
            potential: place,
            ..Energy::default()
        };
        for (steps, may) in [(60, true), (1200, false)] {
            for _ in 0..steps {
                bound.start(100.0, 0.0, 0.0, false);
                bound.finish(&at_rest(100.0), DT);
            }
            assert_eq!(bound.is_kept(&at_rest(101.0), 0.0, DT), may);
        }
    }

    #[test]
    fn a_surplus_waits_only_where_the_step_itself_gained_little() {
        let bound = hundred(1.0);
        assert!(bound.may_wait(&moving(100.1), 1.0));
        assert!(!bound.may_wait(&moving(100.5), 1.0));
    }

    #[test]
    fn what_is_slowed_stays_on_its_rail_and_keeps_its_momentum() {
        let mut cart = point(1.0, DVec3::ZERO, DVec3::ZERO);
        cart.inverse_mass.x = 0.0;
        cart.velocity = DVec3::Y * 2.0;
        let mut load = point(1.0, DVec3::X, DVec3::ZERO);
        load.velocity = DVec3::new(3.0, -2.0, 0.0);
        let mut bodies = [cart, load];
        let [a, b] = [0, 1].map(|index| End::Body {
            index,
            arm: DVec3::ZERO,
        });
        let elements = [element(a, b, 10.0, 0.0, 1.0)];
        let mut bound = Bound::default();
        bound.begin(&elements, &bodies, false);
        // The motion against each other is more than what the step began with.
        bodies[0].velocity.y = 4.0;
        bodies[1].velocity.y = -4.0;
        bound.slow(&elements, &mut bodies, 0.01);
        let [cart, load] = bodies.map(|body| body.velocity);
        assert_eq!(cart.x, 0.0, "{cart}");
        assert!((load.x - 3.0).abs() < 1e-12, "{load}");
        assert!((cart.y + load.y).abs() < 1e-12, "{cart} {load}");
        assert!(cart.y > 0.0 && cart.y < 3.0, "{cart}");
    }
}
