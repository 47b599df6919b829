//! Four lone elements at a time, from their bodies' places to what these are to be given: to the last bit what
//! [`super::moving`] and [`super::delivery`] make of each. One after the other they would wait for their roots and divisions.

mod run;
mod vectors;

use super::delivery::Schedule;
use super::points::FreePoint;
use super::poles::Poles;
use bevy::math::{DVec3, Vec3};
use pulp::{Simd, WithSimd};
use run::Run;
pub(crate) use vectors::LANES;
use vectors::{Each, EachVector, Four, Vectors, get, put, rounding};

/// Numbers of four elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    ends: [Ends; 2],
    /// N/m.
    stiffness: Each,
    /// m.
    rest_length: Each,
    poles: [Each; 4],
    reached: Outcome,
}

/// Four points at one end of them each.
#[derive(Clone, Debug, Default)]
struct Ends {
    position: EachVector,
    velocity: EachVector,
    acceleration: EachVector,
    inverse_mass: Each,
}

/// What has become of the four.
#[derive(Clone, Debug, Default)]
struct Outcome {
    direction: EachVector,
    length: Each,
    /// Energy lost, J.
    heat: Each,
    given: [Pushes; 2],
    /// Lanes in which nothing special was met, bit by bit.
    plain: u32,
}

/// What four ends are to be given: a velocity at the start of the step, and a force over it.
#[derive(Clone, Debug, Default)]
struct Pushes {
    velocity: EachVector,
    force: EachVector,
    /// Work of the point on its element, where that does not move it, J.
    work: Each,
}

/// What has become of one.
pub(crate) struct Way {
    pub direction: DVec3,
    pub length: f64,
    /// Energy lost, J.
    pub heat: f64,
}

/// What one of its ends is to be given.
pub(crate) struct EndPush {
    pub velocity: Vec3,
    pub force: Vec3,
    /// Work of the point on the element, where that does not move it, J.
    pub work: f64,
}

/// The step that all four take.
#[derive(Clone, Copy)]
pub(crate) struct Stride {
    pub schedule: Schedule,
    /// Micro-steps.
    pub count: u32,
    /// The engine's cap on speeds, m/s.
    pub fastest: f64,
}

impl Lanes {
    /// Takes one in. It has a rest length above zero, its step is resolved and no strong damper in it: see
    /// `plain_poles`.
    #[inline(always)]
    pub(crate) fn take_in(
        &mut self,
        lane: usize,
        points: &[FreePoint; 2],
        [stiffness, rest_length]: [f64; 2],
        poles: &Poles,
    ) {
        for (ends, point) in self.ends.iter_mut().zip(points) {
            put(&mut ends.position, lane, point.position);
            put(&mut ends.velocity, lane, point.velocity);
            put(&mut ends.acceleration, lane, point.acceleration);
            ends.inverse_mass[lane] = point.inverse_mass;
        }
        self.stiffness[lane] = stiffness;
        self.rest_length[lane] = rest_length;
        let Poles {
            restoring,
            loss,
            speed,
            skew,
        } = *poles;
        let poles = [restoring, loss, speed, skew];
        for (each, pole) in self.poles.iter_mut().zip(poles) {
            each[lane] = pole;
        }
    }

    /// The points that were taken in.
    pub(crate) fn points(&self, lane: usize) -> [FreePoint; 2] {
        self.ends.each_ref().map(|ends| FreePoint {
            position: get(&ends.position, lane),
            velocity: get(&ends.velocity, lane),
            acceleration: get(&ends.acceleration, lane),
            inverse_mass: ends.inverse_mass[lane],
        })
    }

    /// What has become of one; none if that is not for here: its ends met on the way, or the engine would not fly a body so
    /// fast.
    #[inline(always)]
    pub(crate) fn way(&self, lane: usize) -> Option<Way> {
        let Outcome {
            direction,
            length,
            heat,
            plain,
            ..
        } = &self.reached;
        (plain & (1 << lane) != 0).then(|| Way {
            direction: get(direction, lane),
            length: length[lane],
            heat: heat[lane],
        })
    }

    /// What one of its ends is to be given.
    #[inline(always)]
    pub(crate) fn push(&self, lane: usize, end: usize) -> EndPush {
        let Pushes {
            velocity,
            force,
            work,
        } = &self.reached.given[end];
        EndPush {
            velocity: get(velocity, lane).as_vec3(),
            force: get(force, lane).as_vec3(),
            work: work[lane],
        }
    }

