//! Where an element's energy comes from and goes.

use crate::dynamics::element::{Element, End};
use crate::dynamics::law::Elastic;
use crate::dynamics::pair::{Pair, Separation};
use crate::scene::rows::ElementRow;
use bevy::math::DVec3;

impl ElementRow {
    /// Tension without damping at a length, its slope, and the stored energy.
    pub(crate) fn elastic(&self, length: f64) -> Elastic {
        let rest_length = f64::from(self.numbers.rest_length.unwrap_or(0.0));
        match &self.law {
            Some(law) => law.elastic(length, rest_length),
            None => {
                let stiffness = f64::from(self.numbers.stiffness);
                let stretch = length - rest_length;
                Elastic {
                    force: stiffness * stretch,
                    stiffness,
                    energy: 0.5 * stiffness * stretch * stretch,
                }
            }
        }
    }

    /// Tension that damping adds.
    pub(crate) fn drag(&self, length: f64, rate: f64) -> f64 {
        let rest_length = f64::from(self.numbers.rest_length.unwrap_or(0.0));
        match &self.law {
            Some(law) => law.drag(length, rest_length, rate).force,
            None => f64::from(self.numbers.damping) * rate,
        }
    }

    /// Length and rate of a guided element whose ends are and move like this; takes note of its turns.
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

    /// Energy of a lone element's motion about the common centre of mass, in the outside forces, and stored.
    pub(crate) fn energy_of(&self, pair: &Pair, state: &Separation, length: f64) -> f64 {
        let motion = 0.5 * state.v.length_squared() - pair.outside.dot(state.d);
        self.elastic(length).energy + motion * pair.inverse_mass.recip()
    }

    /// Whether a law of a user's own gives numbers, for ends that are and move apart like this.
    pub(crate) fn is_sound(&self, v: DVec3, d: DVec3) -> bool {
        if self.law.is_none() {
            return true;
        }
        let elastic = self.elastic(d.length());
        let drag = self.drag(d.length(), v.dot(d.normalize_or_zero()));
        (elastic.force + elastic.stiffness + elastic.energy + drag).is_finite()
    }

    /// Whether it can lose energy.
    pub(crate) fn is_damped(&self) -> bool {
        match &self.law {
            Some(law) => law.damps(),
            None => self.numbers.damping > 0.0,
        }
    }

    /// Slope of the spring's force as of the last step, N/m.
    pub(crate) fn slope(&self) -> f64 {
        if self.law.is_none() {
            return f64::from(self.numbers.stiffness);
        }
        self.elastic(self.length).stiffness
    }

    /// Energy of an element both of whose ends are moved by something else, over a step to this length and at
    /// this rate: all of it is their work.
    pub(crate) fn account_for_moved(&mut self, (length, rate): (f64, f64), time: f64) {
        let heat = self.drag(length, rate) * rate * time;
        let stored = self.elastic(length).energy - self.elastic(self.length).energy;
        if heat.is_finite() && stored.is_finite() {
            self.ledger.dissipated += heat;
            self.ledger.work += heat + stored;
        }
    }

    /// Takes in that the game has put an end elsewhere since the last step, so that it is so long now.
    pub(crate) fn account_for_leap(&mut self, length: f64) {
        if self.rare.places[0].is_some() && self.numbers.rest_length.is_some() {
            let leap = self.elastic(length).energy - self.elastic(self.length).energy;
            if leap.is_finite() {
                self.ledger.work += leap;
            }
        }
    }

    /// Takes in other numbers; what that changes in stored energy is work that was done.
    pub(crate) fn change(&mut self, change: impl FnOnce(&mut Self)) {
        let acted = self.rare.places[0].is_some() && self.numbers.rest_length.is_some();
        let before = self.elastic(self.length).energy;
        change(self);
        if acted && self.numbers.rest_length.is_some() {
            let work = self.elastic(self.length).energy - before;
            if work.is_finite() {
                self.ledger.work += work;
            }
        }
    }
}
