//! Number of sweeps over all joints and contacts that Rapier's solver takes in each substep. A sweep solves one joint after the
//! other (Gauss–Seidel), so a damper sees bodies that some joints have pushed already and others not yet.

use crate::backend::rapier::held::order::Order;
use crate::backend::rapier::held::plan::Plan;
use crate::dynamics::pieces::Piece;

/// Number of sweeps over all joints and contacts per substep, for a tense component without joints of the game, or one with
/// one-sided forces. With two sweeps the bridge still trembles; with one, stiff ropes that fall on the ground gain energy
/// (`ground::ropes`). Sweeps cost little compared with the set-up of joints in each substep.
const TENSE_SWEEPS: usize = 4;

/// Share of a damper's inverse mass that joints leave, below which one sweep over all joints per substep is not enough, if
/// the damper alone would remove more than the share [`DAMPED`] of its ends' speed in a substep. Pinned by `ground::hinge`.
const LIGHT: f64 = 0.7;
/// See [`LIGHT`].
const DAMPED: f64 = 0.02;

/// Number of sweeps per substep for dampers on light bodies; see [`LIGHT`]. With one, the arm of a lamp stops in a place where
/// its damper still pushes. With four, a bridge on hinges does not come to rest. Pinned by `ground::hinge` and `ground::play`.
const LIGHT_SWEEPS: usize = 2;

/// Number of sweeps per substep for each unit of the coupling of dampers, beside the first sweep; see [`Plan::sweeps`].
/// Pinned by `ground::dampers`: with 0.75, the springs of a net with strong dampers are off by 1.7 times a knot's weight.
const SWEEPS_PER_COUPLING: f64 = 2.0;
/// Greatest number of sweeps for dampers. With 32, the bridge of `ground::dampers` comes no closer to statics.
const MOST_SWEEPS: f64 = 16.0;

impl Plan {
    /// Number of sweeps over joints and contacts that a substep of `substep` seconds needs. With too few, a damper does not see
    /// what joints leave of an impulse, or what other springs do.
    pub(crate) fn sweeps(&mut self, substep: f64) -> usize {
        let light = |order: &Order| {
            let damping = order.pieces.iter().map(|piece| piece.tangent.damping);
            let damped = damping.sum::<f64>() * order.line.inverse_mass * substep;
            // Where something touches, the engine's warm start already contains the reaction of the contacts.
            order.jointed < LIGHT && damped > DAMPED && !order.touched
        };
        let any_ends = {
            let mut pieces = self.orders.iter().flat_map(|order| order.pieces.iter());
            pieces.any(Piece::ends)
        };
        let others = if any_ends || (self.tense && !self.jointed) {
            TENSE_SWEEPS
        } else if self.orders.iter().any(light) {
            LIGHT_SWEEPS
        } else {
            1
        };
        if self.jointed {
            // Joints of the game need other numbers: see `LIGHT_SWEEPS`. With that for dampers, the car of the example `drive`
            // jumps differently.
            return others;
        }
        others.max(self.damper_sweeps(substep))
    }

    /// Number of sweeps that dampers which share bodies need. A sweep solves one element after the other. So a damper sees bodies
    /// that some springs have pushed already and others not yet, and resists that motion too. At rest, its force would be wrong by
    /// a share that grows with its coupling to the others: what they change of its rate in a substep. More sweeps (Gauss–Seidel)
    /// reduce that error by a factor that depends on the coupling.
    fn damper_sweeps(&mut self, substep: f64) -> usize {
        self.drags.clear();
        self.drags.resize(self.bodies.len(), 0.0);
        for order in &self.orders {
            let damping = order.acting_damping(substep);
            for (body, root) in order.mobilities() {
                self.drags[body] += damping * root;
            }
        }
        let coupling = self.orders.iter().map(|order| {
            let damping = order.acting_damping(substep);
            let others = order.mobilities();
            others
                .map(|(body, root)| root * (self.drags[body] - damping * root))
                .sum::<f64>()
        });
        let coupling = substep * coupling.fold(0.0, f64::max);
        1 + (SWEEPS_PER_COUPLING * coupling)
            .round()
            .min(MOST_SWEEPS - 1.0) as usize
    }
}