    /// Takes all of them over the step, with what reckons with vectors.
    #[inline(always)]
    pub(crate) fn run<S: Simd>(&mut self, simd: S, stride: &Stride) {
        let time = stride.schedule.time;
        let all = |number| Four::all(simd, number);
        let [a, b] = [
            Loaded::of(simd, &self.ends[0]),
            Loaded::of(simd, &self.ends[1]),
        ];
        let d = b.position.minus(a.position);
        let v = b.velocity.minus(a.velocity);
        let outside = b.acceleration.minus(a.acceleration);
        let inverse_mass = a.inverse_mass + b.inverse_mass;
        let mass = all(1.0) / inverse_mass;
        let stiffness = Four::load(simd, &self.stiffness);
        let rest_length = Four::load(simd, &self.rest_length);
        let store = Store {
            half: all(0.5),
            stiffness,
            rest_length,
            outside,
            mass,
        };
        let length = d.length();
        let run = Run {
            simd,
            step: time / f64::from(stride.count),
            count: stride.count,
            outside,
            rest_length,
            square: stiffness * inverse_mass,
            poles: self.poles.each_ref().map(|pole| Four::load(simd, pole)),
            rounding: rounding(simd, a.position, b.position),
        };
        let end = run.go(d, v, length);
        let heat = store.energy(d, v, length) - store.energy(end.d, end.v, end.length);
        // What the element adds to the free motion of the separation.
        let all_time = all(time);
        let drifted = v.plus(outside.times(all(0.5 * time)));
        let moved = end.d.minus(d).minus(drifted.times(all_time));
        let sped = end.v.minus(v).minus(outside.times(all_time));
        let reached = &mut self.reached;
        let mut plain = !end.met.bits();
        let [first, second] = &mut reached.given;
        plain &= a.push(simd, [moved, sped], all(-1.0), mass, stride, first);
        plain &= b.push(simd, [moved, sped], all(1.0), mass, stride, second);
        reached.direction = end.side.store();
        reached.length = end.length.store();
        reached.heat = heat.store();
        reached.plain = plain;
    }
}

/// Does work with the widest vectors that the processor has, of those that have four lanes.
pub(crate) fn widest(work: impl WithSimd<Output = ()>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return Simd::vectorize(simd, work);
    }
    work.with_simd(pulp::Scalar256b);
}

/// What tells energies.
struct Store<S: Simd> {
    half: Four<S>,
    stiffness: Four<S>,
    rest_length: Four<S>,
    outside: Vectors<S>,
    mass: Four<S>,
}

impl<S: Simd> Store<S> {
    /// Of the motion about the common centres of mass, in the outside forces, and stored, J.
    #[inline(always)]
    fn energy(&self, d: Vectors<S>, v: Vectors<S>, length: Four<S>) -> Four<S> {
        let stretch = length - self.rest_length;
        let stored = self.half * self.stiffness * stretch * stretch;
        stored + (self.half * v.dot(v) - self.outside.dot(d)) * self.mass
    }
}

/// Four points at one end.
#[derive(Clone, Copy)]
struct Loaded<S: Simd> {
    position: Vectors<S>,
    velocity: Vectors<S>,
    acceleration: Vectors<S>,
    inverse_mass: Four<S>,
}

impl<S: Simd> Loaded<S> {
    #[inline(always)]
    fn of(simd: S, ends: &Ends) -> Self {
        Self {
            position: Vectors::load(simd, &ends.position),
            velocity: Vectors::load(simd, &ends.velocity),
            acceleration: Vectors::load(simd, &ends.acceleration),
            inverse_mass: Four::load(simd, &ends.inverse_mass),
        }
    }

    /// What takes them along, if elements add so much to the free motion of the separation, and how fast that is then. This
    /// end's share goes by its mass, with a sign; `mass` is that of the pair. Returns the lanes in which they stay slower than
    /// the engine lets them, bit by bit. See `is_within` and [`Schedule::reach`].
    #[inline(always)]
    fn push(
        &self,
        simd: S,
        [moved, sped]: [Vectors<S>; 2],
        sign: Four<S>,
        mass: Four<S>,
        stride: &Stride,
        pushes: &mut Pushes,
    ) -> u32 {
        pushes.work = sped.times(sign * mass).dot(self.velocity).store();
        let share = sign * self.inverse_mass * mass;
        let (moved, sped) = (moved.times(share), sped.times(share));
        let Stride {
            schedule, fastest, ..
        } = stride;
        let all = |number| Four::all(simd, number);
        let time = all(schedule.time);
        let pulled = self.acceleration.times(time);
        let straight = self.velocity.plus(pulled.times(all(0.5)));
        let moved = straight.times(time).plus(moved);
        let reached = self.velocity.plus(pulled).plus(sped);
        let displacement = moved.minus(self.velocity.times(time));
        let change = reached.minus(self.velocity);
        let (reach, per_rest) = schedule.spread();
        let jump = displacement.minus(change.times(all(reach)));
        let jump = jump.times(all(per_rest));
        let rate = change.minus(jump).times(all(schedule.per_time));
        let begun = self.velocity.plus(jump);
        // With a third of the cap at the start, and no more than that to gain, it is not met anywhere; else it is looked at
        // more closely elsewhere. Four that are none are beyond it too.
        let third = all(fastest * fastest / 9.0);
        let gain = rate.times(time);
        let slow = begun.dot(begun).at_most(third) & gain.dot(gain).at_most(third);
        // What nothing moves here, nothing flies too fast.
        let still = self.inverse_mass.at_most(all(0.0));
        let given = begun.rounded();
        // The engine's velocity is rounded; the force makes up for it.
        let rate = rate.plus(begun.minus(given).times(all(schedule.per_time)));
        let mass = all(1.0) / self.inverse_mass;
        let force = rate.minus(self.acceleration).times(mass);
        pushes.velocity = given.store();
        pushes.force = force.store();
        (slow | still).bits()
    }
}
