//! Takes one component through a step: reads it, decides whether it is awake, integrates it, and gives the result to the engine.

use crate::backend::{Engine, Push, Sight};
use crate::dynamics::body::Body;
use crate::dynamics::step::{Component, Copies};
use crate::dynamics::tolerance::{Accuracy, Outcome};
use crate::input::check::Fault;
use crate::scene::push::Manner;
use crate::scene::rows::{
    BodyFlags, BodyRow, Cut, ElementFlags, ElementRow, Members, Solved, pull_mark, take,
};
use crate::scene::sleep::{omega_of, rouse, wake_with};
use crate::scene::step::Step;
use crate::scene::to_element::element;
use crate::scene::warm_start::WarmStart;
use std::mem::{replace, take};
use std::sync::atomic::Ordering;

/// A component with its bodies and elements, kept from tick to tick.
#[derive(Default)]
pub(crate) struct Assembly {
    /// Hash that identifies its component.
    pub(crate) signature: u64,
    /// Index of its group.
    pub(crate) group: usize,
    pub(crate) component: Component,
    /// How the engine steps each body.
    manners: Vec<Manner>,
    /// The push for each body.
    orders: Vec<Push>,
    /// Indices, within the component, of the bodies that were asleep and that the step sets in motion.
    woken: Vec<u32>,
    pub(crate) state: State,
    /// Whether it was found asleep.
    asleep: bool,
    /// Whether its bodies must be woken or kept awake.
    rouse: bool,
    /// Whether one of its bodies gained or lost its colliders.
    pub(crate) touch_changed: bool,
    /// Whether one of its bodies can no longer be moved.
    pub(crate) stale: bool,
    pub(crate) outcome: Outcome,
    pub(crate) warm: WarmStart,
}

/// What to do with a component in this step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum State {
    /// Nothing, because the component is asleep or is not stepped.
    #[default]
    Resting,
    /// No element acts. The forces that elements gave to the bodies are removed.
    Powerless,
    /// The component must be integrated.
    Ready,
}

impl Assembly {
    /// Number of elements to integrate.
    pub(crate) fn load(&self) -> usize {
        if self.state == State::Ready {
            self.component.elements.len()
        } else {
            0
        }
    }

    /// Whether it was found asleep in this step.
    pub(crate) fn is_asleep(&self) -> bool {
        self.asleep
    }

    /// Makes the next step of the component read everything about its elements again.
    pub(crate) fn read_anew(&mut self) {
        self.component.forget_points();
    }

    /// Forgets everything about its component, so that it can take another one.
    pub(crate) fn forget(&mut self) {
        self.component.forget();
        self.asleep = false;
    }

    /// Reads bodies and elements, and decides whether there is anything to do.
    pub(crate) fn gather(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut Cut<ElementRow>,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
    ) {
        self.state = State::Resting;
        self.rouse = false;
        if step.quiet && self.asleep && step.is_left_alone(members, elements, bodies, sight) {
            return;
        }
        self.asleep = false;
        self.component.farthest_move = Some(step.plan.fastest * step.plan.time);
        if self.continue_warm(step, members, elements, bodies, sight) {
            return;
        }
        if !self.gather_bodies(step, members, bodies, sight) {
            return;
        }
        let sound = self.component.bodies.iter().all(Body::is_finite);
        let disturbed = self.gather_elements(step, members, elements, bodies, sight);
        let omega = self.warm.omega;
        let (awake, rouse) = step.is_awake(bodies, members.bodies, false, omega, sight, disturbed);
        self.rouse = rouse;
        for e in members.elements {
            let flags = &mut elements[*e as usize].flags;
            flags.set(ElementFlags::ACTIVE, awake);
        }
        if !awake {
            self.asleep = true;
            return;
        }
        self.state = if sound && !self.component.elements.is_empty() {
            State::Ready
        } else {
            State::Powerless
        };
    }

    /// Reads the bodies. Returns whether all of them can be moved.
    fn gather_bodies(
        &mut self,
        step: &Step,
        members: &Members,
        bodies: &mut Cut<BodyRow>,
        sight: &impl Sight,
    ) -> bool {
        let component = &mut self.component;
        component.forget_points();
        component.elements.clear();
        component.bodies.clear();
        self.manners.clear();
        self.warm.begin();
        component.perturbed = self.warm.perturbed;
        // A vector that grows begins with a capacity of four, but most components have one element and two bodies.
        component.bodies.reserve_exact(members.bodies.len());
        self.manners.reserve_exact(members.bodies.len());
        self.warm.centers.reserve_exact(members.bodies.len());
        component.elements.reserve_exact(members.elements.len());
        for b in members.bodies {
            let row = &mut bodies[*b as usize];
            let Some(seen) = step.movable(sight, row.id, &mut self.stale) else {
                return false;
            };
            let turns = row.has(BodyFlags::TURNS);
            self.stale |= !turns && seen.has_shifted(row.rare.center);
            let Some(mut free) = sight.body(row.id, &row.user(), turns) else {
                return false;
            };
            self.touch_changed |= row.notice_colliders(seen.can_touch);
            self.warm.centers.push(seen.local_center);
            if turns {
                free.farthest_turn = step.farthest_turn(&seen);
            }
            let pulled = pull_mark(free.acceleration);
            component.perturbed |= row.was_perturbed(&seen, free.position);
            component.perturbed |= replace(&mut row.rare.pulled, pulled) != pulled;
            component.bodies.push(free);
            self.manners.push(Manner::of(&seen));
        }
        true
    }

