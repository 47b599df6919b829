//! Networks of every stiffness: none gains energy, and each comes to rest where statics says.

mod nets;
mod statics;

use crate::dice::{some, span};
use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use nets::{HEAVY, Net, chain, lattice, star, tensegrity};
use statics::Statics;

const PHASES: [f32; 5] = [0.3, 1.0, 3.0, 10.0, 100.0];

impl Net {
    /// Stiffness that gives a spring between two heavy bodies an ω·dt of `phase`, N/m.
    fn stiffness(phase: f32) -> f32 {
        let omega = phase / DT;
        omega * omega * HEAVY / 2.0
    }

    /// Spawns the network. `drag` is the engine's linear damping of all bodies, 1/s.
    fn build(&self, phase: f32, zeta: f32, drag: f32) -> (Lab, Vec<Entity>) {
        let k = Self::stiffness(phase);
        let c = 2.0 * zeta * (k * HEAVY / 2.0).sqrt();
        let mut lab = Lab::new();
        let bodies: Vec<Entity> = self
            .points
            .iter()
            .map(|(at, mass)| match mass {
                Some(mass) => lab.spawn((
                    body(*mass, *at),
                    Damping {
                        linear_damping: drag,
                        angular_damping: 0.0,
                    },
                )),
                None => lab.point(*at),
            })
            .collect();
        for (a, b, rest) in &self.links {
            lab.spawn(
                SpringDamper::new(bodies[*a], bodies[*b])
                    .with_stiffness(k)
                    .with_damping(c)
                    .with_rest_length(*rest),
            );
        }
        (lab, bodies)
    }

    fn places(lab: &Lab, bodies: &[Entity]) -> Vec<DVec3> {
        bodies
            .iter()
            .map(|body| lab.position(*body).as_dvec3())
            .collect()
    }

    /// Kinetic, stored and potential energy from the engine's own state, J.
    fn energy(&self, lab: &Lab, bodies: &[Entity], statics: &Statics) -> f64 {
        let mut sum = statics.energy(&Self::places(lab, bodies));
        for ((_, mass), body) in self.points.iter().zip(bodies) {
            if let Some(mass) = mass {
                let speed = f64::from(lab.velocity(*body).length());
                sum += 0.5 * f64::from(*mass) * speed * speed;
            }
        }
        sum
    }

    /// Lets the network come to rest under drag and compares it with statics. Returns the least potential energy, J.
    fn check_rest(&self, phase: f32, seconds: f64) -> f64 {
        let (mut lab, bodies) = self.build(phase, 0.1, 2.0);
        let statics = Statics::new(self, f64::from(Self::stiffness(phase)));
        // A lattice that has folded can linger near an unstable equilibrium, so it gets more time.
        for last in [false, false, false, true] {
            lab.run(seconds);
            let settled = statics.settle(Self::places(&lab, &bodies));
            let [worst, bar] = self.compare(phase, &mut lab, &bodies, &settled);
            if worst <= bar {
                return statics.energy(&settled);
            }
            assert!(!last, "{} ω·dt {phase}: {worst}", self.name);
        }
        unreachable!("the last one returns or fails")
    }

