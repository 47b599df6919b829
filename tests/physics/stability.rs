//! Does any network of any stiffness gain energy, and does it come to rest where statics says?

use crate::harness::*;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_coilover::prelude::*;
use bevy_rapier3d::prelude::*;
use nalgebra::{DMatrix, DVector};

/// A network as drawn: bodies with masses (kg, none for a fixed point), and links with rest lengths.
struct Net {
    name: &'static str,
    points: Vec<(Vec3, Option<f32>)>,
    links: Vec<(usize, usize, f32)>,
}

const HEAVY: f32 = 1.0;

/// Mass of the i-th body: all alike, or every other one ten thousand times lighter.
fn mass(i: usize, unequal: bool) -> Option<f32> {
    Some(if unequal && i % 2 == 1 {
        1e-4 * HEAVY
    } else {
        HEAVY
    })
}

/// Twenty springs in a zigzag between two hooks, let go without strain: they fall, whip and swing.
fn chain(unequal: bool, _: f32) -> Net {
    let n = 20;
    let points: Vec<_> = (0..=n)
        .map(|i| {
            let held = i == 0 || i == n;
            let mass = (!held).then(|| mass(i, unequal)).flatten();
            let up = if i % 2 == 1 { 0.23 } else { 0.0 };
            (Vec3::new(0.5 * i as f32, up, 0.0), mass)
        })
        .collect();
    let length = points[0].0.distance(points[1].0);
    Net {
        name: "chain of 20",
        points,
        links: (0..n).map(|i| (i, i + 1, length)).collect(),
    }
}

/// A cube of 6 × 6 × 6 bodies hung at the four corners of its top.
fn lattice(unequal: bool, _: f32) -> Net {
    let n = 6;
    let index = |x: usize, y: usize, z: usize| (x * n + y) * n + z;
    let (mut points, mut links) = (Vec::new(), Vec::new());
    for x in 0..n {
        for y in 0..n {
            for z in 0..n {
                let corner = y == n - 1 && (x == 0 || x == n - 1) && (z == 0 || z == n - 1);
                let own = (!corner).then(|| mass(x + y + z, unequal)).flatten();
                points.push((Vec3::new(x as f32, y as f32, z as f32), own));
                let here = index(x, y, z);
                for (nx, ny, nz) in [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)] {
                    if nx < n && ny < n && nz < n {
                        links.push((here, index(nx, ny, nz), 1.0));
                    }
                }
            }
        }
    }
    Net {
        name: "lattice 6×6×6",
        points,
        links,
    }
}

/// A hub held all round by fifty spokes in tension, each with a weight in its middle; the hub is let go a
/// little off its place. The stiffer, the less, so that speeds stay below the engine's cap.
fn star(unequal: bool, phase: f32) -> Net {
    let n = 50;
    let strain = 0.02 / phase;
    let hub = if unequal { 1e-4 * HEAVY } else { HEAVY };
    let mut points = vec![(Vec3::new(2.0, 1.0, 0.0) * strain, Some(hub))];
    let mut links = Vec::new();
    for i in 0..n {
        // A spiral from pole to pole.
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / n as f32;
        let around = 2.4 * i as f32;
        let r = (1.0 - y * y).sqrt();
        let direction = Vec3::new(r * around.cos(), y, r * around.sin());
        let at = points.len();
        points.extend([(direction, Some(HEAVY)), (2.0 * direction, None)]);
        links.extend([(0, at, 1.0 - strain), (at, at + 1, 1.0 - strain)]);
    }
    Net {
        name: "star of 50",
        points,
        links,
    }
}

