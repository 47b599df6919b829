//! Writes the results of a step into the components of elements: readouts, captured rest lengths and computed coefficients.

use crate::dynamics::single;
use crate::dynamics::thresholds::MOST_PHASE;
use crate::element::{
    HoldPose, Spring, SpringDamper, SpringTuning, TorsionSpring, TorsionSpringDamper,
};
use crate::input::parts::{Acts, IsElement};
use crate::readout::SpringReadout;
use crate::scene::observe::piece_of;
use crate::scene::report::{report, report_unresolved};
use crate::scene::rows::{ElementFlags, ElementRow, take};
use crate::scene::state::Scene;
use crate::threads;
use bevy::ecs::change_detection::ContiguousMut;
use bevy::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flags of an element that has results to write into its components.
const FOUND: ElementFlags = ElementFlags::TUNED
    .union(ElementFlags::CAPTURED)
    .union(ElementFlags::POSED);

/// ω·dt of a micro-step above which an element's own vibration is not followed, rad.
const UNRESOLVED: f32 = MOST_PHASE as f32;

/// Components into which a captured rest length or angle and computed coefficients are written.
pub(crate) type Springs<'a> = (
    Option<&'a mut Spring>,
    Option<&'a mut SpringDamper>,
    Option<&'a mut TorsionSpring>,
    Option<&'a mut TorsionSpringDamper>,
    Option<&'a SpringTuning>,
);

