//! Decides when bodies of a component may fall asleep: only where they would really stay.
//!
//! Rapier puts a body to sleep after half a second below a certain speed. A slow spring never exceeds that speed, and a body at
//! its turning point is slow, too. So the sleep timers of a component's bodies are reset until each body has rested at the same
//! place for longer than a turning point lasts. If a component is disturbed, all its bodies are woken.

use crate::backend::{Engine, Seen, Sight};
use crate::dynamics::body::Body;
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow, Members, Rest, Rows, RowsMut, take};
use crate::scene::step::Step;
use bevy::math::Quat;

/// Speed below which a body counts as resting: m/s, times the engine's length unit, and rad/s. With ten times as much, slow swings
/// fall asleep. Pinned by `sleeping::a_long_pendulum_on_a_stiff_spring_does_not_fall_asleep_at_its_turning_point`.
const REST: f32 = 2e-4;

/// Speed below which a body of a component that the engine solves counts as resting, m/s, times the engine's length unit. Pinned by
/// `ground::heap` and `ground::between_planks`.
const HELD_REST: f32 = 2e-2;

/// Mean speed up to which a body with [`BodyFlags::CREEPS`] counts as resting, m/s, times the engine's length unit. Contacts
/// press such a body, or springs in balance or joints make it follow such bodies. Under a lasting side load, Rapier's friction
/// lets these bodies creep for ever. Pinned by `ground::heap`.
const CREEP: f32 = 1e-2;

/// Time for which a body must rest before it may sleep, s. At a turning point with amplitude A and frequency ω a body rests for
/// 2·REST/(A ω²), so a body that falls asleep has an acceleration below 2·REST/QUIET. Pinned by
/// `sleeping::a_long_pendulum_on_a_stiff_spring_does_not_fall_asleep_at_its_turning_point`.
const QUIET: f32 = 2.0;

/// Change of a position that counts as rounding and not as motion, in units of the last place. A stiff spring answers a rounding
/// error with a speed of ω times the error. Pinned by `sleep::tests`.
const ROUNDING: f32 = 4.0;

/// Whether a body is so slow that it may rest. `rest` is the speed that counts as rest, `size` the radius (m) with which its
/// angular velocity is multiplied, and `omega` the natural frequency of the stiffest element on it, rad/s.
fn is_slow(body: &Seen, rest: f32, size: f32, omega: f32, length_unit: f32) -> bool {
    let place = body.origin.abs().max_element() * f32::EPSILON;
    let noise = ROUNDING * omega;
    body.velocity.length() < rest * length_unit + noise * place
        && body.spin.length() * size < rest + noise * f32::EPSILON
}