/// Three struts that do not touch and six cables on three fixed feet: a twisted prism under its own
/// tension, let go a little off its place.
fn tensegrity(unequal: bool, phase: f32) -> Net {
    let strain = 0.02 / phase;
    let ring = |y: f32, turn: f32| {
        (0..3).map(move |i| {
            let angle = turn + std::f32::consts::TAU / 3.0 * i as f32;
            Vec3::new(angle.cos(), y, angle.sin())
        })
    };
    let mut points: Vec<(Vec3, Option<f32>)> = ring(0.0, 0.0).map(|p| (p, None)).collect();
    // Turned by 150° against the bottom the prism holds itself.
    let top = ring(1.5, 150.0_f32.to_radians());
    points.extend(top.enumerate().map(|(i, p)| (p, mass(i, unequal))));
    let mut links = Vec::new();
    for i in 0..3 {
        let (own, next) = (3 + i, 3 + (i + 1) % 3);
        // The cable of the top, the slanting one, and the strut.
        for (a, b, part) in [
            (own, next, 1.0 - strain),
            (i, next, 1.0 - strain),
            (i, own, 1.0 + strain),
        ] {
            links.push((a, b, part * points[a].0.distance(points[b].0)));
        }
    }
    for point in &mut points[3..] {
        point.0 += Vec3::new(0.5, 0.3, -0.2) * strain;
    }
    Net {
        name: "tensegrity prism",
        points,
        links,
    }
}

/// Potential energy of springs and weight, with everything else that a minimiser needs.
struct Statics<'a> {
    net: &'a Net,
    k: f64,
    /// Index among the unknowns of each point that can move.
    slots: Vec<Option<usize>>,
    unknowns: usize,
}

impl<'a> Statics<'a> {
    fn new(net: &'a Net, k: f64) -> Self {
        let mut unknowns = 0;
        let slots = net
            .points
            .iter()
            .map(|(_, mass)| {
                mass.map(|_| {
                    unknowns += 3;
                    unknowns - 3
                })
            })
            .collect();
        Self {
            net,
            k,
            slots,
            unknowns,
        }
    }

    fn energy(&self, at: &[DVec3]) -> f64 {
        let mut sum = 0.0;
        for ((_, mass), at) in self.net.points.iter().zip(at) {
            sum += f64::from(mass.unwrap_or(0.0)) * GRAVITY * at.y;
        }
        for (a, b, rest) in &self.net.links {
            let stretch = at[*a].distance(at[*b]) - f64::from(*rest);
            sum += 0.5 * self.k * stretch * stretch;
        }
        sum
    }

    /// Newton's method from `at`, kept to descent by a multiple of the identity.
    fn settle(&self, mut at: Vec<DVec3>) -> Vec<DVec3> {
        let mut shift = 1e-3 * self.k;
        for _ in 0..400 {
            let mut gradient = DVector::zeros(self.unknowns);
            let mut hessian = DMatrix::identity(self.unknowns, self.unknowns) * shift;
            for (slot, (_, mass)) in self.slots.iter().zip(&self.net.points) {
                if let (Some(slot), Some(mass)) = (slot, mass) {
                    gradient[slot + 1] += f64::from(*mass) * GRAVITY;
                }
            }
            for (a, b, rest) in &self.net.links {
                let d = at[*b] - at[*a];
                let (length, u) = (d.length(), d.normalize());
                let tension = self.k * (length - f64::from(*rest));
                let lateral = tension / length;
                for (end, sign) in [(*a, -1.0), (*b, 1.0)] {
                    let Some(row) = self.slots[end] else { continue };
                    for r in 0..3 {
                        gradient[row + r] += sign * tension * u[r];
                        for (other, other_sign) in [(*a, -1.0), (*b, 1.0)] {
                            let Some(column) = self.slots[other] else {
                                continue;
                            };
                            for c in 0..3 {
                                let own = if r == c { lateral } else { 0.0 };
                                hessian[(row + r, column + c)] +=
                                    sign * other_sign * ((self.k - lateral) * u[r] * u[c] + own);
                            }
                        }
                    }
                }
            }
            let Some(factor) = hessian.cholesky() else {
                shift *= 10.0;
                continue;
            };
            let step = factor.solve(&gradient);
            let tried: Vec<DVec3> = at
                .iter()
                .zip(&self.slots)
                .map(|(at, slot)| {
                    slot.map_or(*at, |s| *at - DVec3::new(step[s], step[s + 1], step[s + 2]))
                })
                .collect();
            if self.energy(&tried) <= self.energy(&at) {
                at = tried;
                shift = (shift * 0.3).max(1e-12 * self.k);
                if step.amax() < 1e-13 {
                    break;
                }
            } else {
                shift = (shift * 10.0).max(1e-9 * self.k);
            }
        }
        at
    }
}

