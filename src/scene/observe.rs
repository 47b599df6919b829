//! After the engine's step: where it has taken the ends of each element, and what that element shows.

use crate::backend::{BodyId, Seen, Sight, Worlds};
use crate::dynamics::element::{End, Path};
use crate::dynamics::guide::Guide;
use crate::dynamics::single;
use crate::readout::SpringReadout;
use crate::scene::rows::{BodyRow, ElementRow, Held, turning_mark};
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;

/// What is needed to see where stepped bodies are.
pub(crate) struct Look<'a, W> {
    worlds: &'a W,
    /// The scene is not what it was thought to be.
    pub(crate) stale: bool,
}

impl<'a, W: Worlds> Look<'a, W> {
    pub(crate) fn new(worlds: &'a W) -> Self {
        let stale = false;
        Self { worlds, stale }
    }

    fn body(&self, context: Entity, body: BodyId) -> Option<Seen> {
        self.worlds.of(context)?.see(body)
    }

    /// Position and velocity of a body's centre of mass after the step.
    fn at(&mut self, row: &mut BodyRow) -> (DVec3, DVec3) {
        if !row.is_fresh && row.is_noted {
            return row.place();
        }
        let Some(body) = self.body(row.context, row.id) else {
            self.stale = true;
            return row.place();
        };
        row.is_fresh = false;
        // The engine takes bodies out that it cannot step.
        let is_out = !body.is_movable;
        let now = (body.center(), body.velocity);
        row.is_noted = !row.is_alone;
        if row.is_noted {
            row.now = now;
            if row.turns {
                row.turned = turning_mark(&body);
            }
        }
        self.stale |= is_out;
        (now.0, now.1.as_dvec3())
    }
}

impl ElementRow {
    /// Position and velocity of both ends, if anything about the element can have changed; notes where
    /// they are.
    pub(crate) fn see(
        &mut self,
        time: f64,
        bodies: &mut [BodyRow],
        look: &mut Look<impl Worlds>,
    ) -> Option<[(DVec3, DVec3); 2]> {
        if self.trouble.lasting().is_some() || !(self.active || self.moves() == 0) {
            return None;
        }
        let points = [0, 1].map(|end| self.point(end, time, bodies, look));
        if self.parameters.rest_length.is_none() {
            // No movable body: it took no part in the solve.
            let length = self.extent(points, look.worlds).0;
            self.parameters.rest_length = Some(length as f32);
            self.captured = true;
        }
        if self.placed {
            return Some(points);
        }
        self.placed = self.watched == [false; 2] && self.moves() == 2;
        for (end, point) in points.iter().enumerate() {
            self.memory.places[end] = Some(match self.held[end] {
                Held::Path { to, .. } => to,
                Held::Body { local, .. } if self.on[end].is_some() => local,
                Held::Body { .. } => point.0,
            });
            if self.on[end].is_none() && self.companion.guide != Guide::Centres {
                self.memory.facings[end] = frame(&self.held[end], look.worlds).0;
            }
        }
        Some(points)
    }

    /// Position and velocity of an end after the step.
    fn point(
        &self,
        end: usize,
        time: f64,
        bodies: &mut [BodyRow],
        look: &mut Look<impl Worlds>,
    ) -> (DVec3, DVec3) {
        if let Some(index) = self.movable(end) {
            let body = &mut bodies[index];
            let center = look.at(body);
            if !body.turns {
                return center;
            }
        }
        match self.held[end] {
            Held::Path { from, to } => (to, (to - from) / time),
            Held::Body {
                body,
                context,
                local,
                ..
            } => look
                .body(context, body)
                .map_or((DVec3::ZERO, DVec3::ZERO), |body| body.point(local)),
        }
    }

