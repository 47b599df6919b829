//! Runs after the engine's step. It reads where bodies are now, and with them the ends of each element.

use crate::backend::{BodyId, Seen, Sight, Worlds};
use crate::dynamics::element::{End, Path};
use crate::dynamics::guide::Guide;
use crate::scene::rows::{BodyFlags, BodyRow, ElementFlags, ElementRow, Held, take, turning_mark};
use crate::scene::state::Scene;
use crate::scene::still::Stepped;
use crate::threads;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of rows from which on several threads are worth their start-up time. Pinned by the benchmark `own/isolated`.
pub(crate) const WORTH_SHARING: usize = 2048;

/// Read access to the bodies after the step.
struct Eyes<'a, W: Worlds> {
    worlds: &'a W,
    /// The bodies of the only context in which elements move bodies; none if there may be several such contexts.
    only: Option<&'a W::Sight>,
    stepped: &'a Stepped,
    /// Duration of the step of the first context, s.
    time: f64,
    /// Whether a body can no longer be moved, so that all rows must be made anew.
    stale: AtomicBool,
}

/// Position (m) and velocity (m/s) of a point.
type Moving = (DVec3, DVec3);

impl Scene {
    /// Reads the new state of all bodies and elements.
    pub(crate) fn observe(&mut self, worlds: &impl Worlds) {
        let only = match &self.lone[..] {
            [lone] if self.assemblies.is_empty() => worlds.of(lone.context),
            _ => None,
        };
        let eyes = Eyes {
            worlds,
            only,
            stepped: &self.stepped,
            time: self.time,
            stale: AtomicBool::new(false),
        };
        if self.noting {
            let each = piece_of(self.bodies.len());
            threads::share(self.bodies.chunks_mut(each), |rows| {
                rows.iter_mut().for_each(|row| eyes.note(row));
            });
        }
        let (bodies, stepped) = (&self.bodies, &self.stepped);
        let each = piece_of(self.elements.len());
        threads::share(self.elements.chunks_mut(each), |rows| {
            for row in rows.iter_mut().filter(|row| row.is_seen(bodies, stepped)) {
                row.observe(bodies, &eyes);
            }
        });
        self.stale |= eyes.stale.into_inner();
    }
}

/// Number of rows in each piece of work, of `rows` in all.
pub(crate) fn piece_of(rows: usize) -> usize {
    threads::piece_of(rows, rows >= WORTH_SHARING)
}

impl<'a, W: Worlds> Eyes<'a, W> {
    fn body(&self, context: Entity, body: BodyId) -> Option<Seen> {
        let mut seen = self.worlds.of(context)?.see(body)?;
        if let Some([velocity, spin]) = self.stepped.led.get(&(context, body)) {
            (seen.velocity, seen.spin) = (*velocity, *spin);
        }
        Some(seen)
    }

    /// State of a body that elements move.
    #[inline(always)]
    fn see(&self, row: &BodyRow) -> Option<Seen> {
        let world = match self.only {
            Some(only) => Some(only),
            None => self.worlds.of(row.rare.context),
        };
        let seen = world.and_then(|world| world.see(row.id));
        // The engine removes or disables bodies that it cannot step.
        if seen.as_ref().is_none_or(|seen| !seen.is_movable) {
            self.stale.store(true, Ordering::Relaxed);
        }
        seen
    }

    /// Stores the position and velocity of a body, because several elements may read them.
    fn note(&self, row: &mut BodyRow) {
        let known = row.has(BodyFlags::NOTED) && !row.has(BodyFlags::FRESH);
        if known || row.has(BodyFlags::IS_ALONE) {
            return;
        }
        let Some(seen) = self.see(row) else { return };
        row.flags.remove(BodyFlags::FRESH);
        row.flags.insert(BodyFlags::NOTED);
        row.rare.now = (seen.center(), seen.velocity);
        if row.has(BodyFlags::TURNS) {
            row.rare.turned = turning_mark(&seen);
        }
    }
}

impl ElementRow {
    /// Whether the element can have changed in the step.
    #[inline(always)]
    pub(crate) fn is_seen(&self, bodies: &[BodyRow], stepped: &Stepped) -> bool {
        let acts = self.has(ElementFlags::ACTIVE) || self.moves() == 0;
        acts && self.trouble.lasting().is_none()
            && (!stepped.some_rest || self.has_acted(bodies, stepped))
    }

    /// Updates the length and rate of the element, and stores where its ends are.
    fn observe(&mut self, bodies: &[BodyRow], eyes: &Eyes<impl Worlds>) {
        let led = self.moves() == 0 && self.rare.places[0].is_some();
        let time = self.time_of(bodies, eyes.stepped, eyes.time);
        // Two calls are faster than a loop that fills an array, and this runs for every element.
        let points = [
            self.point(0, bodies, eyes, time),
            self.point(1, bodies, eyes, time),
        ];
        if self.numbers.rest_length.is_none() && self.trouble.passing().is_none() {
            // An element without a movable body is not solved, so its rest length is captured only here.
            let length = self.extent(points, eyes).0;
            self.numbers.rest_length = Some(length as f32);
            self.flags.insert(ElementFlags::CAPTURED);
        }
        if !self.has(ElementFlags::PLACED) {
            self.note_places(points, eyes);
        }
        let wound = self.rare_angle();
        let (length, rate) = self.extent(points, eyes);
        // If Rapier's solver fails in a step, kinematic bodies get a velocity that is not finite.
        let seen = (length, if rate.is_finite() { rate } else { 0.0 });
        let seen = match &self.inside {
            None => seen,
            Some(_) => self.arrive(seen, wound, points, eyes, time),
        };
        if self.moves() == 0 {
            self.judge_law(seen);
        }
        if led {
            self.account_for_moved(seen, time);
        }
        let jumped = take!(self.flags, ElementFlags::JUMPED);
        self.flags.set(ElementFlags::LEADS, jumped);
        (self.length, self.rate) = seen;
    }