const PHASES: [f32; 5] = [0.3, 1.0, 3.0, 10.0, 100.0];

impl Net {
    /// Stiffness for a phase per step of one spring between two heavy bodies.
    fn stiffness(phase: f32) -> f32 {
        let omega = phase / DT;
        omega * omega * HEAVY / 2.0
    }

    /// The scene; `drag` is the engine's own damping of all bodies.
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

    /// Kinetic, stored and gravity's energy, from the engine's own state.
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

    /// Comes to rest under drag, and compares with statics; returns the least energy.
    fn check_rest(&self, phase: f32, seconds: f64) -> f64 {
        let (mut lab, bodies) = self.build(phase, 0.1, 2.0);
        lab.run(seconds);
        let statics = Statics::new(self, f64::from(Self::stiffness(phase)));
        let settled = statics.settle(Self::places(&lab, &bodies));
        let strains = |at: &[DVec3]| -> Vec<f64> {
            let strain = |(a, b, rest): &(usize, usize, f32)| {
                at[*a].distance(at[*b]) / f64::from(*rest) - 1.0
            };
            self.links.iter().map(strain).collect()
        };
        // The mean of a second: the roundings of f32 keep the stiffest trembling.
        let ticks = lab.ticks(1.0);
        let mut mean = vec![0.0; self.links.len()];
        for _ in 0..ticks {
            lab.tick();
            for (mean, strain) in mean.iter_mut().zip(strains(&Self::places(&lab, &bodies))) {
                *mean += strain / ticks as f64;
            }
        }
        let wanted = strains(&settled);
        let largest = wanted.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
        let (mut worst, mut far) = (0.0_f64, 0.0_f64);
        for ((mean, wanted), link) in mean.iter().zip(wanted).zip(&self.links) {
            // The engine adds to a position four times a step, and half a rounding can be lost each time;
            // a length has two positions; half as much again for the trembling that comes of it.
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
        // A rounding of a position that is a blow of ten times a body's weight keeps it trembling for
        // ever; there all that can be asked is that lengths are right.
        let bar = if blow < 10.0 * lightest {
            0.01 * largest
        } else {
            0.01
        };
        println!(
            "{}, ω·dt {phase}: at rest strains up to {largest:.2e}, error {worst:.1e} (bar {bar:.1e})",
            self.name
        );
        assert!(worst <= bar, "{} ω·dt {phase}: {worst}", self.name);
        statics.energy(&settled)
    }

    /// Runs free and watches the energy.
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

/// Every stiffness and damping, with equal masses or one to ten thousand.
fn check(net: fn(bool, f32) -> Net, unequal: bool, seconds: f64) {
    for phase in PHASES {
        let net = net(unequal, phase);
        let least = net.check_rest(phase, 20.0_f64.min(seconds));
        for zeta in [0.0, 0.1] {
            net.check_energy(phase, zeta, least, seconds);
        }
    }
}

#[test]
fn a_chain_of_equal_masses() {
    check(chain, false, 60.0);
}

#[test]
fn a_chain_of_masses_one_to_ten_thousand() {
    check(chain, true, 60.0);
}

#[test]
fn a_star_of_equal_masses() {
    check(star, false, 60.0);
}

#[test]
fn a_star_with_a_hub_of_a_ten_thousandth() {
    check(star, true, 60.0);
}

#[test]
fn a_tensegrity_prism_of_equal_masses() {
    check(tensegrity, false, 60.0);
}

#[test]
fn a_tensegrity_prism_of_masses_one_to_ten_thousand() {
    check(tensegrity, true, 60.0);
}

#[test]
fn a_lattice_of_equal_masses() {
    check(lattice, false, 10.0);
}

#[test]
fn a_lattice_of_masses_one_to_ten_thousand() {
    check(lattice, true, 10.0);
}
