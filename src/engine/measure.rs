//! After the engine's step: what each element shows.

use super::body::{center_of, is_movable, point_of, rotation_of};
use super::parts::{Acts, IsElement};
use super::report::report;
use super::rows::{BodyRow, ElementRow, Held, turning_mark};
use super::scene::Scene;
use super::step::facing;
use crate::dynamics::element::{End, Path};
use crate::dynamics::guide::Guide;
use crate::dynamics::single;
use crate::element::{Spring, SpringDamper, SpringTuning, TorsionSpring, TorsionSpringDamper};
use crate::readout::SpringReadout;
use bevy::math::{DQuat, DVec3};
use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::dynamics::{RigidBody as RapierBody, RigidBodyHandle, RigidBodySet};

/// What a captured rest length or angle is written into.
type Springs<'a> = (
    Option<&'a mut Spring>,
    Option<&'a mut SpringDamper>,
    Option<&'a mut TorsionSpring>,
    Option<&'a mut TorsionSpringDamper>,
    Option<&'a SpringTuning>,
);

/// Writes readouts, captured rest lengths, and faults found while solving.
pub(crate) fn measure(
    mut scene: ResMut<Scene>,
    sets: Query<&'static RapierRigidBodySet>,
    mut readouts: Query<(Entity, &mut SpringReadout), Acts>,
    mut springs: Query<Springs, IsElement>,
    mut commands: Commands,
) {
    let scene = &mut *scene;
    if scene.time <= 0.0 {
        return;
    }
    if !(scene.delivered || scene.immovable) {
        // All asleep.
        return;
    }
    let time = scene.time;
    let mut look = Look {
        sets: &sets,
        known: None,
        stale: false,
    };
    let mut show = |row: &mut ElementRow, readout: Option<&mut Mut<SpringReadout>>| {
        let led = row.moves() == 0 && row.memory.places[0].is_some();
        let Some(points) = row.see(time, &mut scene.bodies, &mut look) else {
            return;
        };
        tell(row, &mut springs, &mut commands);
        let seen = row.seen(points, time, &mut look);
        if led {
            row.account_for_moved(seen, time);
        }
        row.memory.length = seen.0;
        if let Some(readout) = readout {
            readout.set_if_neq(row.read_out(seen, time));
        }
    };
    // The rows stand in the query's order; if something came, went or got other components since they were
    // made, from there on each is looked up, and the rows are made anew.
    let mut unordered = false;
    let mut rows = scene.elements.iter_mut();
    for (entity, mut readout) in &mut readouts {
        let next = rows.as_slice().first();
        unordered = next.is_none_or(|row| row.entity != entity);
        if unordered {
            break;
        }
        if let Some(row) = rows.next() {
            show(row, Some(&mut readout));
        }
    }
    for row in rows {
        let mut readout = readouts.get_mut(row.entity).ok();
        show(row, readout.as_mut().map(|(_, readout)| readout));
    }
    if scene.renewed {
        scene.unordered = unordered;
    }
    scene.stale |= look.stale || (unordered && !scene.unordered);
}

/// Tells what was found in this tick: faults, captured rest lengths, coefficients that were worked out.
#[inline(always)]
fn tell(row: &mut ElementRow, springs: &mut Query<Springs, IsElement>, commands: &mut Commands) {
    report(row, commands);
    let tuned = std::mem::take(&mut row.tuned);
    if (std::mem::take(&mut row.captured) && row.trouble.passing().is_none()) || tuned {
        write_back(row, tuned, springs);
    }
    if tuned && !row.tuned_again {
        commands.entity(row.entity).try_remove::<SpringTuning>();
    }
}

/// Writes a captured rest length into the element's component, and coefficients that were worked out.
fn write_back(row: &ElementRow, tuned: bool, springs: &mut Query<Springs, IsElement>) {
    let Ok((spring, pair, torsion, torsion_pair, tuning)) = springs.get_mut(row.entity) else {
        return;
    };
    let p = &row.parameters;
    // What a sag makes of the rest length is found anew with the stiffness.
    let passing = tuned && row.tuned_again && matches!(tuning, Some(SpringTuning::Sag { .. }));
    let write = |rest: &mut Option<f32>, stiffness: &mut f32, damping: Option<&mut f32>| {
        if !passing {
            *rest = p.rest_length;
        }
        if tuned {
            *stiffness = p.stiffness;
            if let Some(damping) = damping {
                *damping = p.damping;
            }
        }
    };
    if let Some(mut s) = spring {
        let s = &mut *s;
        write(&mut s.rest_length, &mut s.stiffness, None);
    }
    if let Some(mut s) = pair {
        let s = &mut *s;
        write(&mut s.rest_length, &mut s.stiffness, Some(&mut s.damping));
    }
    if let Some(mut s) = torsion {
        let s = &mut *s;
        write(&mut s.rest_angle, &mut s.stiffness, None);
    }
    if let Some(mut s) = torsion_pair {
        let s = &mut *s;
        write(&mut s.rest_angle, &mut s.stiffness, Some(&mut s.damping));
    }
}

