//! What an element shows after a step.

use crate::dynamics::single;
use crate::element::{Spring, SpringDamper, SpringTuning, TorsionSpring, TorsionSpringDamper};
use crate::input::parts::{Acts, IsElement};
use crate::readout::SpringReadout;
use crate::scene::report::report;
use crate::scene::rows::{ElementFlags, ElementRow, take};
use crate::scene::state::Scene;
use bevy::prelude::*;

/// What a captured rest length or angle is written into.
pub(crate) type Springs<'a> = (
    Option<&'a mut Spring>,
    Option<&'a mut SpringDamper>,
    Option<&'a mut TorsionSpring>,
    Option<&'a mut TorsionSpringDamper>,
    Option<&'a SpringTuning>,
);

impl Scene {
    /// Writes readouts, captured rest lengths, and faults found while solving.
    pub(crate) fn show(
        &mut self,
        readouts: &mut Query<(Entity, &mut SpringReadout), Acts>,
        springs: &mut Query<Springs, IsElement>,
        commands: &mut Commands,
    ) {
        let time = self.time;
        let mut show = |row: &mut ElementRow, readout: Option<&mut Mut<SpringReadout>>| {
            if !row.is_seen() {
                return;
            }
            row.tell(springs, commands);
            if let Some(readout) = readout {
                readout.set_if_neq(row.read_out(time));
            }
        };
        // The rows stand in the query's order; if something came, went or got other components since they were
        // made, from there on each is looked up, and the rows are made anew.
        let mut unordered = false;
        let mut rows = self.elements.iter_mut();
        for (entity, mut readout) in &mut *readouts {
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
        if self.renewed {
            self.unordered = unordered;
        }
        self.stale |= unordered && !self.unordered;
    }
}

impl ElementRow {
    /// Tells what was found in this tick: faults, captured rest lengths, coefficients that were worked out.
    #[inline(always)]
    fn tell(&mut self, springs: &mut Query<Springs, IsElement>, commands: &mut Commands) {
        report(self, commands);
        let found = ElementFlags::TUNED | ElementFlags::CAPTURED;
        if !self.flags.intersects(found) {
            return;
        }
        let tuned = take!(self.flags, ElementFlags::TUNED);
        let captured = take!(self.flags, ElementFlags::CAPTURED);
        if (captured && self.trouble.passing().is_none()) || tuned {
            self.write_back(tuned, springs);
        }
        if tuned && !self.has(ElementFlags::TUNED_AGAIN) {
            commands.entity(self.entity).try_remove::<SpringTuning>();
        }
    }

    /// Writes a captured rest length into the element's component, and coefficients that were worked out.
    fn write_back(&self, tuned: bool, springs: &mut Query<Springs, IsElement>) {
        let Ok((spring, pair, torsion, torsion_pair, tuning)) = springs.get_mut(self.entity) else {
            return;
        };
        let p = &self.numbers;
        // What a sag makes of the rest length is found anew with the stiffness.
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

    /// What it shows after a step of `time` seconds.
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
            readout.spring_force = single(elastic.force);
            readout.damper_force = single(drag);
            readout.stored_energy = single(elastic.energy);
            readout.dissipated_power = single(drag * rate);
            readout.omega_dt = single((elastic.stiffness * self.inverse_mass).sqrt() * time);
            readout.effective_mass = self.inverse_mass.recip() as f32;
            readout.note(&self.solved);
        }
        readout
    }
}
