//! A body may sleep only where it would really stay.
//!
//! Rapier puts a body to sleep after half a second below a speed that a slow spring never exceeds, and
//! a body at its turning point is slow too. So bodies of a component have their timers set back until
//! each has been at rest, and at the same place, for longer than a turning point lasts; and one that is
//! disturbed is woken as a whole.

use crate::backend::{Engine, Seen, Sight};
use crate::dynamics::body::Body;
use crate::scene::rows::{BodyRow, ElementRow, Members, Rest};
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

/// Whether a body moves, or has not rested long enough yet. `omega` is the natural frequency of the
/// stiffest element on it, `size` the body's.
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
    let noise = ROUNDING * omega;
    let held = row.lingers > 0.0;
    // Of what is held only its place tells: the engine's velocities are those of its last substep.
    let rest = if held { HELD_REST } else { REST };
    let slow = body.velocity.length() < rest * length_unit + noise * place
        && body.spin.length() * size < rest + noise * f32::EPSILON;
    if !slow {
        row.rests = false;
        return true;
    }
    if !row.rests {
        row.rests = true;
        row.rest = Rest {
            position,
            rotation,
            ..Rest::default()
        };
    }
    let rest = &mut row.rest;
    // Trembling may be rounding; going somewhere is not.
    let creep = if row.creeps { CREEP } else { REST };
    let strayed = rest.position.distance(position) > creep * QUIET * length_unit + ROUNDING * place
        || (rest.rotation.inverse() * rotation).xyz().length() * size > 0.5 * creep * QUIET;
    if strayed {
        row.rests = false;
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
            is_long: true,
        };
    }
    !rest.is_long
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
    /// Whether all of a component that was asleep is so still, and nothing that holds it has moved.
    pub(crate) fn is_left_alone(
        &self,
        members: &Members,
        elements: &[ElementRow],
        bodies: &[BodyRow],
        sight: &impl Sight,
    ) -> bool {
        let sleeps = |b: &usize| {
            let body = sight.see(bodies[*b].id);
            body.is_some_and(|body| body.is_asleep)
        };
        members.bodies.iter().all(sleeps)
            && !members
                .elements
                .iter()
                .any(|e| self.has_moved(&elements[*e], sight))
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
        let held = row.lingers > 0.0;
        let size = if held { sight.size(row.id) } else { 1.0 };
        let time = self.plan.time as f32;
        is_restless(row, body, size, omega, time, self.plan.length_unit)
    }

    /// A sleeping body is no wall: where the step would set it moving, it and the others wake.
    pub(crate) fn wake_the_moved(
        &self,
        rows: &[BodyRow],
        members: &[usize],
        start: &[Body],
        end: &[Body],
        engine: &mut impl Engine,
    ) {
        let bodies = || members.iter().map(|b| rows[*b].id);
        let moved = bodies()
            .zip(start.iter().zip(end))
            .any(|(body, (start, end))| {
                engine.see(body).is_some_and(|body| body.is_asleep)
                    && is_set_moving(start, end, self.plan.time, self.plan.length_unit)
            });
        if moved {
            for body in bodies() {
                engine.wake(body);
            }
        }
    }

    /// Wakes, keeps awake or lets sleep; says whether there is anything to do. `omega` is the natural
    /// frequency of the stiffest element.
    pub(crate) fn is_awake(
        &self,
        rows: &mut [BodyRow],
        members: &[usize],
        omega: f32,
        engine: &mut impl Engine,
        mut disturbed: bool,
    ) -> bool {
        let mut all_asleep = true;
        let mut restless = false;
        for b in members {
            let row = &mut rows[*b];
            let Some(body) = engine.see(row.id) else {
                continue;
            };
            disturbed |= std::mem::take(&mut row.disturbed);
            if !body.is_asleep && body.is_movable {
                all_asleep = false;
                restless |= self.is_restless(row, &body, omega, engine);
            }
        }
        if all_asleep && !disturbed {
            return false;
        }
        if disturbed || restless {
            for b in members {
                let body = rows[*b].id;
                if engine.see(body).is_some_and(|body| body.is_asleep) {
                    engine.wake(body);
                }
                engine.keep_awake(body);
            }
        }
        true
    }
}
