//! Updates an element after a step inside Rapier's solver: heat, work, energy error and rate.

use crate::scene::rows::ElementRow;
use bevy::math::DVec3;

/// Share of the energy owed to the bodies that is kept from step to step. Lost energy is given back only soon after the loss.
/// Pinned by `arrive::tests`.
const KEPT: f64 = 0.8;

impl ElementRow {
    /// Updates the element after a step of `time` seconds that ended with `length`. `moved` is the displacement (m) or rotation
    /// (rad) of each end that elements cannot move, `way` the mean direction of the element over the step. Returns the length and
    /// its mean rate over the step.
    pub(crate) fn arrive_inside(
        &mut self,
        length: f64,
        moved: [Option<DVec3>; 2],
        way: DVec3,
        time: f64,
    ) -> (f64, f64) {
        let Some(inside) = &self.inside else {
            return (length, 0.0);
        };
        let (from, pieces) = (inside.from, inside.pieces);
        let rate = (length - from) / time;
        let middle = 0.5 * (from + length);
        let drag = self.drag(middle, rate);
        let heat = drag * rate * time;
        let won = if self.law.is_some() {
            let stored = |length: f64| self.elastic(length).energy;
            stored(length) - stored(from) - pieces.work([from, length])
        } else {
            0.0
        };
        let tension = pieces.tension(middle, 0.0) + drag;
        let mut work = 0.0;
        for (by, sign) in moved.into_iter().zip([-1.0, 1.0]) {
            work += sign * tension * by.map_or(0.0, |by| by.dot(way));
        }
        if heat.is_finite() && work.is_finite() {
            self.ledger.dissipated += heat.max(0.0);
            self.ledger.work += work;
        }
        if let Some(inside) = &mut self.inside {
            let owed = inside.debt + won;
            if owed.is_finite() {
                inside.debt = if owed < 0.0 { KEPT * owed } else { owed };
            }
            let last = inside.rates.map_or(rate, |rates| rates[0]);
            inside.rates = Some([rate, last]);
        }
        (length, rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::held::Inside;
    use bevy::prelude::Entity;

    /// What is left of a debt (J) after a number of steps in which the element neither wins nor loses.
    fn left(debt: f64, steps: u32) -> f64 {
        let mut row = ElementRow::new(Entity::PLACEHOLDER);
        let inside = Inside {
            debt,
            ..Inside::default()
        };
        row.inside = Some(Box::new(inside));
        for _ in 0..steps {
            row.arrive_inside(0.0, [None; 2], DVec3::X, 1.0 / 60.0);
        }
        row.inside.map_or(0.0, |inside| inside.debt)
    }

    #[test]
    fn lost_energy_is_given_back_in_a_third_of_a_second_or_never_and_won_energy_is_always_taken_back()
     {
        assert!(left(-1.0, 1) < -0.5, "most of it waits for the next step");
        assert!(left(-1.0, 20) > -0.02, "it is forgotten");
        assert_eq!(left(1.0, 20), 1.0);
    }
}