/// Readouts of all elements.
pub(crate) type Readouts<'w, 's> = Query<'w, 's, (Entity, &'static mut SpringReadout), Acts>;

impl Scene {
    /// Writes readouts and captured values, and reports faults found while solving.
    pub(crate) fn show(
        &mut self,
        readouts: &mut Readouts,
        springs: &mut Query<Springs, IsElement>,
        commands: &mut Commands,
    ) {
        let time = self.time;
        let seen = self.show_in_order(readouts);
        let (bodies, stepped) = (&self.bodies, &self.stepped);
        if seen.has_news {
            let mut unresolved = vec![];
            for row in &mut self.elements {
                if row.is_seen(bodies, stepped) {
                    row.tell(springs, commands);
                    if row.solved.unresolved
                        && row.is_unresolved_news(&row.read_out(row.time_of(bodies, stepped, time)))
                    {
                        row.flags.insert(ElementFlags::TOLD_UNRESOLVED);
                        unresolved.push(row.entity);
                    }
                }
            }
            report_unresolved(unresolved, commands);
        }
        if seen.is_incomplete {
            let seen = |row: &&ElementRow| row.is_seen(bodies, stepped);
            for row in self.elements.iter().filter(seen) {
                if let Ok((_, mut readout)) = readouts.get_mut(row.entity) {
                    readout.set_if_neq(row.read_out(row.time_of(bodies, stepped, time)));
                }
            }
        }
        if self.renewed {
            self.unordered = seen.is_unordered;
        }
        self.stale |= seen.is_unordered && !self.unordered;
    }

    /// Writes the readouts of rows that are in the order of the query. If elements appeared, disappeared or got other components
    /// since the rows were made, some rows are out of order. Then all rows are made anew.
    fn show_in_order(&self, readouts: &mut Readouts) -> SeenInOrder {
        let (time, mut rest) = (self.time, &self.elements[..]);
        let (bodies, stepped) = (&self.bodies, &self.stepped);
        let (has_news, is_unordered) = (AtomicBool::new(false), AtomicBool::new(false));
        for (entities, readouts) in readouts.contiguous_iter_mut().into_iter().flatten() {
            let count = rest.len().min(entities.len());
            is_unordered.fetch_or(count < entities.len(), Ordering::Relaxed);
            let (rows, others) = rest.split_at(count);
            rest = others;
            let (readouts, mut ticks) = ContiguousMut::bypass_change_detection_split(readouts);
            let (now, ticks) = (ticks.this_run(), ticks.changed_mut());
            let each = piece_of(count);
            let shown = readouts.chunks_mut(each).zip(ticks.chunks_mut(each));
            let pieces = rows.chunks(each).zip(entities.chunks(each)).zip(shown);
            threads::share(pieces, |((rows, entities), (readouts, ticks))| {
                let shown = readouts.iter_mut().zip(ticks);
                for ((row, entity), (readout, tick)) in rows.iter().zip(entities).zip(shown) {
                    if row.entity != *entity {
                        is_unordered.store(true, Ordering::Relaxed);
                        return;
                    }
                    if row.is_seen(bodies, stepped) {
                        let new = row.read_out(row.time_of(bodies, stepped, time));
                        if *readout != new {
                            (*readout, *tick) = (new, now);
                        }
                        if row.has_news() || row.is_unresolved_news(&new) {
                            has_news.store(true, Ordering::Relaxed);
                        }
                    }
                }
            });
        }
        let is_unordered = is_unordered.into_inner();
        let is_incomplete = is_unordered || !rest.is_empty();
        SeenInOrder {
            // A row that was not reached may have news, too.
            has_news: has_news.into_inner() || is_incomplete,
            is_unordered,
            is_incomplete,
        }
    }
}

/// Result of writing readouts in the order of the query.
struct SeenInOrder {
    /// Whether some element has something to report or to write back.
    has_news: bool,
    /// Whether some readout was not at the place of its row.
    is_unordered: bool,
    /// Whether the readouts of some rows were not written.
    is_incomplete: bool,
}

impl ElementRow {
    /// Whether it has something to [tell](Self::tell).
    #[inline(always)]
    fn has_news(&self) -> bool {
        self.flags.intersects(FOUND) || self.trouble.has_news()
    }

    /// Whether its own vibration is too fast for the micro-steps that it may take.
    #[inline(always)]
    fn is_unresolved(&self, readout: &SpringReadout) -> bool {
        self.solved.unresolved && readout.omega_dt > UNRESOLVED * readout.microsteps as f32
    }

    /// Whether its own vibration is too fast and that was not reported before.
    #[inline(always)]
    fn is_unresolved_news(&self, readout: &SpringReadout) -> bool {
        self.is_unresolved(readout) && !self.has(ElementFlags::TOLD_UNRESOLVED)
    }

    /// Reports faults, and writes back rest lengths that were captured and coefficients that were computed in this tick.
    fn tell(&mut self, springs: &mut Query<Springs, IsElement>, commands: &mut Commands) {
        report(self, commands);
        if !self.flags.intersects(FOUND) {
            return;
        }
        let tuned = take!(self.flags, ElementFlags::TUNED);
        let captured = take!(self.flags, ElementFlags::CAPTURED);
        if captured || tuned {
            self.write_back(tuned, springs);
        }
        let posed = take!(self.flags, ElementFlags::POSED);
        if self.has(ElementFlags::TUNED_AGAIN) {
            return;
        }
        let mut element = commands.entity(self.entity);
        if tuned {
            element.try_remove::<SpringTuning>();
        }
        if posed {
            element.try_remove::<HoldPose>();
        }
    }

    /// Writes a captured rest length and computed coefficients into the element's component.
    fn write_back(&self, tuned: bool, springs: &mut Query<Springs, IsElement>) {
        let Ok((spring, pair, torsion, torsion_pair, tuning)) = springs.get_mut(self.entity) else {
            return;
        };
        let p = &self.numbers;
        // With `Sag` the rest length is computed again together with the stiffness, so the present one is not written.
        let again = tuned && self.has(ElementFlags::TUNED_AGAIN);
        let passing = again && matches!(tuning, Some(SpringTuning::Sag { .. }));
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

    /// The readout after a step of `time` seconds.
    #[inline(always)]
    fn read_out(&self, time: f64) -> SpringReadout {
        let (length, rate) = (self.length, self.rate);
        let mut readout = SpringReadout {
            length: single(length),
            rate: single(rate),
            dissipated_energy: single(self.ledger.dissipated),
            work: single(self.ledger.work),
            ..default()
        };
        if self.trouble.passing().is_none() {
            let (elastic, drag) = (self.elastic(length), self.drag(length, rate));
            readout.spring_force = single(self.even_tension(elastic.force));
            readout.damper_force = single(drag);
            readout.stored_energy = single(elastic.energy);
            readout.dissipated_power = single(drag * rate);
            readout.omega_dt = single((elastic.stiffness * self.inverse_mass).sqrt() * time);
            readout.effective_mass = self.inverse_mass.recip() as f32;
            readout.note(&self.solved);
            readout.capped |= self.is_unresolved(&readout);
        }
        readout
    }
}
