//! A network of points that only the engine has moved since its last step goes on as it is: no more is read
//! than where its bodies are, and no more written than what they are given.

use crate::backend::{Engine, Push, Seen, Sight};
use crate::scene::assembly::{Assembly, State};
use crate::scene::rows::{BodyFlags, BodyRow, ElementRow, Members, pull_mark, take};
use crate::scene::step::Step;
use bevy::math::Vec3;
use std::sync::atomic::Ordering;

/// What is known of such a network.
#[derive(Default)]
pub(crate) struct WarmStart {
    /// Ends that elements cannot move: which element's within the component, and which of its two.
    pub ends: Vec<(usize, usize)>,
    /// Natural frequency of the stiffest element.
    pub omega: f32,
    /// Where each body's centre of mass is in its own frame.
    pub centers: Vec<Vec3>,
    /// Places of its bodies within the component in the order of their rows, which is that of the engine's memory: large networks
    /// are read and written in that.
    pub in_memory: Vec<u32>,
    /// Its bodies before the step, in that order.
    seen: Vec<Seen>,
    /// Some body has not rested for long.
    restless: bool,
    /// Something else than elements can have changed what it has.
    pub perturbed: bool,
}

impl WarmStart {
    /// Takes in which bodies there are.
    pub(crate) fn line_up(&mut self, members: &Members) {
        self.in_memory.clear();
        self.in_memory.extend(0..members.bodies.len() as u32);
        self.in_memory
            .sort_unstable_by_key(|slot| members.bodies[*slot as usize]);
    }
}

impl Assembly {
    /// Takes the network in, if it can go on as it is.
    pub(crate) fn continue_warm(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &[ElementRow],
        bodies: &mut [BodyRow],
        sight: &impl Sight,
    ) -> bool {
        self.component.is_warm = false;
        self.warm.perturbed = false;
        if self.component.elements.len() != members.elements.len() {
            return false;
        }
        let mut disturbed = false;
        let goes_on = self.place(step, members, elements, bodies, sight, &mut disturbed);
        if goes_on.is_none() {
            // What has been taken note of is not lost.
            if let Some(first) = members.bodies.first() {
                let row = &mut bodies[*first as usize];
                if disturbed {
                    row.flags.insert(BodyFlags::DISTURBED);
                }
            }
            return false;
        }
        self.warm.restless |= disturbed;
        self.component.is_warm = true;
        self.component.perturbed = self.warm.perturbed;
        self.state = State::Ready;
        true
    }

    /// Places bodies and ends; none if some body needs the general solver.
    fn place(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &[ElementRow],
        bodies: &mut [BodyRow],
        sight: &impl Sight,
        disturbed: &mut bool,
    ) -> Option<()> {
        let warm = &mut self.warm;
        let time = step.plan.time;
        let points = self.component.points_to_continue(time)?;
        warm.restless = false;
        warm.seen.clear();
        for slot in warm.in_memory.iter().map(|slot| *slot as usize) {
            let row = &mut bodies[members.bodies[slot] as usize];
            let body = sight.see(row.id)?;
            let same = warm.centers[slot] == body.local_center;
            if !body.is_movable || body.is_asleep || body.is_locked || !same {
                return None;
            }
            self.touch_changed |= row.notice_colliders(body.can_touch);
            let point = row.point(&body);
            warm.perturbed |= row.was_perturbed(&body, point.position);
            if points.origin(slot).acceleration != point.acceleration {
                // Written only then: it lies apart from what every step needs.
                row.rare.pulled = pull_mark(point.acceleration);
                warm.perturbed = true;
            }
            *disturbed |= take!(row.flags, BodyFlags::DISTURBED);
            warm.restless |= step.is_restless(row, &body, warm.omega, sight);
            if !points.place(slot, &point) {
                return None;
            }
            warm.seen.push(body);
        }
        for (index, (element, end)) in warm.ends.iter().enumerate() {
            let row = &elements[members.elements[*element] as usize];
            let has_moved = step.has_moved(row, sight);
            warm.perturbed |= has_moved;
            *disturbed |= has_moved;
            let [from, to] = step.path(&row.rare.held[*end], sight);
            if has_moved && from == to {
                // It has leapt: what work that was is to be found.
                return None;
            }
            points.place_end(index, from, (to - from) / time);
        }
        Some(())
    }

    /// Gives the engine what takes the bodies on.
    pub(crate) fn deliver_warm(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
    ) {
        let points = self.component.warm_points();
        for (slot, seen) in self.warm.in_memory.iter().zip(&self.warm.seen) {
            let slot = *slot as usize;
            let (origin, flight) = (points.origin(slot), points.flight(slot));
            let row = &mut bodies[members.bodies[slot] as usize];
            let more = seen.more_substeps;
            let push = Push {
                keep_awake: self.warm.restless,
                ..step.push_point(more, &origin, &flight)
            };
            row.give(&push, step.tick, engine);
        }
        step.delivered.store(true, Ordering::Relaxed);
        for (e, (direction, heat, work)) in members.elements.iter().zip(points.take_results()) {
            let row = &mut elements[*e as usize];
            row.solved = self.outcome.into();
            row.ledger.dissipated += heat;
            row.ledger.work += work;
            row.set_direction(direction);
        }
    }
}
