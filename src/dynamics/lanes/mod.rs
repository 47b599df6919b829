//! Solves four lone elements at a time with vector instructions, from the state of their bodies to what the engine must give
//! them. The results are bitwise those of [`super::moving`] and [`super::delivery`] for each element. One element after
//! another would take longer, because each must wait for its square roots and divisions.

mod run;
mod vectors;

use super::delivery::Schedule;
use super::points::FreePoint;
use super::poles::Poles;
use super::surplus::GAIN;
use bevy::math::{DVec3, Vec3};
use pulp::{Simd, WithSimd};
use run::{Motion, Run};
pub(crate) use vectors::LANES;
use vectors::{Each, EachVector, Four, Vectors, get, put, rounding};

/// Four elements, one in each lane, and their results.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lanes {
    ends: [Ends; 2],
    /// Stiffness, N/m.
    stiffness: Each,
    /// Rest length, m.
    rest_length: Each,
    /// The fields of [`Poles`], in their order: for the micro-steps, and for the half ones of extrapolation.
    poles: [[Each; 4]; 2],
    reached: Outcome,
}

/// The points at one end of the four elements.
#[derive(Clone, Debug, Default)]
struct Ends {
    position: EachVector,
    velocity: EachVector,
    acceleration: EachVector,
    inverse_mass: Each,
}

/// Result for the four elements.
#[derive(Clone, Debug, Default)]
struct Outcome {
    direction: EachVector,
    length: Each,
    /// Energy lost, J.
    heat: Each,
    given: [Pushes; 2],
    /// Bit mask of the lanes without a special case.
    plain: u32,
}

/// What one end of the four elements must be given: velocities at the start of the step (m/s), and forces over it (N).
#[derive(Clone, Debug, Default)]
struct Pushes {
    velocity: EachVector,
    force: EachVector,
    /// Work of the point on its element, J; for points that their element does not move.
    work: Each,
}

/// Result for one element.
pub(crate) struct Way {
    pub direction: DVec3,
    pub length: f64,
    /// Energy lost, J.
    pub heat: f64,
}

/// What one end of an element must be given: a velocity at the start of the step (m/s), and a force over it (N).
pub(crate) struct EndPush {
    pub velocity: Vec3,
    pub force: Vec3,
    /// Work of the point on the element, J; for a point that the element does not move.
    pub work: f64,
}

/// The step of all four elements.
#[derive(Clone, Copy)]
pub(crate) struct Stride {
    pub schedule: Schedule,
    /// Number of micro-steps.
    pub count: u32,
    /// Whether the step is extrapolated from these micro-steps and twice as many.
    pub extrapolates: bool,
    /// The engine's cap on speeds, m/s.
    pub fastest: f64,
}

impl Lanes {
    /// Puts an element into a lane. It must have a rest length above zero and no strong damper, and the step must resolve
    /// it; see `super::micro::Micro::poles`.
    #[inline(always)]
    pub(crate) fn take_in(
        &mut self,
        lane: usize,
        points: &[FreePoint; 2],
        [stiffness, rest_length]: [f64; 2],
        poles: &[Poles; 2],
    ) {
        for (ends, point) in self.ends.iter_mut().zip(points) {
            put(&mut ends.position, lane, point.position);
            put(&mut ends.velocity, lane, point.velocity);
            put(&mut ends.acceleration, lane, point.acceleration);
            ends.inverse_mass[lane] = point.inverse_mass;
        }
        self.stiffness[lane] = stiffness;
        self.rest_length[lane] = rest_length;
        for (each, poles) in self.poles.iter_mut().zip(poles) {
            let Poles {
                restoring,
                loss,
                speed,
                skew,
            } = *poles;
            for (each, pole) in each.iter_mut().zip([restoring, loss, speed, skew]) {
                each[lane] = pole;
            }
        }
    }

    /// Returns the points of the element in a lane.
    pub(crate) fn points(&self, lane: usize) -> [FreePoint; 2] {
        self.ends.each_ref().map(|ends| FreePoint {
            position: get(&ends.position, lane),
            velocity: get(&ends.velocity, lane),
            acceleration: get(&ends.acceleration, lane),
            inverse_mass: ends.inverse_mass[lane],
        })
    }

    /// Returns the result for a lane. None for a special case that must be solved elsewhere: the ends met on the way, a
    /// body may exceed the engine's cap on speeds, the line turns too far for extrapolation, or the step gained energy.
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

    /// Returns what one end of the element in a lane must be given.
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

