//! The energy of an element: what it stores, what it turns into heat, and the work that is done on it.

use crate::dynamics::element::{Element, End};
use crate::dynamics::law::Elastic;
use crate::dynamics::pair::{Pair, Separation};
use crate::input::check::Fault;
use crate::scene::rows::{ElementFlags, ElementRow, Jump};
use bevy::math::DVec3;

impl ElementRow {
    /// Tension at a length without damping, its slope, and the stored energy.
    pub(crate) fn elastic(&self, length: f64) -> Elastic {
        let rest_length = f64::from(self.numbers.rest_length.unwrap_or(0.0));
        match &self.law {
            Some(law) => law.elastic(length, rest_length),
            None => Elastic::linear(f64::from(self.numbers.stiffness), length - rest_length),
        }
    }

    /// Tension of the damper.
    pub(crate) fn drag(&self, length: f64, rate: f64) -> f64 {
        let rest_length = f64::from(self.numbers.rest_length.unwrap_or(0.0));
        match &self.law {
            Some(law) => law.drag(length, rest_length, rate).force,
            None => f64::from(self.numbers.damping) * rate,
        }
    }

    /// Length and rate of an element with an axis, for the given position and motion of its ends. Also counts its full turns.
    pub(crate) fn guided_extent(&mut self, ends: [End; 2]) -> (f64, f64) {
        let mut element = Element {
            ends,
            stiffness: 0.0,
            damping: 0.0,
            rest_length: 0.0,
            guide: self.rare.guide,
            law: None,
            angle: self.rare.angle,
            heat: 0.0,
            work: 0.0,
            direction: None,
            stiff_damper: false,
        };
        element.aim(&[], 0.0);
        self.rare.angle = element.angle;
        match element.line(&[]) {
            Some(line) => (line.length, line.motion(&element, &[], 0.0).axial),
            None => (self.length, 0.0),
        }
    }

    /// Energy of a lone element, J: kinetic energy about the common centre of mass, potential energy
    /// of outside forces, and stored energy.
    pub(crate) fn energy_of(&self, pair: &Pair, state: &Separation, length: f64) -> f64 {
        let motion = 0.5 * state.v.length_squared() - pair.outside.dot(state.d);
        self.elastic(length).energy + motion * pair.inverse_mass.recip()
    }

    /// Whether a custom law gives finite numbers for the separation `d` of the ends (m) and its rate `v` (m/s).
    pub(crate) fn is_sound(&self, v: DVec3, d: DVec3) -> bool {
        self.law.is_none() || self.is_sound_at(d.length(), v.dot(d.normalize_or_zero()))
    }

    /// Whether its law gives finite numbers at a length and a rate.
    fn is_sound_at(&self, length: f64, rate: f64) -> bool {
        let (elastic, drag) = (self.elastic(length), self.drag(length, rate));
        (elastic.force + elastic.stiffness + elastic.energy + drag).is_finite()
    }

    /// Stores whether its law gives finite numbers at a length and a rate, for an element that moves no body. The solver does it
    /// for all others.
    pub(crate) fn judge_law(&mut self, (length, rate): (f64, f64)) {
        if self.law.is_some() {
            let sound = self.is_sound_at(length, rate);
            let fault = (!sound).then_some(Fault::UNSOUND_LAW);
            self.trouble.set_passing(fault);
        }
    }

    /// Whether the element can dissipate energy.
    pub(crate) fn is_damped(&self) -> bool {
        match &self.law {
            Some(law) => law.damps(),
            None => self.numbers.damping > 0.0,
        }
    }

    /// Slope of the spring's force at the length after the last step, N/m.
    pub(crate) fn slope(&self) -> f64 {
        if self.law.is_none() {
            return f64::from(self.numbers.stiffness);
        }
        self.elastic(self.length).stiffness
    }

    /// Adds the heat and work of a step of `time` seconds to the given length and rate, for an element whose ends are both moved
    /// by something else. All its energy is work of these ends.
    pub(crate) fn account_for_moved(&mut self, (length, rate): (f64, f64), time: f64) {
        let heat = self.drag(length, rate) * rate * time;
        let stored = self.elastic(length).energy - self.elastic(self.length).energy;
        if heat.is_finite() && stored.is_finite() {
            self.ledger.dissipated += heat;
            self.ledger.work += heat + stored;
        }
    }

    /// Adds the work of the game if it moved an end since the last step, or gave the element other anchors or another axis, so that
    /// the element now has the given length.
    pub(crate) fn account_for_leap(&mut self, length: f64) {
        self.rare.leapt = false;
        if self.rare.places[0].is_some() && self.numbers.rest_length.is_some() {
            let leap = self.elastic(length).energy - self.elastic(self.length).energy;
            if leap.is_finite() {
                self.ledger.work += leap;
            }
        }
    }

    /// Applies a change of parameters. The change of the stored energy counts as work.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut Self)) {
        let acted = self.rare.places[0].is_some() && self.numbers.rest_length.is_some();
        let before = self.elastic(self.length);
        change(self);
        if acted && self.numbers.rest_length.is_some() {
            let after = self.elastic(self.length);
            let (work, by) = (after.energy - before.energy, after.force - before.force);
            if work.is_finite() {
                self.ledger.work += work;
            }
            if by.is_finite() && by != 0.0 {
                let earlier = if self.has(ElementFlags::JUMPED) {
                    self.rare.jump.by
                } else {
                    0.0
                };
                self.rare.jump = Jump {
                    by: earlier + by,
                    to: after.force,
                };
                self.flags.insert(ElementFlags::JUMPED);
            }
        }
    }

    /// The tension that the spring would have after the step, N, if parameters that the game changed before the step had changed
    /// evenly. `last` is the tension that it has. A winch that winds evenly changes the rest length at the beginning of each step
    /// by as much as the load follows during the step. So at the beginning of the step, the tension is ahead by half of the change,
    /// and at the end, it is behind by as much. The result lies between the tension right after the change and `last`.
    pub(crate) fn even_tension(&self, last: f64) -> f64 {
        // A rope that has gone slack has no force.
        if !self.has(ElementFlags::LEADS) || last == 0.0 {
            return last;
        }
        let Jump { by, to } = self.rare.jump;
        let even = (last + 0.5 * by).max(last.min(to)).min(last.max(to));
        if even.is_finite() { even } else { last }
    }
}