/// What is needed to see where stepped bodies are.
struct Look<'a, 'w, 's> {
    sets: &'a Query<'w, 's, &'static RapierRigidBodySet>,
    known: Option<(Entity, &'a RigidBodySet)>,
    /// The scene is not what it was thought to be.
    stale: bool,
}

impl<'a> Look<'a, '_, '_> {
    /// The bodies of a context.
    fn bodies(&mut self, context: Entity) -> Option<&'a RigidBodySet> {
        if self.known.is_none_or(|known| known.0 != context) {
            let set = self.sets.get(context).ok()?;
            self.known = Some((context, &set.bodies));
        }
        self.known.map(|known| known.1)
    }

    fn body(&mut self, context: Entity, handle: RigidBodyHandle) -> Option<&'a RapierBody> {
        self.bodies(context)?.get(handle)
    }

    /// Position and velocity of a body's centre of mass after the step.
    fn at(&mut self, row: &mut BodyRow) -> (DVec3, DVec3) {
        if !row.is_fresh && row.is_noted {
            return row.place();
        }
        let Some(body) = self.body(row.context, row.handle) else {
            self.stale = true;
            return row.place();
        };
        row.is_fresh = false;
        // The engine takes bodies out that it cannot step.
        let is_out = !is_movable(body);
        let now = (center_of(body), body.linvel());
        row.is_noted = !row.is_alone;
        if row.is_noted {
            row.now = now;
            if row.turns {
                row.turned = turning_mark(body);
            }
        }
        self.stale |= is_out;
        (now.0, now.1.as_dvec3())
    }
}

impl ElementRow {
    /// Position and velocity of both ends, if anything about the element can have changed; notes where
    /// they are.
    fn see(
        &mut self,
        time: f64,
        bodies: &mut [BodyRow],
        look: &mut Look,
    ) -> Option<[(DVec3, DVec3); 2]> {
        if self.trouble.lasting().is_some() || !(self.active || self.moves() == 0) {
            return None;
        }
        let points = [0, 1].map(|end| self.point(end, time, bodies, look));
        if self.parameters.rest_length.is_none() {
            // No movable body: it took no part in the solve.
            let length = self.extent(points, time, look.sets).0;
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
                self.memory.facings[end] = frame(&self.held[end], time, look.sets).0;
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
        look: &mut Look,
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
                handle,
                context,
                local,
                ..
            } => look
                .body(context, handle)
                .map_or((DVec3::ZERO, DVec3::ZERO), |body| point_of(body, local)),
        }
    }

    /// Length or twist after the step, and its rate.
    #[inline(always)]
    fn seen(&mut self, points: [(DVec3, DVec3); 2], time: f64, look: &mut Look) -> (f64, f64) {
        let wound = self.memory.angle;
        let (length, rate) = self.extent(points, time, look.sets);
        // In a step that its solver loses, Rapier gives kinematic bodies a velocity that is no number.
        let seen = (length, if rate.is_finite() { rate } else { 0.0 });
        self.arrive(seen, wound, points, time, look)
    }

    /// Length and its rate; of a guided element the distance along its axis, or its twist, whose turns are counted.
    fn extent(
        &mut self,
        [a, b]: [(DVec3, DVec3); 2],
        time: f64,
        sets: &Query<&RapierRigidBodySet>,
    ) -> (f64, f64) {
        if self.companion.guide != Guide::Centres {
            let ends = [(0, a), (1, b)].map(|(end, (position, velocity))| {
                let mut path = Path::straight(position, velocity);
                (path.rotation, path.turning) = frame(&self.held[end], time, sets);
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
        look: &mut Look,
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
            Held::Body {
                handle, context, ..
            } => look
                .body(context, handle)
                .map_or(DQuat::IDENTITY, rotation_of),
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

    fn read_out(&self, (length, rate): (f64, f64), time: f64) -> SpringReadout {
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
fn frame(held: &Held, time: f64, sets: &Query<&RapierRigidBodySet>) -> (DQuat, DVec3) {
    let Held::Body {
        handle, context, ..
    } = *held
    else {
        return (DQuat::IDENTITY, DVec3::ZERO);
    };
    let Some(set) = sets.get(context).ok().map(|set| &set.bodies) else {
        return (DQuat::IDENTITY, DVec3::ZERO);
    };
    // Not where it is going: the step is over.
    let turning = set.get(handle).map_or(Vec3::ZERO, RapierBody::angvel);
    (facing(held, time, set).0, turning.as_dvec3())
}
