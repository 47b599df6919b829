//! A body may sleep only where it would really stay.
//!
//! Rapier puts a body to sleep after half a second below a speed that a slow spring never exceeds, and
//! a body at its turning point is slow too. So bodies of a component have their timers set back until
//! each has been at rest, and at the same place, for longer than a turning point lasts; and one that is
//! disturbed is woken as a whole.

use crate::backend::{Engine, Seen, Sight};
use crate::dynamics::body::Body;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow, Members, Rest, Rows, RowsMut, take};
use crate::scene::step::Step;

/// Speed (m/s, rad/s; times the engine's length unit) that counts as rest.
const REST: f32 = 2e-4;

/// Speed that counts as rest of what contacts or joints hold, m/s. Pinned by `ground::heap`.
const HELD_REST: f32 = 2e-2;

/// Speed at which a body counts as resting that contacts press, or that hangs in balance between such bodies: under a
/// lasting side load Rapier's friction lets them creep on for ever. Pinned by `ground::heap`.
const CREEP: f32 = 1e-2;

/// How long it has to last, s. At a turning point of amplitude A and frequency ω it lasts
/// 2·REST/(A ω²), so what falls asleep has accelerations below REST·2/QUIET.
const QUIET: f32 = 2.0;

/// Rounding of a position that is not motion, in units of its last place: a stiff spring answers each
/// of them with a speed of ω times that.
const ROUNDING: f32 = 4.0;

/// Whether a body is so slow that it may rest. `omega` is the natural frequency of the stiffest element on it, `size` the body's.
fn is_slow(body: &Seen, rest: f32, size: f32, omega: f32, length_unit: f32) -> bool {
    let place = body.origin.abs().max_element() * f32::EPSILON;
    let noise = ROUNDING * omega;
    body.velocity.length() < rest * length_unit + noise * place
        && body.spin.length() * size < rest + noise * f32::EPSILON
}

/// Whether a body moves, or has not rested long enough yet.
fn is_restless(
    row: &mut BodyRow,
    body: &Seen,
    size: f32,
    omega: f32,
    time: f32,
    length_unit: f32,
) -> bool {
    let (position, rotation) = (body.origin, body.rotation);
    let place = position.abs().max_element() * f32::EPSILON;
    // Of what is held only its place tells: the engine's velocities are those of its last substep.
    let rest = if row.has(BodyFlags::LINGERS) {
        HELD_REST
    } else {
        REST
    };
    let slow = is_slow(body, rest, size, omega, length_unit);
    if !slow {
        row.flags.remove(BodyFlags::RESTS);
        return true;
    }
    if !row.has(BodyFlags::RESTS) {
        row.flags.insert(BodyFlags::RESTS);
        row.flags.remove(BodyFlags::RESTS_LONG);
        row.rare.rest = Rest {
            position,
            rotation,
            ..Rest::default()
        };
    }
    // Trembling may be rounding; going somewhere is not.
    let creep = if row.has(BodyFlags::CREEPS) {
        CREEP
    } else {
        REST
    };
    let rest = &mut row.rare.rest;
    let strayed = rest.position.distance(position) > creep * QUIET * length_unit + ROUNDING * place
        || (rest.rotation.inverse() * rotation).xyz().length() * size > 0.5 * creep * QUIET;
    if strayed {
        row.flags.remove(BodyFlags::RESTS);
        return true;
    }
    rest.seconds += time;
    rest.rate = rest.position.distance(position) / rest.seconds;
    if rest.seconds >= QUIET {
        // Others may have to come to rest yet: what has gone far in many such spans has not moved in any.
        *rest = Rest {
            position,
            rotation,
            seconds: 0.0,
            rate: rest.rate,
        };
        row.flags.insert(BodyFlags::RESTS_LONG);
    }
    !row.has(BodyFlags::RESTS_LONG)
}

/// Whether a step would set a sleeping body moving: an acceleration that within a second is not rest.
fn is_set_moving(start: &Body, end: &Body, time: f64, length_unit: f32) -> bool {
    let rest = f64::from(REST) * time;
    (end.velocity - start.velocity).length() > rest * f64::from(length_unit)
        || (end.angular_velocity() - start.angular_velocity()).length() > rest
}