    /// Advances all four elements by the step, with the vector instructions of `simd`.
    #[inline(always)]
    pub(crate) fn run<S: Simd>(&mut self, simd: S, stride: &Stride) {
        let time = stride.schedule.time;
        let a = Loaded::of(simd, &self.ends[0]);
        let b = Loaded::of(simd, &self.ends[1]);
        let d = b.position.minus(a.position);
        let v = b.velocity.minus(a.velocity);
        let outside = b.acceleration.minus(a.acceleration);
        let inverse_mass = a.inverse_mass + b.inverse_mass;
        let mass = Four::all(simd, 1.0) / inverse_mass;
        let stiffness = Four::load(simd, &self.stiffness);
        let rest_length = Four::load(simd, &self.rest_length);
        let store = Store {
            half: Four::all(simd, 0.5),
            stiffness,
            rest_length,
            outside,
            mass,
        };
        let length = d.length();
        let motion = Motion {
            simd,
            time,
            outside,
            rest_length,
            square: stiffness * inverse_mass,
            rounding: rounding(simd, a.position, b.position),
        };
        let [poles, half_poles] = &self.poles;
        let mut end = Run::new(motion, stride.count, poles).go(d, v, length);
        let before = store.energy(d, v, length);
        let scale = store.scale(v, length).max(before.abs());
        let most = before + Four::all(simd, GAIN) * scale;
        let mut kept = store.energy(end.d, end.v, end.length).at_most(most);
        if stride.extrapolates {
            let fine = Run::new(motion, 2 * stride.count, half_poles);
            let turns = fine.turns_far(d, v, length);
            let fine = fine.go(d, v, length);
            kept = kept & store.energy(fine.d, fine.v, fine.length).at_most(most);
            end = fine.extrapolated(simd, &end, turns);
        }
        let heat = before - store.energy(end.d, end.v, end.length);
        // Displacement and velocity that the elements add to the free motion of the separations.
        let all_time = Four::all(simd, time);
        let drifted = v.plus(outside.times(Four::all(simd, 0.5 * time)));
        let moved = end.d.minus(d).minus(drifted.times(all_time));
        let sped = end.v.minus(v).minus(outside.times(all_time));
        let reached = &mut self.reached;
        let mut plain = kept.bits() & !end.met.bits();
        let [first, second] = &mut reached.given;
        let one = Four::all(simd, 1.0);
        plain &= a.push(simd, [moved, sped], -one, mass, stride, first);
        plain &= b.push(simd, [moved, sped], one, mass, stride, second);
        reached.direction = end.side.store();
        reached.length = end.length.store();
        reached.heat = heat.store();
        reached.plain = plain;
    }
}

/// Runs `work` with the best vector instructions of the processor that have four lanes.
pub(crate) fn widest(work: impl WithSimd<Output = ()>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return Simd::vectorize(simd, work);
    }
    work.with_simd(pulp::Scalar256b);
}

/// Constants of the elements' energies.
struct Store<S: Simd> {
    half: Four<S>,
    stiffness: Four<S>,
    rest_length: Four<S>,
    outside: Vectors<S>,
    mass: Four<S>,
}

impl<S: Simd> Store<S> {
    /// Energy about the common centres of mass, J: kinetic, stored, and potential in the external forces.
    #[inline(always)]
    fn energy(&self, d: Vectors<S>, v: Vectors<S>, length: Four<S>) -> Four<S> {
        self.stored(length) + (self.half * v.dot(v) - self.outside.dot(d)) * self.mass
    }

    /// Kinetic and stored energy, J; see `Pair::energies`.
    #[inline(always)]
    fn scale(&self, v: Vectors<S>, length: Four<S>) -> Four<S> {
        self.stored(length) + self.half * v.dot(v) * self.mass
    }

    #[inline(always)]
    fn stored(&self, length: Four<S>) -> Four<S> {
        let stretch = length - self.rest_length;
        self.half * self.stiffness * stretch * stretch
    }
}

/// The points at one end of the four elements, loaded as vectors.
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

    /// Computes the pushes of the points if the elements add the displacement `moved` and the velocity `sped` to the free
    /// motion of the separations. `sign` is −1 at end A and 1 at end B, `mass` the effective mass of each pair. A point's
    /// share is its inverse mass times `mass`. Returns the bit mask of the lanes in which the points certainly stay below the
    /// engine's cap on speeds. See `is_within` and [`Schedule::reach`].
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
        let time = Four::all(simd, schedule.time);
        let per_time = Four::all(simd, schedule.per_time);
        let pulled = self.acceleration.times(time);
        let straight = self.velocity.plus(pulled.times(Four::all(simd, 0.5)));
        let moved = straight.times(time).plus(moved);
        let reached = self.velocity.plus(pulled).plus(sped);
        let displacement = moved.minus(self.velocity.times(time));
        let change = reached.minus(self.velocity);
        let (reach, per_rest) = schedule.spread();
        let jump = displacement.minus(change.times(Four::all(simd, reach)));
        let jump = jump.times(Four::all(simd, per_rest));
        let rate = change.minus(jump).times(per_time);
        let begun = self.velocity.plus(jump);
        // If the speed at the start and the gain are at most a third of the cap each, the cap is never reached. Other lanes
        // are special cases and checked exactly elsewhere, and so are lanes with NaN.
        let third = Four::all(simd, fastest * fastest / 9.0);
        let gain = rate.times(time);
        let slow = begun.dot(begun).at_most(third) & gain.dot(gain).at_most(third);
        // The cap does not matter for points that the elements do not move.
        let still = self.inverse_mass.at_most(Four::all(simd, 0.0));
        let given = begun.rounded();
        // The engine stores velocities in single precision. The force corrects the rounding error.
        let rate = rate.plus(begun.minus(given).times(per_time));
        let mass = Four::all(simd, 1.0) / self.inverse_mass;
        let force = rate.minus(self.acceleration).times(mass);
        pushes.velocity = given.store();
        pushes.force = force.store();
        (slow | still).bits()
    }
}
