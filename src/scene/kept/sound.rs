//! Replaces numbers in a snapshot that cannot occur in any scene. The snapshot may come from a file or from a player who cheats, and such
//! numbers would spoil the engine, or bodies and elements for ever.

use super::{Kept, KeptBody, KeptElement, KeptInside, Memory};
use crate::dynamics::guide::Guide;
use crate::input::check::{MOST, Numbers};
use crate::readout::SpringReadout;
use crate::scene::held::Leeway;
use crate::scene::rows::{Jump, Rest};
use bevy::math::{DQuat, DVec3, Vec3};

/// Greatest length of an element, m: both ends may be [`MOST`] from the origin along each axis.
const LONGEST: f64 = 4.0 * MOST as f64;
/// Greatest force of a spring, N: the product of the greatest stiffness and stretch that a user may give.
const STRONGEST: f64 = MOST as f64 * MOST as f64;
/// Greatest rate of a length, m/s: [`LONGEST`] within a short step.
const FASTEST: f64 = 1e16;
/// Longest substep of an engine, and longest time of a [`Rest`], s.
const SLOWEST: f64 = 10.0;

/// Whether the magnitude of `x` is at most `most`. That of NaN is not.
fn is_within(x: f64, most: f64) -> bool {
    x.abs() <= most
}

fn is_place(at: DVec3) -> bool {
    at.abs().cmple(DVec3::splat(f64::from(MOST))).all()
}

fn is_number(x: f32) -> bool {
    x.abs() <= MOST
}

/// Replaces `x` by zero if its magnitude is greater than `most`, or if it is NaN.
fn limit(x: &mut f64, most: f64) {
    if !is_within(*x, most) {
        *x = 0.0;
    }
}

impl Kept {
    /// Replaces all numbers that cannot occur in any scene by those of a new element or body.
    pub(crate) fn mend(&mut self) {
        if self.engine_stays {
            // Handles in an engine that was not restored name anything.
            self.forget_engine();
        }
        for element in &mut self.elements {
            limit(&mut element.ledger.dissipated, f64::MAX);
            limit(&mut element.ledger.work, f64::MAX);
            if !element.readout.is_sound() {
                element.readout = SpringReadout::default();
            }
            element.memory.mend();
            if let Some(inside) = &mut element.inside {
                inside.mend();
            }
        }
        for body in &mut self.bodies {
            body.mend();
        }
        for (_, inside) in &mut self.left {
            inside.mend();
        }
    }
}

impl KeptElement {
    /// The numbers that acted last. A number that no element with this guide may have is replaced by that of the component, `given`.
    pub(crate) fn numbers_or(&self, given: Numbers, guide: Guide) -> Numbers {
        let of = |kept: f32, given| {
            if kept >= 0.0 && is_number(kept) {
                kept
            } else {
                given
            }
        };
        Numbers {
            stiffness: of(self.numbers[0], given.stiffness),
            damping: of(self.numbers[1], given.damping),
            rest_length: match self.rest_length {
                Some(rest) if !is_number(rest) || (guide == Guide::Centres && rest < 0.0) => {
                    given.rest_length
                }
                rest => rest,
            },
        }
    }
}

impl Memory {
    fn mend(&mut self) {
        self.direction = self.direction.filter(|direction| is_place(*direction));
        limit(&mut self.length, LONGEST);
        limit(&mut self.angle, f64::from(MOST));
        for place in &mut self.places {
            *place = place.filter(|place| is_place(*place));
        }
        for facing in &mut self.facings {
            if !facing.is_normalized() {
                *facing = DQuat::IDENTITY;
            }
        }
        for scale in &mut self.scales {
            *scale = scale.filter(|scale| is_place(*scale));
        }
        let Jump { by, to } = self.jump;
        if !(is_within(by, STRONGEST) && is_within(to, STRONGEST)) {
            self.jump = Jump::default();
        }
    }
}

impl KeptBody {
    fn mend(&mut self) {
        for share in self.user.iter_mut().chain(&mut self.elements) {
            // The sum of both must be finite, too.
            if !share.length_squared().is_finite() {
                *share = Vec3::ZERO;
            }
        }
        let rested = f64::from(self.rest.seconds);
        if !(0.0..=SLOWEST).contains(&rested) {
            self.rest = Rest::default();
        }
        if !(0.0..=SLOWEST).contains(&self.substep) {
            self.substep = 0.0;
        }
    }
}

impl KeptInside {
    fn mend(&mut self) {
        let is_rate = |rates: &[f64; 2]| rates.iter().all(|rate| is_within(*rate, FASTEST));
        self.rates = self.rates.filter(is_rate);
        limit(&mut self.debt, f64::MAX);
        let Leeway { left, jointed, .. } = self.leeway;
        if !(left >= 0.0 && left.is_finite()) || jointed.is_nan() {
            // It is computed anew in the next step.
            self.leeway = Leeway::default();
        }
    }
}
