//! Lets [`super::tolerance`] advance a lone pair.

use super::arc::HALVED;
use super::kick::Memo;
use super::pair::{Pair, Separation};
use super::resolution::lone_steps;
use super::surplus;
use super::tolerance::{Least, Steppable, VELOCITY_COUNTS};
use bevy::math::DVec3;

/// A pair and its present state, as a [`Steppable`].
pub(crate) struct Moving<'a> {
    pub pair: &'a Pair,
    pub state: Separation,
    pub memo: &'a mut Memo,
    saved: [Option<Separation>; 3],
}

impl<'a> Moving<'a> {
    pub(crate) fn new(pair: &'a Pair, state: Separation, memo: &'a mut Memo) -> Self {
        Self {
            pair,
            state,
            memo,
            saved: [None; 3],
        }
    }

    /// State that was last saved in a slot; the present state if there is none.
    fn saved(&self, slot: usize) -> Separation {
        self.saved[slot].unwrap_or(self.state)
    }
}

impl Steppable for Moving<'_> {
    fn save(&mut self, slot: usize) {
        self.saved[slot] = Some(self.state);
    }

    fn load(&mut self, slot: usize) {
        self.state = self.saved(slot);
    }

    fn least(&mut self, time: f64, most: u32) -> Least {
        lone_steps(self.pair.stiffness_number(time), most, false)
    }

    fn run(&mut self, time: f64, count: u32) {
        let start = self.state;
        self.pair
            .microsteps(&mut self.state, time, count, self.memo);
        let times = [time, time / f64::from(count)];
        surplus::remove(self.pair, &mut self.state, &start, times, self.memo);
    }

    fn distance(&self, slot: usize) -> f64 {
        let (a, b) = (&self.state, self.saved(slot));
        let (moved, sped) = (a.d - b.d, a.v - b.v);
        let along = a.direction.unwrap_or(DVec3::ZERO);
        let axial = sped.dot(along);
        // An axial velocity error reverses within a period, so it counts no longer than 1/ω.
        let omega = (self.pair.stiffness * self.pair.inverse_mass).sqrt();
        let counts = VELOCITY_COUNTS.min(omega.recip());
        moved.length() + counts * axial.abs() + VELOCITY_COUNTS * (sped - axial * along).length()
    }

    fn travelled(&self, slot: usize) -> f64 {
        self.distance(slot)
    }

    fn extrapolate(&mut self, slot: usize) {
        let coarse = self.saved(slot);
        let times = if self.pair.has_axis(&coarse) {
            HALVED
        } else {
            4.0
        };
        self.state.extrapolate(&coarse, times);
    }

    fn order(&self) -> i32 {
        match self.pair.has_axis(&self.state) {
            true if self.pair.damping > 0.0 => 3,
            true => 4,
            false => 2,
        }
    }

    fn is_resolved(&mut self, step: f64) -> bool {
        self.pair.resolved(&self.state, step)
    }
}