/// Whether a body moves, or has not rested long enough yet. `inside` tells whether the engine solves its component.
fn is_restless(
    row: &mut BodyRow,
    body: &Seen,
    inside: bool,
    size: f32,
    omega: f32,
    time: f32,
    length_unit: f32,
) -> bool {
    let (position, rotation) = (body.origin, body.rotation.to_array());
    let place = position.abs().max_element() * f32::EPSILON;
    // The engine's velocities are those of its last substep. In a component that it solves, they tremble although places stay, so
    // mainly the position decides.
    let rest = if inside { HELD_REST } else { REST };
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
    // Trembling may be rounding, but a body that moves away does not rest. A body that only follows others may be in a slow swing.
    let follows = !row.has(BodyFlags::LINGERS);
    let may_creep = !follows || is_slow(body, REST, 1.0, omega, length_unit);
    let creep = if row.has(BodyFlags::CREEPS) && may_creep {
        CREEP
    } else {
        REST
    };
    let rest = &mut row.rare.rest;
    let strayed = rest.position.distance(position) > creep * QUIET * length_unit + ROUNDING * place
        || (Quat::from_array(rest.rotation).inverse() * body.rotation)
            .xyz()
            .length()
            * size
            > 0.5 * creep * QUIET;
    if strayed {
        row.flags.remove(BodyFlags::RESTS);
        return true;
    }
    rest.seconds += time;
    rest.rate = rest.position.distance(position) / rest.seconds;
    if rest.seconds >= QUIET {
        // Start again from the present position. Other bodies may need longer to come to rest, and a body that creeps a long way
        // in many such periods still rests in each of them.
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

/// Natural frequency of an element between its own ends, as of the last step, rad/s.
pub(crate) fn omega_of(row: &ElementRow) -> f32 {
    (row.slope() * row.inverse_mass).sqrt() as f32
}

impl Step {
    /// Whether a body may be so slow that it rests; then [`Self::is_restless`] decides. `place` is the largest coordinate of its
    /// position. This test takes squares to avoid square roots, because it runs for every body.
    #[inline(always)]
    pub(crate) fn may_rest(&self, speed_square: f32, place: f32, omega_square: f32) -> bool {
        let rest = REST * self.plan.length_unit;
        let noise = ROUNDING * place * f32::EPSILON;
        // (a + b)² is at most 2 (a² + b²).
        speed_square < 2.0 * (rest * rest + omega_square * noise * noise)
    }

    /// Whether all bodies of a component that was asleep still sleep, and no end of its elements has moved.
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

    /// Whether an awake body moves, or has not rested long enough yet. `inside` tells whether the engine solves its component.
    pub(crate) fn is_restless(
        &self,
        row: &mut BodyRow,
        body: &Seen,
        inside: bool,
        omega: f32,
        sight: &impl Sight,
    ) -> bool {
        // The surface of a small held body moves little when it turns, so its size counts.
        if take!(row.flags, BodyFlags::COUNTED) {
            return !row.has(BodyFlags::RESTS | BodyFlags::RESTS_LONG);
        }
        let inside = inside || row.has(BodyFlags::LINGERS);
        let size = if inside { sight.size(row.id) } else { 1.0 };
        let time = self.plan.time as f32;
        is_restless(row, body, inside, size, omega, time, self.plan.length_unit)
    }

    /// Whether the step would set a sleeping body in motion: with its acceleration it would exceed the speed of rest within a
    /// second.
    pub(crate) fn sets_moving(&self, start: &Body, end: &Body) -> bool {
        let rest = f64::from(REST) * self.plan.time;
        (end.velocity - start.velocity).length() > rest * f64::from(self.plan.length_unit)
            || (end.angular_velocity() - start.angular_velocity()).length() > rest
    }

    /// Returns whether there is anything to do for a component, and whether all its bodies must be [roused](rouse). `omega` is
    /// the natural frequency of its stiffest element, rad/s. `inside` tells whether the engine solves it.
    pub(crate) fn is_awake(
        &self,
        rows: &mut (impl RowsMut<BodyRow> + ?Sized),
        members: &[u32],
        inside: bool,
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
                restless |= self.is_restless(row, &body, inside, omega, sight);
            }
        }
        let awake = !all_asleep || disturbed;
        (awake, awake && (disturbed || restless))
    }
}

/// Wakes all bodies of a component if one of those that its step sets in motion, given by their indices within the component, is
/// still asleep. Otherwise that body would act like a wall.
pub(crate) fn wake_with(
    moved: &[u32],
    rows: &[BodyRow],
    members: &[u32],
    engine: &mut impl Engine,
) {
    let id = |b: u32| rows[b as usize].id;
    if moved
        .iter()
        .any(|slot| engine.is_asleep(id(members[*slot as usize])))
    {
        for b in members {
            engine.wake(id(*b));
        }
    }
}

/// Wakes the bodies of a component and keeps them awake.
pub(crate) fn rouse(rows: &[BodyRow], members: &[u32], engine: &mut impl Engine) {
    for b in members {
        let body = rows[*b as usize].id;
        if engine.is_asleep(body) {
            engine.wake(body);
        }
        engine.keep_awake(body);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::{DVec3, Quat, Vec3};

    /// Whether a body 1024 m from the origin, on a spring of 60 rad/s, may rest while it swings with an amplitude in units of the
    /// last place of its position.
    fn may_rest(amplitude: f32) -> bool {
        const OMEGA: f32 = 60.0;
        let unit = 1024.0_f32.next_up() - 1024.0;
        let body = Seen {
            origin: Vec3::X * 1024.0,
            rotation: Quat::IDENTITY,
            local_center: Vec3::ZERO,
            velocity: Vec3::X * OMEGA * amplitude * unit,
            spin: Vec3::ZERO,
            inverse_mass: 1.0,
            gravity: DVec3::ZERO,
            more_substeps: 0,
            is_movable: true,
            is_asleep: false,
            is_locked: false,
            can_touch: false,
            turns_fast: false,
            is_gyroscopic: false,
        };
        is_slow(&body, REST, 1.0, OMEGA, 1.0)
    }

    #[test]
    fn a_stiff_spring_far_away_may_rest_while_only_rounding_moves_it() {
        // Half a unit along each of three axes, at each of two ends.
        assert!(may_rest(3.0_f32.sqrt()));
        assert!(!may_rest(10.0), "a swing");
    }
}