/// Natural frequency of an element on its own ends, as of the last step.
pub(crate) fn omega_of(row: &ElementRow) -> f32 {
    (row.slope() * row.inverse_mass).sqrt() as f32
}

impl Step {
    /// Whether a body may be so slow that it rests, from the square of its speed, the largest coordinate of its place and the
    /// square of its elements' natural frequency; [`Self::is_restless`] knows. Free of roots, for it is asked of every body.
    #[inline(always)]
    pub(crate) fn may_rest(&self, speed_square: f32, place: f32, omega_square: f32) -> bool {
        let rest = REST * self.plan.length_unit;
        let noise = ROUNDING * place * f32::EPSILON;
        // (a + b)² is at most 2 (a² + b²).
        speed_square < 2.0 * (rest * rest + omega_square * noise * noise)
    }

    /// Whether all of a component that was asleep is so still, and nothing that holds it has moved.
    pub(crate) fn is_left_alone(
        &self,
        members: &Members,
        elements: &(impl Rows<ElementRow> + ?Sized),
        bodies: &(impl Rows<BodyRow> + ?Sized),
        sight: &impl Sight,
    ) -> bool {
        let sleeps = |b: &u32| sight.is_asleep(bodies[*b as usize].id);
        members.bodies.iter().all(sleeps)
            && !members
                .elements
                .iter()
                .any(|e| self.has_moved(&elements[*e as usize], sight))
    }

    /// Whether a body that is awake moves, or has not rested long enough yet.
    pub(crate) fn is_restless(
        &self,
        row: &mut BodyRow,
        body: &Seen,
        omega: f32,
        sight: &impl Sight,
    ) -> bool {
        // A small body that turns in what holds it does not go far by that.
        let held = row.has(BodyFlags::LINGERS);
        let size = if held { sight.size(row.id) } else { 1.0 };
        let time = self.plan.time as f32;
        is_restless(row, body, size, omega, time, self.plan.length_unit)
    }

    /// A sleeping body is no wall: where the step would set it moving, it and the others wake.
    pub(crate) fn wake_the_moved(
        &self,
        rows: &[BodyRow],
        members: &[u32],
        start: &[Body],
        end: &[Body],
        engine: &mut impl Engine,
    ) {
        let bodies = || members.iter().map(|b| rows[*b as usize].id);
        let moved = bodies()
            .zip(start.iter().zip(end))
            .any(|(body, (start, end))| {
                engine.is_asleep(body)
                    && is_set_moving(start, end, self.plan.time, self.plan.length_unit)
            });
        if moved {
            for body in bodies() {
                engine.wake(body);
            }
        }
    }

    /// Whether there is anything to do for a component, and whether all its bodies are to be [roused](rouse). `omega` is the
    /// natural frequency of the stiffest element.
    pub(crate) fn is_awake(
        &self,
        rows: &mut (impl RowsMut<BodyRow> + ?Sized),
        members: &[u32],
        omega: f32,
        sight: &impl Sight,
        mut disturbed: bool,
    ) -> (bool, bool) {
        let mut all_asleep = true;
        let mut restless = false;
        for b in members {
            let row = &mut rows[*b as usize];
            let Some(body) = sight.see(row.id) else {
                continue;
            };
            disturbed |= take!(row.flags, BodyFlags::DISTURBED);
            if !body.is_asleep && body.is_movable {
                all_asleep = false;
                restless |= self.is_restless(row, &body, omega, sight);
            }
        }
        let awake = !all_asleep || disturbed;
        (awake, awake && (disturbed || restless))
    }
}

/// Wakes the bodies of a component, or keeps them awake.
pub(crate) fn rouse(rows: &[BodyRow], members: &[u32], engine: &mut impl Engine) {
    for b in members {
        let body = rows[*b as usize].id;
        if engine.is_asleep(body) {
            engine.wake(body);
        }
        engine.keep_awake(body);
    }
}