    /// Reads the elements. The bodies must have been read before. Returns whether an element changed or an end moved.
    fn gather_elements(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut Cut<ElementRow>,
        bodies: &Cut<BodyRow>,
        sight: &impl Sight,
    ) -> bool {
        let (mut disturbed, mut omega) = (false, 0.0_f32);
        self.warm.ends.clear();
        for (index, e) in members.elements.iter().enumerate() {
            let row = &mut elements[*e as usize];
            let has_moved = step.has_moved(row, sight);
            self.component.perturbed |= has_moved;
            self.component.perturbed |= take!(row.flags, ElementFlags::REFITTED);
            disturbed |= row.has(ElementFlags::CHANGED) || has_moved;
            let ends = [0, 1].map(|end| step.end(row, end, bodies, sight));
            let element = element(row, ends, &self.component.bodies);
            let inert = element.is_none();
            // An element that begins to act brings its energy with it.
            self.component.perturbed |= row.has(ElementFlags::INERT) != inert;
            row.flags.set(ElementFlags::INERT, inert);
            if let Some(element) = element {
                if has_moved {
                    row.account_for_leap(element.distance(&self.component.bodies).0);
                }
                omega = omega.max(omega_of(row));
                for (end, _) in ends.iter().enumerate().filter(|(_, end)| end.is_path()) {
                    self.warm.ends.push((index, end));
                }
                self.component.elements.push(element);
            }
        }
        self.warm.omega = omega;
        disturbed
    }

    /// Integrates over the step and computes the push for each body.
    pub(crate) fn advance(&mut self, step: &Step, accuracy: Accuracy, copies: &mut Copies) {
        if self.state != State::Ready {
            return;
        }
        self.component.swap_copies(copies);
        self.outcome = self.component.advance(step.plan.time, accuracy);
        if !self.component.is_finite() {
            self.state = State::Powerless;
            self.component.forget_points();
            self.component.forget_solutions();
        }
        self.orders.clear();
        self.woken.clear();
        if self.component.is_warm {
            // The points have all that is given to the bodies.
            self.orders.shrink_to_fit();
        } else if self.state == State::Ready {
            self.order(step);
        }
        self.component.swap_copies(copies);
    }

    /// Computes the push for each body after a step of rigid bodies.
    fn order(&mut self, step: &Step) {
        let ends = &self.component.bodies;
        let ways = self.component.start_bodies().iter().zip(ends);
        self.orders.reserve_exact(ends.len());
        for (slot, (manner, (start, end))) in self.manners.iter().zip(ways).enumerate() {
            self.orders.push(step.push(manner, start, end));
            if manner.is_asleep && step.sets_moving(start, end) {
                self.woken.push(slot as u32);
            }
        }
    }

    /// Gives each body its push.
    pub(crate) fn deliver(
        &mut self,
        step: &Step,
        members: &Members,
        elements: &mut [ElementRow],
        bodies: &mut [BodyRow],
        engine: &mut impl Engine,
    ) {
        if self.state == State::Resting {
            return;
        }
        if take(&mut self.rouse) {
            rouse(bodies, members.bodies, engine);
        }
        // Reset the state, so that the step of another context does not integrate the component again.
        let ready = take(&mut self.state) == State::Ready;
        if ready && self.component.is_warm {
            return self.deliver_warm(step, members, elements, bodies, engine);
        }
        if ready {
            wake_with(&self.woken, bodies, members.bodies, engine);
        }
        for (slot, b) in members.bodies.iter().enumerate() {
            let row = &mut bodies[*b as usize];
            if engine.is_asleep(row.id) {
                continue;
            }
            row.flags.remove(BodyFlags::IS_ALONE);
            let order = self.orders.get(slot).filter(|_| ready);
            let nothing = Push::default();
            row.give(order.unwrap_or(&nothing), step.tick, engine);
            step.delivered.store(true, Ordering::Relaxed);
        }
        let mut solved = self.component.elements.iter().enumerate();
        for e in members.elements {
            let row = &mut elements[*e as usize];
            row.solved = Solved::default();
            if row.trouble.passing().is_none()
                && let Some((index, element)) = solved.next().filter(|_| ready)
            {
                if self.component.unsound.contains(&index) {
                    row.trouble.set_passing(Some(Fault::UNSOUND_LAW));
                    // If it acts in the next step, it brings its energy with it.
                    row.flags.insert(ElementFlags::INERT);
                    continue;
                }
                row.set_direction(element.direction);
                row.rare.angle = element.angle;
                row.ledger.dissipated += element.heat;
                row.ledger.work += element.work;
                row.solved = self.outcome.into();
            }
        }
    }
}