    /// Greatest error of the mean strains over the next second, and its bar.
    fn compare(&self, phase: f32, lab: &mut Lab, bodies: &[Entity], settled: &[DVec3]) -> [f64; 2] {
        let strains = |at: &[DVec3]| -> Vec<f64> {
            let strain = |(a, b, rest): &(usize, usize, f32)| {
                at[*a].distance(at[*b]) / f64::from(*rest) - 1.0
            };
            self.links.iter().map(strain).collect()
        };
        // A mean over a second, because f32 rounding keeps the stiffest networks trembling.
        let ticks = lab.ticks(1.0);
        let mut mean = vec![0.0; self.links.len()];
        for _ in 0..ticks {
            lab.tick();
            for (mean, strain) in mean.iter_mut().zip(strains(&Self::places(lab, bodies))) {
                *mean += strain / ticks as f64;
            }
        }
        let wanted = strains(settled);
        let largest = wanted.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        let (mut worst, mut far) = (0.0_f64, 0.0_f64);
        for ((mean, wanted), link) in mean.iter().zip(wanted).zip(&self.links) {
            // The engine adds to a position four times a step, and each addition can lose half a rounding. A length has
            // two positions. Trembling from these roundings adds half as much again.
            far = far.max(
                settled[link.0]
                    .abs()
                    .max(settled[link.1].abs())
                    .max_element(),
            );
            let rounding = 6.0 * f64::from(f32::EPSILON) * far / f64::from(link.2);
            worst = worst.max(((mean - wanted).abs() - rounding).max(0.0));
        }
        let masses = self.points.iter().filter_map(|(_, mass)| *mass);
        let lightest = f64::from(masses.fold(f32::MAX, f32::min)) * GRAVITY;
        let blow = f64::from(Self::stiffness(phase) * f32::EPSILON) * far;
        // Where the rounding of a position makes a force of ten times a body's weight, the body trembles for ever. There
        // the bar only asks for correct lengths.
        let bar = if blow < 10.0 * lightest {
            0.01 * largest
        } else {
            0.01
        };
        println!(
            "{}, ω·dt {phase}: at rest strains up to {largest:.2e}, error {worst:.1e} (bar {bar:.1e})",
            self.name
        );
        [worst, bar]
    }

    /// Runs without drag and asserts that the energy never rises by more than 5 %.
    fn check_energy(&self, phase: f32, zeta: f32, least: f64, seconds: f64) {
        let statics = Statics::new(self, f64::from(Self::stiffness(phase)));
        let (mut lab, bodies) = self.build(phase, zeta, 0.0);
        let first = self.energy(&lab, &bodies, &statics) - least;
        let mut highest = 0.0_f64;
        for _ in 0..lab.ticks(seconds) {
            lab.tick();
            highest = highest.max(self.energy(&lab, &bodies, &statics) - least);
        }
        let last = self.energy(&lab, &bodies, &statics) - least;
        println!(
            "{}, ω·dt {phase} ζ {zeta}: energy at most {:.4} of the first, at the end {:.4}",
            self.name,
            highest / first,
            last / first
        );
        assert!(
            highest <= 1.05 * first,
            "{} ω·dt {phase} ζ {zeta}: {highest} J of {first} J",
            self.name
        );
    }
}

/// Checks a network with several stiffnesses and dampings. `unequal` makes masses differ by one to ten thousand. `turn`
/// chooses the first stiffness, so that a run of some cases covers others in each network.
fn check(turn: usize, net: fn(bool, f32) -> Net, unequal: bool, seconds: f64) {
    let phases = PHASES.into_iter().cycle().skip(turn).take(PHASES.len());
    for phase in some(phases) {
        let net = net(unequal, phase);
        let least = net.check_rest(phase, 20.0_f64.min(seconds));
        for zeta in [0.0, 0.1] {
            net.check_energy(phase, zeta, least, span(seconds));
        }
    }
}

#[test]
fn a_chain_of_equal_masses() {
    check(0, chain, false, 60.0);
}

#[test]
fn a_chain_of_masses_one_to_ten_thousand() {
    check(1, chain, true, 60.0);
}

#[test]
fn a_star_of_equal_masses() {
    check(2, star, false, 60.0);
}

#[test]
fn a_star_with_a_hub_of_a_ten_thousandth() {
    check(3, star, true, 60.0);
}

#[test]
fn a_tensegrity_prism_of_equal_masses() {
    check(4, tensegrity, false, 60.0);
}

#[test]
fn a_tensegrity_prism_of_masses_one_to_ten_thousand() {
    check(5, tensegrity, true, 60.0);
}

#[test]
fn a_lattice_of_equal_masses() {
    check(6, lattice, false, 10.0);
}

#[test]
fn a_lattice_of_masses_one_to_ten_thousand() {
    check(7, lattice, true, 10.0);
}