    /// Length or twist after the step, and its rate.
    #[inline(always)]
    pub(crate) fn seen(
        &mut self,
        points: [(DVec3, DVec3); 2],
        time: f64,
        look: &mut Look<impl Worlds>,
    ) -> (f64, f64) {
        let wound = self.memory.angle;
        let (length, rate) = self.extent(points, look.worlds);
        // In a step that its solver loses, Rapier gives kinematic bodies a velocity that is no number.
        let seen = (length, if rate.is_finite() { rate } else { 0.0 });
        self.arrive(seen, wound, points, time, look)
    }

    /// Length and its rate; of a guided element the distance along its axis, or its twist, whose turns are counted.
    fn extent(&mut self, [a, b]: [(DVec3, DVec3); 2], worlds: &impl Worlds) -> (f64, f64) {
        if self.companion.guide != Guide::Centres {
            let ends = [(0, a), (1, b)].map(|(end, (position, velocity))| {
                let mut path = Path::straight(position, velocity);
                (path.rotation, path.turning) = frame(&self.held[end], worlds);
                End::Path(path)
            });
            return self.guided_extent(ends);
        }
        let d = b.0 - a.0;
        let length = d.length();
        let direction = if length > 0.0 {
            d / length
        } else {
            self.memory.direction.unwrap_or(DVec3::ZERO)
        };
        (length, (b.1 - a.1).dot(direction))
    }

    /// Takes in how a step inside the engine's solver went: there the rate is that of the length, not the engine's.
    fn arrive(
        &mut self,
        (length, rate): (f64, f64),
        wound: f64,
        points: [(DVec3, DVec3); 2],
        time: f64,
        look: &mut Look<impl Worlds>,
    ) -> (f64, f64) {
        let Some(mut inside) = self.inside.take_if(|inside| inside.active) else {
            if self
                .inside
                .as_ref()
                .is_some_and(|inside| inside.has_slipped())
            {
                self.memory.angle = wound;
                return (wound, 0.0);
            }
            return (length, rate);
        };
        let facings = self.held.map(|held| match held {
            Held::Body { body, context, .. } => look
                .body(context, body)
                .map_or(DQuat::IDENTITY, |body| body.facing()),
            Held::Path { .. } => DQuat::IDENTITY,
        });
        let length = inside.wound(facings, length, time, |twist| self.elastic(twist).energy);
        let moved = [0, 1].map(|end| {
            let by = inside.moved(end, points[end].0, facings[end]);
            by.filter(|_| self.on[end].is_none())
        });
        self.inside = Some(inside);
        if self.companion.guide.is_twist() {
            self.memory.angle = length;
        }
        self.arrive_inside(length, moved, time)
    }

    pub(crate) fn read_out(&self, (length, rate): (f64, f64), time: f64) -> SpringReadout {
        let mut readout = SpringReadout {
            length: single(length),
            rate: single(rate),
            dissipated_energy: single(self.ledger.dissipated),
            work: single(self.ledger.work),
            ..default()
        };
        if self.trouble.passing().is_none() {
            let (elastic, drag) = (self.elastic(length), self.drag(length, rate));
            readout.spring_force = single(elastic.force);
            readout.damper_force = single(drag);
            readout.stored_energy = single(elastic.energy);
            readout.dissipated_power = single(drag * rate);
            readout.omega_dt = single((elastic.stiffness * self.inverse_mass).sqrt() * time);
            readout.effective_mass = self.inverse_mass.recip() as f32;
            readout.note(&self.outcome);
        }
        readout
    }
}

/// Rotation and angular velocity of what holds an end, after the step.
fn frame(held: &Held, worlds: &impl Worlds) -> (DQuat, DVec3) {
    let Held::Body { body, context, .. } = *held else {
        return (DQuat::IDENTITY, DVec3::ZERO);
    };
    let body = worlds.of(context).and_then(|world| world.see(body));
    body.map_or((DQuat::IDENTITY, DVec3::ZERO), |body| {
        // Not where it is going: the step is over.
        (body.facing(), body.spin.as_dvec3())
    })
}