    /// Stores where the ends of the element are after the step.
    fn note_places(&mut self, points: [Moving; 2], eyes: &Eyes<impl Worlds>) {
        let placed = !self.is_any_watched() && self.moves() == 2;
        self.flags.set(ElementFlags::PLACED, placed);
        for (end, point) in points.iter().enumerate() {
            let moves = self.movable(end).is_some();
            let rare = &mut *self.rare;
            rare.places[end] = Some(match rare.held[end] {
                Held::Path { to, .. } => to,
                Held::Body { local, .. } if moves => local,
                Held::Body { .. } => point.0,
            });
            if !moves && rare.guide != Guide::Centres {
                let mut facings = rare.facings();
                facings[end] = frame(&rare.held[end], eyes).0;
                rare.set_facings(facings);
            }
        }
    }

    /// Position and velocity of an end after the step.
    #[inline(always)]
    fn point(&self, end: usize, bodies: &[BodyRow], eyes: &Eyes<impl Worlds>, time: f64) -> Moving {
        if let Some(index) = self.movable(end) {
            let row = &bodies[index];
            if row.has(BodyFlags::IS_ALONE) {
                if let Some(seen) = eyes.see(row) {
                    return (seen.center(), seen.velocity.as_dvec3());
                }
                return row.place();
            }
            if !row.has(BodyFlags::TURNS) {
                return row.place();
            }
        }
        match self.rare.held[end] {
            Held::Path { from, to } => (to, (to - from) / time),
            Held::Body {
                body,
                context,
                local,
            } => eyes
                .body(context, body)
                .map_or((DVec3::ZERO, DVec3::ZERO), |body| body.point(local)),
        }
    }

    /// Length and rate. For an element with an axis these are the distance along the axis, or the twist with full turns counted.
    #[inline(always)]
    fn extent(&mut self, [a, b]: [Moving; 2], eyes: &Eyes<impl Worlds>) -> (f64, f64) {
        if !self.has(ElementFlags::IS_PLAIN) && self.rare.guide != Guide::Centres {
            let ends = [(0, a), (1, b)].map(|(end, (position, velocity))| {
                let mut path = Path::straight(position, velocity);
                (path.rotation, path.turning) = frame(&self.rare.held[end], eyes);
                End::Path(path)
            });
            return self.guided_extent(ends);
        }
        let d = b.0 - a.0;
        let length = d.length();
        let direction = if length > 0.0 {
            d / length
        } else {
            self.direction().unwrap_or(DVec3::ZERO)
        };
        (length, (b.1 - a.1).dot(direction))
    }

    /// Last twist, rad; 0 for a plain element, which has none.
    fn rare_angle(&self) -> f64 {
        if self.has(ElementFlags::IS_PLAIN) {
            0.0
        } else {
            self.rare.angle
        }
    }

    /// Updates the element after a step inside the engine's solver. Returns its length and its mean rate over the step, because
    /// the engine's velocities are those of its last substep.
    fn arrive(
        &mut self,
        (length, rate): (f64, f64),
        wound: f64,
        points: [Moving; 2],
        eyes: &Eyes<impl Worlds>,
        time: f64,
    ) -> (f64, f64) {
        let Some(mut inside) = self.inside.take_if(|inside| inside.active) else {
            if self.inside.as_ref().is_some_and(|inside| inside.slipped) {
                self.rare.angle = wound;
                return (wound, 0.0);
            }
            return (length, rate);
        };
        let facings = self.rare.held.map(|held| match held {
            Held::Body { body, context, .. } => eyes
                .body(context, body)
                .map_or(DQuat::IDENTITY, |body| body.facing()),
            Held::Path { .. } => DQuat::IDENTITY,
        });
        let length = inside.wound(facings, length, time, |twist| self.elastic(twist).energy);
        let guide = self.rare.guide;
        let places = points.map(|(place, _)| place);
        let moved = [0, 1].map(|end| {
            let by = inside.moved(guide, end, places, facings);
            by.filter(|_| self.movable(end).is_none())
        });
        let way = inside.way(guide, places, facings);
        self.inside = Some(inside);
        if self.rare.guide.is_twist() {
            self.rare.angle = length;
        }
        self.arrive_inside(length, moved, way, time)
    }
}

/// Rotation and angular velocity (rad/s), after the step, of the body that holds an end.
fn frame(held: &Held, eyes: &Eyes<impl Worlds>) -> (DQuat, DVec3) {
    let Held::Body { body, context, .. } = *held else {
        return (DQuat::IDENTITY, DVec3::ZERO);
    };
    let body = eyes.body(context, body);
    body.map_or((DQuat::IDENTITY, DVec3::ZERO), |body| {
        // The present angular velocity counts, not that of a coming step.
        (body.facing(), body.spin.as_dvec3())
    })
}
